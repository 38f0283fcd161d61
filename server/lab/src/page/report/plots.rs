//! The plots of the page: speed against error, how times grow, stability with one degree of freedom.

use std::fmt::Write;

use super::super::html::escaped;
use super::super::plot::{Plot, Series};
use crate::report::{Line, Report, SHARES};

fn figure(html: &mut String, plot: &Plot, caption: &str) {
    let _ = write!(
        html,
        "<figure>{}<figcaption>{caption}</figcaption></figure>",
        plot.svg()
    );
}

/// A line of points that are joined.
fn joined(name: impl Into<String>, points: Vec<(f64, f64)>) -> Series {
    Series {
        name: name.into(),
        points,
        joined: true,
    }
}

pub(super) fn speed(html: &mut String, report: &Report) {
    let levels = &report.mouth.levels;
    html.push_str("<section id=\"speed\"><h2>What a better answer costs</h2>\n<div class=\"two\">");
    let against = |name: &str, of: fn(&crate::report::Level) -> (f64, f64)| {
        joined(name, levels.iter().map(of).collect())
    };
    let plot = Plot {
        x: "time of a tick at p99.9, us".into(),
        y: "touched tooth off drawn tooth, um".into(),
        log: (true, true),
        series: vec![
            against("mean error", |l| {
                (l.times.tick_us.p999, l.tooth_error_mean_um)
            }),
            against("largest error", |l| {
                (l.times.tick_us.p999, l.tooth_error_max_um)
            }),
        ],
        limit: None,
    };
    figure(
        html,
        &plot,
        "Every point is a level of the teeth, from 2 at the top to 4 at the bottom, all under one recorded hand, which felt level 3. Good is down and left; 1,000 µs is the limit at 1 kHz.",
    );
    let tail = |level: &crate::report::Level| {
        let shares = SHARES.iter().map(|share| 100.0 * share);
        joined(
            format!("level {}", level.level),
            level.longer_than_us.iter().copied().zip(shares).collect(),
        )
    };
    let plot = Plot {
        x: "time of a tick, us".into(),
        y: "share of ticks that take longer, %".into(),
        log: (true, true),
        series: levels.iter().map(tail).collect(),
        limit: Some((0.1, "one tick of a thousand".into())),
    };
    figure(
        html,
        &plot,
        "How seldom a tick is slow. Good: the line of the thousandth is crossed well left of 1,000 µs.",
    );
    html.push_str("</div>\n<div class=\"wide\"><table><thead><tr><th>the whole mouth</th><th>spheres of a molar</th><th>off the drawn molar, µm mean</th><th>max</th><th>tick p50, µs</th><th>p99</th><th>p99.9</th><th>max</th><th>highest rate at p99.9, kHz</th>");
    if let Some(level) = levels.first() {
        for (name, ..) in &level.times.stages_us {
            let _ = write!(html, "<th>{name} p50 / p99.9</th>");
        }
    }
    html.push_str("</tr></thead><tbody>");
    for level in levels {
        let t = &level.times.tick_us;
        let _ = write!(
            html,
            "<tr><td>level {}{}</td><td>{}</td><td>{:.1}</td><td>{:.0}</td><td>{:.1}</td><td>{:.0}</td><td>{:.0}</td><td>{:.0}</td><td>{:.1}</td>",
            level.level,
            if level.level == 3 { " (shipped)" } else { "" },
            level.spheres,
            level.tooth_error_mean_um,
            level.tooth_error_max_um,
            t.p50,
            t.p99,
            t.p999,
            t.max,
            level.max_hz * 1e-3,
        );
        for (_, p50, p999) in &level.times.stages_us {
            let _ = write!(html, "<td>{p50:.1} / {p999:.0}</td>");
        }
        html.push_str("</tr>\n");
    }
    let _ = writeln!(
        html,
        "</tbody></table></div>\n<p class=\"note\">Patient {}, {} objects, the probe in the pockets of tooth 36, the mirror on the tongue, closed loop. Each stage has the clock's own 0.2 µs or so; p99.9 of stages do not add up to that of the tick.</p></section>",
        report.mouth.patient, report.mouth.objects
    );
}

pub(super) fn growth(html: &mut String, report: &Report) {
    html.push_str(
        "<section id=\"growth\"><h2>A scene costs what it needs</h2>\n<div class=\"two\">",
    );
    for line in &report.growth.lines {
        let of = |value: fn(&crate::report::TickUs) -> f64| {
            line.points
                .iter()
                .map(|p| (p.x, value(&p.times.tick_us)))
                .collect::<Vec<_>>()
        };
        let ends = |of: fn(f64, f64) -> f64, from| line.points.iter().map(|p| p.x).fold(from, of);
        let wide = ends(f64::min, f64::INFINITY) > 0.0 && ends(f64::max, 0.0) > 100.0;
        let plot = Plot {
            x: line.with.split(':').next().unwrap_or(line.with).into(),
            y: "time of a tick, us".into(),
            log: (wide, false),
            series: vec![
                joined("p50", of(|t| t.p50)),
                joined("p99.9", of(|t| t.p999)),
            ],
            limit: None,
        };
        let caption = format!(
            "{}. Should grow: {}.{}{}",
            escaped(line.with),
            escaped(line.should),
            asked(line),
            points(line)
        );
        figure(html, &plot, &caption);
    }
    html.push_str("</div></section>\n");
}

/// What is asked of a line in figures, and whether it is so.
fn asked(line: &Line) -> String {
    let each = line.asked.iter().map(|asked| {
        let (class, said) = match asked.holds() {
            true => ("holds", "as it should"),
            false => ("broken", "more than it should"),
        };
        format!(
            " {}: {:.2} (at most {:.1}), <span class=\"{class}\">{said}</span>.",
            escaped(&asked.what),
            asked.found,
            asked.at_most
        )
    });
    each.collect()
}

fn points(line: &Line) -> String {
    let mut html = "<table class=\"small\"><tbody>".to_owned();
    for p in &line.points {
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{:.1} µs p50</td><td>{:.1} µs p99.9</td><td>{:.1} rows</td><td>{:.2} passes</td></tr>",
            escaped(&p.what),
            p.times.tick_us.p50,
            p.times.tick_us.p999,
            p.rows,
            p.passes
        );
    }
    html.push_str("</tbody></table>");
    html
}

pub(super) fn one_dof(html: &mut String, report: &Report) {
    let rows = &report.one_dof;
    let of = |value: &dyn Fn(&crate::report::OneDof) -> f64| {
        rows.iter()
            .map(|row| (row.spring_n_per_m, value(row)))
            .collect::<Vec<_>>()
    };
    html.push_str("<section id=\"one-dof\"><h2>One degree of freedom</h2>\n<p class=\"note\">The paper's benchmark (Fig. 7, Table 1): a sphere of 20 g on a spring, pressed by a tool that is coupled with 200 N/m, penalty 5 N/m. The paper's text has no value of the spring; these are ours.</p><div class=\"two\">");
    let plot = Plot {
        x: "spring, N/m".into(),
        y: "largest stable time step, ms".into(),
        log: (true, true),
        series: vec![
            joined("as printed, by Eq. 9", of(&|row| row.limit_ms)),
            Series {
                name: "as printed, found by running it".into(),
                points: of(&|row| row.limit_run_ms),
                joined: false,
            },
        ],
        limit: Some((1.0, "the tick: below it explicit Euler explodes".into())),
    };
    figure(
        html,
        &plot,
        "The printed method's explicit integration has a limit, and Eq. 9 says where. The coupled method has none.",
    );
    let methods = ["as printed", "implicit Euler", "coupled"];
    let ratio = |k: usize| joined(methods[k], of(&|row| row.load_ratio[k]));
    let plot = Plot {
        x: "spring, N/m".into(),
        y: "force on tissue / force on hand".into(),
        log: (true, false),
        series: vec![ratio(0), ratio(2)],
        limit: Some((1.0, "action equals reaction".into())),
    };
    figure(
        html,
        &plot,
        "As printed the tissue feels a penalty's force, not the hand's. Good is 1.",
    );
    html.push_str("</div></section>\n");
}
