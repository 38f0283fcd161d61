//! The tables of passivity and of the hour at rest.

use std::fmt::Write;

use super::super::plot::{Plot, Series};
use crate::report::{FELT_MJ, Loop, Report};

/// Class of a verdict.
fn holds(well: bool) -> &'static str {
    if well { "holds" } else { "broken" }
}

pub(super) fn loops(html: &mut String, report: &Report) {
    let found = &report.passivity;
    html.push_str("<section id=\"passivity\"><h2>Passivity over a link</h2>\n<p class=\"note\">Every case but those of rest by a hand that holds a device and feels, over links with 2 % of the datagrams lost each way. <b>Energy</b>: the most that the wrench as displayed had put out into the hand, net, since its contact began; a passive loop puts out nothing, good is under 0.1 mJ. No controller can foresee what a hand does within the next period: the most that was put out unpaid in one stands beside it; more than two such periods and 0.1 mJ is not <b>passive</b>. (Slower and weaker versions of a case over the longest link alone.) Where it puts out some the client's controller damps the device, and lets go of a hand that is pushed along slowly, until it is paid back. <b>Off</b>: displayed against computed force (delay, slew and controller), rms in percent of the force.</p>\n<div class=\"two\">");
    let mut delays: Vec<u32> = found.loops.iter().map(|l| l.delay_ms).collect();
    delays.sort_unstable();
    delays.dedup();
    let worst = |of: fn(&Loop) -> f64| {
        let at = |delay: &u32| {
            let all = found.loops.iter().filter(|l| l.delay_ms == *delay);
            // What is nothing has no place on a logarithmic axis.
            (f64::from(*delay), all.map(of).fold(1e-4, f64::max))
        };
        delays.iter().map(at).collect::<Vec<_>>()
    };
    let plot = Plot {
        x: "round trip, ms".into(),
        y: "energy of the worst case, mJ".into(),
        log: (false, true),
        series: vec![
            Series {
                name: "without controller".into(),
                points: worst(|l| l.energy_mj),
                joined: true,
            },
            Series {
                name: "with".into(),
                points: worst(|l| l.energy_controlled_mj),
                joined: true,
            },
        ],
        limit: Some((FELT_MJ, "what is not felt".into())),
    };
    let _ = write!(
        html,
        "<figure>{}<figcaption>The worst case at each delay. Good is under the line.</figcaption></figure>",
        plot.svg()
    );
    html.push_str("<div><h3>A hand at rest in contact</h3><table class=\"small\"><thead><tr><th>case</th><th>repeats after</th><th>ticks run</th><th>drift, µm</th><th>force, N</th><th></th></tr></thead><tbody>");
    for hour in &found.hours {
        let period = match hour.period_ticks {
            Some(1) => "stands still".to_owned(),
            Some(n) => format!("{n} ticks"),
            None if hour.whole_hour => "not in an hour".to_owned(),
            None => format!("not in {} min", hour.ticks_run / 60_000),
        };
        let _ = writeln!(
            html,
            "<tr><td>{0}</td><td>{period}</td><td>{2}</td><td>{3:.4}</td><td>{4:.2}</td><td class=\"{1}\">{1}</td></tr>",
            hour.case,
            holds(hour.holds()),
            hour.ticks_run,
            hour.drift_um,
            hour.force_n
        );
    }
    html.push_str("</tbody></table><p class=\"note\">Without tremor. Once the whole state repeats bit for bit the rest of an hour is proven, not run; where it does not, that many ticks were; the tests run the whole hour of each. Good is a drift under 1 µm.</p></div></div>\n");
    let mut by_energy: Vec<&Loop> = found.loops.iter().collect();
    by_energy.sort_by(|a, b| b.energy_mj.total_cmp(&a.energy_mj));
    html.push_str("<details><summary>All links, most energy first</summary><table class=\"small\"><thead><tr><th>case</th><th>round trip, ms</th><th>energy, mJ</th><th>with controller</th><th>in one period, mJ</th><th></th><th>taken out, mJ</th><th>acted, %</th><th>off, %</th><th>with controller</th></tr></thead><tbody>");
    for l in by_energy {
        let _ = writeln!(
            html,
            "<tr><td>{0}</td><td>{1}</td><td>{2:.4}</td><td>{3:.4}</td><td>{4:.4}</td><td class=\"{5}\">{6}</td><td>{7:.3}</td><td>{8:.2}</td><td>{9:.1}</td><td>{10:.1}</td></tr>",
            l.case,
            l.delay_ms,
            l.energy_mj,
            l.energy_controlled_mj,
            l.period_work_mj,
            holds(l.passive),
            if l.passive { "passive" } else { "not passive" },
            l.taken_mj,
            l.acted_percent,
            l.infidelity_percent,
            l.infidelity_controlled_percent
        );
    }
    html.push_str("</tbody></table></details></section>\n");
}
