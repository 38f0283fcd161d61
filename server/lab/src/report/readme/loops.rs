//! Tables of passivity over links, and of a hand at rest.

use super::table::{Table, number};
use super::{COMMAND, yes_no};
use crate::report::{FELT_MJ, Loop, Report};

/// Number of links in the table.
const MOST: usize = 12;

/// The links over which the loop puts out most energy.
pub(super) fn links(report: &Report) -> Table {
    let mut links: Vec<&Loop> = report.passivity.loops.iter().collect();
    links.sort_by(|a, b| b.energy_mj.total_cmp(&a.energy_mj));
    let rows = links.iter().take(MOST).map(|link| {
        vec![
            format!("`{}`", link.case),
            format!("{}", link.delay_ms),
            number(link.energy_mj),
            number(link.energy_controlled_mj),
            number(link.period_work_mj),
            yes_no(link.passive),
            number(link.acted_percent),
            number(link.infidelity_percent),
            number(link.infidelity_controlled_percent),
        ]
    });
    let loss = links.first().map_or(0.0, |link| link.loss_percent);
    Table {
        caption: format!(
            "Case: the {MOST} links with the most energy, a hand that feels in a hard case over a link with {loss} % loss each way; reference: the force as computed; quantities: largest net energy put out into the hand, without and with the passivity controller, and rms error of the displayed force."
        ),
        command: COMMAND.to_owned(),
        columns: vec![
            "case",
            "round trip, ms",
            "energy without, mJ",
            "energy with, mJ",
            "unpaid work of one period, mJ",
            "passive",
            "ticks with action, %",
            "force error without, %",
            "force error with, %",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// All links by their delay.
pub(super) fn delays(report: &Report) -> Table {
    let all = &report.passivity.loops;
    let mut delays: Vec<u32> = all.iter().map(|link| link.delay_ms).collect();
    delays.sort_unstable();
    delays.dedup();
    let rows = delays.into_iter().map(|delay| {
        let links: Vec<&Loop> = all.iter().filter(|link| link.delay_ms == delay).collect();
        let most = |value: fn(&Loop) -> f64| {
            number(links.iter().map(|link| value(link)).fold(0.0, f64::max))
        };
        let felt = |link: &&&Loop| link.energy_controlled_mj > FELT_MJ;
        vec![
            format!("{delay}"),
            format!("{}", links.len()),
            most(|link| link.energy_mj),
            most(|link| link.energy_controlled_mj),
            format!("{}", links.iter().filter(felt).count()),
            format!("{}", links.iter().filter(|link| link.passive).count()),
        ]
    });
    Table {
        caption: format!(
            "Case: every hard case but those of rest over links of each delay; reference: {FELT_MJ} mJ, which no hand feels; quantities: largest energy put out without and with the passivity controller, and number of links."
        ),
        command: COMMAND.to_owned(),
        columns: vec![
            "round trip, ms",
            "links",
            "energy max without, mJ",
            "energy max with, mJ",
            "links above the reference",
            "passive links",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// A hand at rest in contact.
pub(super) fn rest(report: &Report) -> Table {
    let rows = report.passivity.hours.iter().map(|hour| {
        let period = hour
            .period_ticks
            .map_or_else(|| "none found".to_owned(), |ticks| format!("{ticks}"));
        vec![
            format!("`{}`", hour.case),
            format!("{}", hour.ticks_run),
            period,
            yes_no(hour.whole_hour),
            number(hour.drift_um),
            number(hour.force_n),
        ]
    });
    Table {
        caption: "Case: a hand without tremor at rest in contact; reference: the tool's place at the beginning; quantities: ticks after which the state repeats bit for bit, drift of the tool, and force.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "case",
            "ticks run",
            "period, ticks",
            "stands for an hour",
            "drift, um",
            "force, N",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
