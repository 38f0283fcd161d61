//! Passivity: the energy that the closed loop of hand, device, link and simulation puts out into the hand, and what a controller
//! at the client does about it; and an hour at rest.

use serde::Serialize;
use sulcus_cases::linked::{FELT, LinkModel, Linked, run_linked};
use sulcus_cases::rest::{HOUR, rest};
use sulcus_cases::{Case, TABLE, find};
use sulcus_haptics::PassivityParams;

use super::together::on_all_cores;

/// Share of datagrams that are lost, each way.
const LOSS: f64 = 0.02;
/// Energy from which a loop is said to generate some, joules.
const SOME: f64 = 1e-5;
/// Cases that are slower or weaker versions of others: over the longest link alone. (Those of rest are asked for an hour's instead.)
const VERSIONS: [&str; 6] = ["-0.02", "-0.1", "-1", "-0.65", "-stiff", "-15-k0.5"];
const REST: &str = "-rest";
/// Energy under which nothing is felt, millijoules: what the controller is to leave.
pub(crate) const FELT_MJ: f64 = FELT * 1e3;

/// Ticks of rest where no repetition is to be waited for: five minutes. (The tests of `sulcus-cases` run the whole hour.)
const MINUTES: u64 = 300_000;
/// Farthest that a tool at rest may drift, micrometres.
const STILL_UM: f64 = 1.0;

/// One case over one link.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Loop {
    pub(crate) case: &'static str,
    /// Round trip.
    pub(crate) delay_ms: u32,
    pub(crate) loss_percent: f64,
    /// Most that came out net, without the controller and with it; the same run where it had nothing to do.
    pub(crate) energy_mj: f64,
    pub(crate) energy_controlled_mj: f64,
    /// Most that was put out unpaid within one period, with the controller: what none can foresee.
    pub(crate) period_work_mj: f64,
    /// Whether no more came out than two such periods and [`FELT_MJ`] explain, nor more than the case allows, with the controller.
    pub(crate) passive: bool,
    /// What the controller took out, and the share of ticks in which it acted.
    pub(crate) taken_mj: f64,
    pub(crate) acted_percent: f64,
    /// Displayed against computed force, root mean square, percent of the force: without and with.
    pub(crate) infidelity_percent: f64,
    pub(crate) infidelity_controlled_percent: f64,
    pub(crate) finite: bool,
}

/// A hand without tremor at rest for an hour.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Hour {
    pub(crate) case: &'static str,
    /// Ticks after which everything repeats bit for bit; none where the whole hour was run instead.
    pub(crate) period_ticks: Option<u64>,
    pub(crate) ticks_run: u64,
    /// Whether that stands for an hour: all of it was run, or what repeats was found.
    pub(crate) whole_hour: bool,
    pub(crate) drift_um: f64,
    pub(crate) force_n: f64,
}

impl Hour {
    /// Whether nothing drifts, under a force that is one.
    pub(crate) fn holds(&self) -> bool {
        self.drift_um < STILL_UM && self.force_n > 0.05
    }
}

/// Both.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Loops {
    pub(crate) loops: Vec<Loop>,
    pub(crate) hours: Vec<Hour>,
}

/// Measures them.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Loops {
    let short = ["wedge", "sharp-edge", "tongue-10-k2"];
    let wanted = |case: &&Case| match quick {
        true => short.contains(&case.name),
        false => !case.name.ends_with(REST),
    };
    let cases: Vec<&Case> = TABLE.iter().filter(wanted).collect();
    let delays: &[u32] = if quick { &[0, 5] } else { &[0, 1, 2, 5] };
    let mut links = Vec::new();
    for case in cases {
        let version = VERSIONS.iter().any(|end| case.name.ends_with(end));
        let delays = match version {
            true => &delays[delays.len() - 1..],
            false => delays,
        };
        links.extend(delays.iter().map(|&delay| (case, delay)));
    }
    let loops = on_all_cores(&links, &|share| progress("", 0.7 * share), |link| {
        one(link.0, link.1)
    });
    let resting: &[&str] = match quick {
        true => &["hour-rest"],
        false => &["hour-rest", "pocket-rest", "tongue-rest", "organ-rest"],
    };
    let hours = on_all_cores(
        resting,
        &|share| progress("at rest", 0.7 + 0.3 * share),
        |&name| {
            let case = find(name).expect("in the table");
            // Only the plate's state repeats soon; the others' have to be run all the way.
            let ticks = if name == "hour-rest" { HOUR } else { MINUTES };
            let found = rest(case, 2.0, ticks, PassivityParams::default());
            Hour {
                case: case.name,
                period_ticks: found.period,
                ticks_run: found.ticks,
                whole_hour: found.period.is_some() || found.ticks >= HOUR,
                drift_um: found.excursion * 1e6,
                force_n: found.force,
            }
        },
    );
    Loops { hours, loops }
}

fn one(case: &Case, delay_ms: u32) -> Loop {
    let link = LinkModel {
        delay_ticks: delay_ms,
        loss: LOSS,
        seed: 7,
    };
    let free = run_linked(case, &link, PassivityParams::observing());
    let held: Linked = if free.energy > SOME {
        run_linked(case, &link, PassivityParams::default())
    } else {
        free
    };
    Loop {
        case: case.name,
        delay_ms,
        loss_percent: LOSS * 100.0,
        energy_mj: free.energy * 1e3,
        energy_controlled_mj: held.energy * 1e3,
        period_work_mj: held.period_work * 1e3,
        passive: held.passive,
        taken_mj: held.taken * 1e3,
        acted_percent: held.acted * 100.0,
        infidelity_percent: free.infidelity() * 100.0,
        infidelity_controlled_percent: held.infidelity() * 100.0,
        finite: free.finite && held.finite,
    }
}
