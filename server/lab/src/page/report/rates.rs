//! The shipped scenes at 1 kHz and beyond.

use std::fmt::Write;

use crate::report::{Rate, Report};

/// Highest of the rates tried that each scene holds, hertz; 0 for none.
pub(super) fn held(rates: &[Rate]) -> Vec<(&'static str, u16)> {
    let mut held: Vec<(&'static str, u16)> = Vec::new();
    for rate in rates {
        let this = if rate.holds { rate.rate_hz } else { 0 };
        match held.iter_mut().find(|(scene, _)| *scene == rate.scene) {
            Some((_, most)) => *most = this.max(*most),
            None => held.push((rate.scene, this)),
        }
    }
    held
}

pub(super) fn rates(html: &mut String, report: &Report) {
    html.push_str("<section id=\"rates\"><h2>Rates beyond 1 kHz</h2>\n<p class=\"note\">The rate is a parameter of the scene (<code>params.rate_hz</code>, <code>--rate-hz</code>): the same hands in the shipped scenes at each, up to the first that is not held (8 kHz is the most that a scene may ask for). Good: p99.9 is under the period; force, residual and click (20 mN in a millisecond, so 5 mN in a tick at 4 kHz) do not get worse. (Residual: looked at every ");
    let _ = write!(
        html,
        "{:.0}",
        crate::report::LOOKS_S[usize::from(report.quick)] * 1e3
    );
    html.push_str(" ms.)</p>\n<div class=\"wide\"><table><thead><tr><th>scene</th><th>ticks a second</th><th>period, µs</th><th>p50, µs</th><th>p99</th><th>p99.9</th><th>max</th><th>holds</th><th>highest at p99.9, kHz</th><th>force, N mean</th><th>residual, µm</th><th>click, mN</th><th>buzz, mN</th></tr></thead><tbody>\n");
    for rate in &report.rates {
        let t = &rate.times.tick_us;
        let (class, holds) = if rate.holds {
            ("holds", "yes")
        } else {
            ("broken", "no")
        };
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{:.0}</td><td>{:.1}</td><td>{:.0}</td><td>{:.0}</td><td>{:.0}</td><td class=\"{class}\">{holds}</td><td>{:.1}</td><td>{:.3}</td><td>{:.2}</td><td>{:.1}</td><td>{:.2}</td></tr>",
            rate.scene,
            rate.rate_hz,
            rate.period_us,
            t.p50,
            t.p99,
            t.p999,
            t.max,
            rate.max_hz * 1e-3,
            rate.force_n,
            rate.residual_um,
            rate.slow_force_step_n * 1e3,
            rate.buzz_n * 1e3,
        );
    }
    html.push_str("</tbody></table></div></section>\n");
}
