//! The page of `sulcus-server report`: three answers first, then what they stand on.
//!
//! `report.html` needs nothing but itself.

mod answers;
mod cases;
mod loops;
mod matrix;
mod paper;
mod plots;
mod rates;

use std::fmt::Write;

pub(crate) use answers::{answers, failures};

use super::html::{STYLE, escaped};
use crate::picture::data_uri;
use crate::report::Report;

const MORE_STYLE: &str = "
.answers{display:grid;grid-template-columns:repeat(3,minmax(0,1fr));gap:16px;margin:14px 0}
.answers section{margin:0;padding:14px 18px}
.answers h2{font-size:1.05em;color:#3b424a}.answers .big{font-size:1.55em;font-weight:650;line-height:1.2;margin:.25em 0}
.yes{color:#1f7a34}.no{color:#b01e1e}.so{color:#9a6700}
.answers p{font-size:.92em;margin:.5em 0}
@media(max-width:900px){.answers{grid-template-columns:1fr}}
td:first-child,th:first-child,td.text{text-align:left}
td.holds{color:#1f7a34}td.broken{color:#b01e1e;font-weight:600}td.shown{color:#9a6700}
.two{display:grid;grid-template-columns:repeat(auto-fit,minmax(430px,1fr));gap:18px}
.small{font-size:.86em}
details summary{cursor:pointer;font-weight:600;margin:.6em 0}
";

/// The whole page.
pub(crate) fn page(report: &Report) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n<title>Sulcus: speed against error</title>\n<style>{STYLE}{MORE_STYLE}</style></head>\n<body><main>\n<h1>Speed against error</h1>\n"
    );
    machine(&mut html, report);
    html.push_str("<div class=\"answers\">");
    for answer in answers(report) {
        let _ = write!(
            html,
            "<section><h2>{}</h2><div class=\"big {}\">{}</div>{}</section>",
            escaped(answer.question),
            answer.mood,
            escaped(&answer.short),
            answer.long,
        );
    }
    html.push_str("</div>\n");
    plots::speed(&mut html, report);
    matrix::matrix(&mut html, report);
    rates::rates(&mut html, report);
    cases::hard_cases(&mut html, report);
    cases::random_poses(&mut html, report);
    loops::loops(&mut html, report);
    plots::growth(&mut html, report);
    plots::one_dof(&mut html, report);
    elements(&mut html, report);
    peers(&mut html, report);
    if let Some(beside) = &report.paper {
        paper::paper(&mut html, beside);
    }
    html.push_str("</main></body></html>\n");
    html
}

fn machine(html: &mut String, report: &Report) {
    let m = &report.machine;
    let busy = if m.load > 1.25 * m.logical_cores as f64 {
        " <b class=\"so\">busy: times are too long</b>"
    } else {
        ""
    };
    let _ = writeln!(
        html,
        "<div class=\"facts\"><div><b>{}</b>, {} logical cores, {:.1} GiB</div><div>{}</div><div>load {:.1}{busy}</div><div>{}, {} build</div><div>{} report, {:.0} s</div></div>",
        escaped(&m.processor),
        m.logical_cores,
        m.memory_gib,
        escaped(&m.system),
        m.load,
        report.program,
        m.build,
        if report.quick { "quick" } else { "full" },
        report.took_s,
    );
}

fn elements(html: &mut String, report: &Report) {
    html.push_str("<section id=\"elements\"><h2>Tissue against finite elements</h2>\n<p class=\"note\">The program's own tongue under the same pushes: a mesh of quadratic tetrahedra, and the models that run in the tick (under a linear law without the term for large displacements, which they have in the tick). <b>rel. L2</b> is the error over the displacement: 100 % is a model that never moves, good is under 10 %.</p>\n<div class=\"wide\"><table><thead><tr><th>push</th><th>model</th><th>largest displacement, mm</th><th>rms, %</th><th>rel. L2, %</th><th>max, %</th></tr></thead><tbody>\n");
    for e in &report.finite_elements {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"text\">{}</td><td>{:.2}</td><td>{:.2}</td><td>{:.1}</td><td>{:.1}</td></tr>",
            escaped(&e.case),
            e.model,
            e.max_displacement_mm,
            e.rms_percent,
            e.rel_l2_percent,
            e.max_percent
        );
    }
    html.push_str("</tbody></table></div>\n");
    for e in &report.finite_elements {
        let open = if e.model == "surface_compliance" {
            " open"
        } else {
            ""
        };
        let _ = writeln!(
            html,
            "<details{open}><summary>{}: {}</summary><img src=\"{}\" alt=\"deformed shapes, {}, coloured by error\"></details>",
            e.model,
            escaped(&e.case),
            data_uri("image/png", &e.picture_png),
            e.model,
        );
    }
    html.push_str("</section>\n");
}

fn peers(html: &mut String, report: &Report) {
    html.push_str("<section id=\"peers\"><h2>Other engines on the same path</h2>\n");
    let Some(peers) = &report.peers else {
        html.push_str("<p class=\"note\">Not in this report. <code>cargo bench -p sulcus-peers --features rapier</code> writes a file that <code>--peers</code> takes in.</p></section>\n");
        return;
    };
    let list = |name: &str| peers[name].as_array().cloned().unwrap_or_default();
    let number = |value: &serde_json::Value| {
        value.as_f64().map_or("–".to_owned(), |x| {
            if x.abs() >= 100.0 {
                format!("{x:.0}")
            } else {
                format!("{x:.2}")
            }
        })
    };
    let text = |value: &serde_json::Value| escaped(value.as_str().unwrap_or(""));
    html.push_str("<p class=\"note\">From one run of a bench of its own; ratios are the best of theirs over ours, at least what is asked. What touches is in ours the spheres, in converged ticks (hold the pointer over a row for the others), in theirs the shapes with their skin.</p><div class=\"wide\"><table><thead><tr><th>ratio</th><th>found</th><th>asked</th><th></th></tr></thead><tbody>");
    for ratio in list("ratios") {
        let holds = ratio["holds"].as_bool().unwrap_or(false);
        let (class, word) = if holds {
            ("holds", "holds")
        } else {
            ("broken", "does not hold")
        };
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"{class}\">{word}</td></tr>",
            text(&ratio["name"]),
            number(&ratio["value"]),
            number(&ratio["at_least"]),
        );
    }
    html.push_str("</tbody></table></div><div class=\"wide\"><table class=\"small\"><thead><tr><th>scene</th><th>engine</th><th>p50, µs</th><th>p99</th><th>p99.9</th><th>max</th><th>penetration of what is drawn, µm</th><th>off it under load, µm</th><th>penetration of what touches, µm</th><th>force step, N</th></tr></thead><tbody>");
    for row in list("rows") {
        let t = &row["tick_us"];
        let _ = writeln!(
            html,
            "<tr title=\"{}\"><td>{}</td><td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            text(&row["note"]),
            text(&row["scene"]),
            text(&row["engine"]),
            number(&t["p50"]),
            number(&t["p99"]),
            number(&t["p999"]),
            number(&t["max"]),
            number(&row["penetration_um"]),
            number(&row["apart_um"]),
            number(&row["residual_um"]),
            number(&row["force_step_n"]),
        );
    }
    html.push_str("</tbody></table></div></section>\n");
}

#[cfg(test)]
mod tests;
