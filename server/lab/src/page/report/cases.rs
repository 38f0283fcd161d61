//! The tables of the hard cases and of random poses.

use std::fmt::Write;

use super::super::html::escaped;
use crate::report::Report;

pub(super) fn hard_cases(html: &mut String, report: &Report) {
    html.push_str("<section id=\"hard-cases\"><h2>Hard cases</h2>\n<p class=\"note\">Each is a scene, a hand and what must hold; <code>sulcus-client demo --exercise hard/NAME</code> performs it. <b>Residual</b>: deepest overlap of any two spheres in a converged tick, by a query of its own; good is under 1 µm. <b>Jump</b>: how much farther than the hand the drawn tool goes in a tick. <b>Click</b>: largest change of the force in a tick beyond what a hand at up to 0.2 m/s brings with its motion and its turning; good is under 0.02 N. <b>Buzz</b>: mean second difference of the force. <b>Energy</b>: the most that came out of the wrench into the hand; hands that are moved by a script, whatever they feel, may be given much. <b>Margin</b>: how far from going through it was, where there is something to go through. <b>Passes</b>: what continuous collision costs, passes of both tools in a tick in contact, mean and most; <b>outrun</b>: ticks that ran out of them and were finished by the next. Times are CPU time of ticks in contact. <b>Shown</b>: the method as printed, of which nothing is asked.</p>\n<div class=\"wide\"><table class=\"small\"><thead><tr><th>case</th><th>method</th><th>solver</th><th>yields</th><th>level</th><th>p50, µs</th><th>p99</th><th>p99.9</th><th>max</th><th>residual, µm</th><th>jump, µm</th><th>click, N</th><th>buzz, N</th><th>energy, mJ</th><th>margin, mm</th><th>passes</th><th>most</th><th>outrun</th><th></th></tr></thead><tbody>\n");
    for row in &report.rows {
        let t = &row.times.tick_us;
        let why = escaped(&row.broken.join("; "));
        let _ = writeln!(
            html,
            "<tr title=\"{}\"><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{}</td><td>{:.1}</td><td>{:.1}</td><td>{:.1}</td><td>{:.0}</td><td>{:.3}</td><td>{:.0}</td><td>{:.4}</td><td>{:.4}</td><td>{:.2}</td><td>{}</td><td>{:.2}</td><td>{}</td><td>{}</td><td class=\"{}\" title=\"{why}\">{}</td></tr>",
            escaped(row.about),
            row.case,
            row.method,
            row.solver,
            escaped(
                &row.tissue
                    .replace("surface_compliance", "surface compliance")
            ),
            row.level,
            t.p50,
            t.p99,
            t.p999,
            t.max,
            row.residual_um,
            row.graphic_jump_um,
            row.slow_force_step_n,
            row.buzz_n,
            row.energy_mj,
            row.margin_mm
                .map_or("–".to_owned(), |mm| format!("{mm:.2}")),
            row.passes_mean,
            row.passes_max,
            row.exhausted_ticks,
            row.status,
            row.status,
        );
    }
    html.push_str("</tbody></table></div>\n");
    let unwell: Vec<_> = report
        .rows
        .iter()
        .filter(|row| !row.broken.is_empty())
        .collect();
    if !unwell.is_empty() {
        html.push_str(
            "<details><summary>What does not hold, in words</summary><ul class=\"small\">",
        );
        for row in unwell {
            let _ = writeln!(
                html,
                "<li><b>{}</b>, {}, {}: {}</li>",
                row.case,
                row.method,
                row.solver,
                escaped(&row.broken.join("; "))
            );
        }
        html.push_str("</ul></details>\n");
    }
    html.push_str("</section>\n");
}

pub(super) fn random_poses(html: &mut String, report: &Report) {
    html.push_str("<section id=\"random-poses\"><h2>Random poses</h2>\n<p class=\"note\">A walk with leaps of many millimetres, turns, absences and numbers that are none, where there is much to touch. Good: no number that is not finite, no fault of a tick, residual under 1 µm, click under 0.02 N. <b>While outrun</b>: overlap in ticks that ran out of passes and go on in the next; good is under 10 µm for what does not yield, and soft tissue that a leap of centimetres strikes is entered by up to millimetres; how many ticks and how deep is bounded for each scene.</p>\n<div class=\"wide\"><table class=\"small\"><thead><tr><th>scene</th><th>ticks</th><th>in contact</th><th>bad input</th><th>not finite</th><th>faults</th><th>outrun</th><th>% of ticks</th><th>no answer</th><th>residual, µm</th><th>while outrun, µm</th><th>click, N</th><th>force, N</th></tr></thead><tbody>\n");
    for r in &report.random_poses {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.1}</td><td>{}</td><td>{:.3}</td><td>{:.1}</td><td>{:.4}</td><td>{:.2}</td></tr>",
            escaped(r.scene),
            r.ticks,
            r.contact_ticks,
            r.bad_input,
            r.not_finite,
            r.faults,
            r.exhausted_ticks,
            r.exhausted_percent,
            r.solver_failed,
            r.residual_um,
            r.exhausted_residual_um,
            r.slow_force_step_n,
            r.max_force_n,
        );
    }
    html.push_str("</tbody></table></div></section>\n");
}
