//! The report of one session: grade, chart, plots, what to practise, on one sheet.

use std::fmt::Write as _;

use super::chart::Chart;
use super::{Look, date, escaped, page, plots};
use crate::grade::class::Session;
use crate::grade::patient::PatientChart;
use crate::grade::report::{Grade, MetricGrade};
use crate::grade::revision::Proposal;
use crate::grade::run::MEASURES_SOURCE;
use crate::grade::sites::{Finding, SiteGrade};
use crate::grade::{Graded, table};

/// Most pieces of advice that a sheet has room for.
const MOST_ADVICE: usize = 3;
/// Most characters of an instructor's reason, and of who and when, that it has room for.
const MOST_REASON: usize = 200;
const MOST_NAME: usize = 40;

/// The page of one session.
pub fn student_page(session: &Session, graded: &Graded, look: &Look<'_>) -> String {
    let grade = &session.grade;
    let mut html = String::new();
    head(&mut html, session, look);
    if let Some(sidecar) = &session.sidecar {
        // (Those before it, and the whole of a long reason, are in the JSON.)
        if let Some(said) = sidecar.latest() {
            let before = match sidecar.revisions.len() {
                0 | 1 => String::new(),
                all => format!(", revision {all}"),
            };
            let then = sidecar.proposal.differs(&Proposal::of(grade));
            let then = then.map_or(String::new(), |then| format!("; {then} was proposed then"));
            let _ = writeln!(
                html,
                "<p class=\"revised\"><b>Revised by an instructor: {:.1}, {}</b> ({}, {}{before}{}): {}</p>",
                said.score,
                if said.passed { "passed" } else { "not passed" },
                escaped(&clipped(&said.by, MOST_NAME)),
                escaped(&clipped(&said.at, MOST_NAME)),
                escaped(&then),
                escaped(&clipped(&said.reason, MOST_REASON))
            );
        }
    }
    if grade.score.is_none() {
        let why = grade.reason.as_deref().unwrap_or("for no reason known");
        let _ = writeln!(html, "<p class=\"fail\">No grade: {}</p>", escaped(why));
    }
    if !grade.failures.is_empty() {
        let all: Vec<String> = grade.failures.iter().map(|why| escaped(why)).collect();
        let _ = writeln!(
            html,
            "<p class=\"fail\">{}: {}.</p>",
            match session.counts().1 {
                Some(true) => "Not passed in the program&#8217;s proposal",
                _ => "Not passed",
            },
            all.join(" &#183; ")
        );
    }
    if let Some(own) = session.self_score.zip(grade.score) {
        let _ = writeln!(
            html,
            "<p>Own score, given before this grade was: <b>{:.1}</b> ({:+.1} against the program&#8217;s).</p>",
            own.0,
            own.0 - own.1
        );
    }
    if !grade.sites.is_empty() {
        let patient = PatientChart::read(&graded.patient);
        let chart = Chart {
            sites: &grade.sites,
            teeth: &graded.teeth,
            patient: &patient,
            numbering: look.numbering,
            truth: look.truth,
        };
        let _ = writeln!(
            html,
            "<section><h2>Periodontal chart, as called</h2>\n{}</section>",
            chart.html()
        );
    }
    let plot = plots::plot(graded, |fdi| look.numbering.of(fdi));
    if let Some(plot) = plot.filter(|_| !session.is_exam()) {
        let _ = writeln!(
            html,
            "<section><h2>{}</h2>\n{}</section>",
            plot.title, plot.svg
        );
    }
    if grade.score.is_some() {
        html.push_str("<div class=\"two\"><section>");
        metrics(&mut html, grade);
        html.push_str("</section><section>");
        if !session.is_exam() {
            advice(&mut html, grade, look);
        }
        zones(&mut html, session, look);
        html.push_str("</section></div>\n");
        definitions(&mut html, grade);
    }
    let title = format!(
        "{} &#8211; {}",
        look.learner(&grade.learner_id),
        escaped(&grade.exercise)
    );
    page(&title, &html)
}

/// A text, or its beginning with three dots.
fn clipped(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let beginning: String = text.chars().take(most).collect();
    format!("{}...", beginning.trim_end())
}

fn head(html: &mut String, session: &Session, look: &Look<'_>) {
    let grade = &session.grade;
    let short_key = &grade.signer[..grade.signer.len().min(16)];
    let attempt = if session.attempt > 0 {
        format!(", attempt {}", session.attempt)
    } else {
        String::new()
    };
    let _ = write!(
        html,
        "<div class=\"head\"><div><h1>{}</h1><p class=\"who\">exercise <b>{}</b>{attempt}, {} &#183; station {} &#183; {}</p><p class=\"who\">rubric <b>{}</b></p>",
        look.learner(&grade.learner_id),
        escaped(&grade.exercise),
        date(grade.started_unix_ns),
        if grade.station.is_empty() {
            "(none)".into()
        } else {
            escaped(&grade.station)
        },
        escaped(&session.shown.words()),
        escaped(&table::rubric(grade)),
    );
    let _ = write!(
        html,
        "<p class=\"small\">recording {}; graded from its replay; {}{}{}</p></div>",
        escaped(&session.file),
        if grade.signer_trusted {
            format!("signed by the station&#8217;s key {}", escaped(short_key))
        } else {
            format!("signed by {} (not checked)", escaped(short_key))
        },
        grade.migrated.as_ref().map_or(String::new(), |migrated| {
            format!("; migrated {}", escaped(&migrated.to_string()))
        }),
        reservations(grade),
    );
    match grade.score {
        Some(score) => {
            let _ = writeln!(
                html,
                "<div class=\"score\"><div class=\"points\">{score:.1}</div><div class=\"verdict\">{}</div><div class=\"small\">proposed; passed from {}</div></div></div>",
                if grade.passed == Some(true) { "passed" } else { "not passed" },
                grade.pass_mark.unwrap_or_default()
            );
        }
        None => html.push_str("<div class=\"score none\"><div class=\"points\">&#8211;</div><div class=\"verdict\">no grade</div></div></div>\n"),
    }
}

/// What takes from the grade's worth.
fn reservations(grade: &Grade) -> String {
    let all = grade.reservations();
    let all = all.iter();
    all.map(|(says, what)| format!("; <b>{says}: {}</b>", escaped(what)))
        .collect()
}

fn metrics(html: &mut String, grade: &Grade) {
    html.push_str("<h2>What was measured</h2>\n<table><thead><tr><th>metric</th><th>value</th><th>target</th><th>weight</th><th class=\"text\">score</th></tr></thead><tbody>\n");
    let (plain, weighed): (Vec<&MetricGrade>, Vec<&MetricGrade>) = grade
        .metrics
        .iter()
        .partition(|metric| metric.weight == 0.0);
    let (counted, not): (Vec<&MetricGrade>, Vec<&MetricGrade>) = weighed
        .into_iter()
        .partition(|metric| metric.score.is_some());
    for metric in counted {
        let weak = metric.weight > 0.0 && metric.score.is_some_and(|score| score < 50.0);
        let (class, line) = if weak {
            (" class=\"weak\"", " class=\"line weak\"")
        } else {
            ("", " class=\"line\"")
        };
        let _ = writeln!(
            html,
            "<tr title=\"{}\"><td{class}>{}</td><td{line}>{}</td><td class=\"line\">{}</td><td>{}</td><td class=\"text line\">{}</td></tr>",
            escaped(metric.definition),
            escaped(metric.title),
            escaped(&table::value(metric)),
            target(metric),
            metric.weight,
            bar(metric)
        );
    }
    html.push_str("</tbody></table>\n");
    let reported = plain.iter().map(|metric| {
        format!(
            "{} {}",
            escaped(metric.title),
            escaped(&table::value(metric))
        )
    });
    let reported: Vec<String> = reported.collect();
    let not: Vec<String> = not.iter().map(|metric| escaped(metric.title)).collect();
    let rest = [("Reported only", reported), ("Nothing to measure", not)];
    let rest = rest.iter().filter(|(_, all)| !all.is_empty());
    let rest: Vec<String> = rest
        .map(|(what, all)| format!("{what}: {}.", all.join("; ")))
        .collect();
    if !rest.is_empty() {
        let _ = writeln!(html, "<p class=\"small\">{}</p>", rest.join(" "));
    }
}

fn target(metric: &MetricGrade) -> String {
    escaped(&metric.target.to_string()).replace('-', "&#8722;")
}

fn bar(metric: &MetricGrade) -> String {
    metric.score.map_or("&#8211;".into(), |score| {
        format!("<span class=\"bar\"><i style=\"width:{score:.0}%\"></i></span> {score:.0}")
    })
}

fn advice(html: &mut String, grade: &Grade, look: &Look<'_>) {
    html.push_str("<h2>Practise next</h2>\n");
    if grade.advice.is_empty() {
        html.push_str("<p>Nothing stands out: keep it up, with another patient.</p>\n");
        return;
    }
    html.push_str("<ol>\n");
    for advice in grade.advice.iter().take(MOST_ADVICE) {
        let _ = write!(
            html,
            "<li><b>{}.</b> {}",
            escaped(advice.title),
            escaped(&advice.text)
        );
        let sites = advice.sites.iter();
        let sites = sites.map(|site| format!("{} {}", look.numbering.of(site.tooth), site.says));
        let sites: Vec<String> = sites.collect();
        if !sites.is_empty() {
            let _ = write!(
                html,
                " <span class=\"sites\">{}.</span>",
                escaped(&sites.join("; "))
            );
        }
        html.push_str("</li>\n");
    }
    html.push_str("</ol>\n");
}

/// The zones: what the tip reached, what was called, what it comes to.
fn zones(html: &mut String, session: &Session, look: &Look<'_>) {
    let grade = &session.grade;
    if grade.sites.is_empty() {
        return;
    }
    let truth = if look.truth { "<th>true</th>" } else { "" };
    // Where the tip was tells how deep it is.
    let (reached, finding) = match session.is_exam() {
        true => ("", ""),
        false => ("<th>reached</th>", "<th class=\"text\">finding</th>"),
    };
    let _ = write!(
        html,
        "<h2>Zone by zone, mm</h2>\n<table><thead><tr><th>zone</th>{truth}{reached}<th>called</th><th>N</th>{finding}</tr></thead><tbody>\n"
    );
    for site in &grade.sites {
        let mm = |x: Option<f64>| x.map_or("&#8211;".into(), |x| format!("{x:.1}"));
        let truth = if look.truth {
            format!("<td>{}</td>", mm(site.truth_mm))
        } else {
            String::new()
        };
        let class = if site.finding == Finding::Right {
            "text"
        } else {
            "text weak"
        };
        let (reached, finding) = match session.is_exam() {
            true => (String::new(), String::new()),
            false => (
                format!("<td>{}</td>", mm(site.measured_mm)),
                format!("<td class=\"{class}\">{}</td>", in_short(site.finding)),
            ),
        };
        let _ = writeln!(
            html,
            "<tr><td class=\"line\">{} {}</td>{truth}{reached}<td>{}</td><td>{}</td>{finding}</tr>",
            look.numbering.of(site.tooth),
            short(site),
            site.called_mm.map_or("&#8211;".into(), |mm| mm.to_string()),
            site.max_force_n
                .map_or("&#8211;".into(), |n| format!("{n:.2}")),
        );
    }
    html.push_str("</tbody></table>\n");
}

/// A finding where there is little room.
fn in_short(finding: Finding) -> &'static str {
    match finding {
        Finding::NeverReachedFloor => "short of floor",
        Finding::Misread => "misread",
        Finding::ReadTooHeavy => "too heavy",
        Finding::NotProbed => "not probed",
        Finding::ReadTilted => "read tilted",
        Finding::Off => "over 1 mm off",
        other => other.words(),
    }
}

fn short(site: &SiteGrade) -> &'static str {
    ["MB", "B", "DB", "DL", "L", "ML"][site.site as usize]
}

/// For who looks on a screen: what each metric is, and where it comes from. A sheet of paper has no room for it.
fn definitions(html: &mut String, grade: &Grade) {
    html.push_str("<details><summary>Definitions and sources</summary>\n");
    for metric in &grade.metrics {
        let unit = if metric.unit.is_empty() {
            "number"
        } else {
            metric.unit
        };
        let _ = writeln!(
            html,
            "<p><b>{}</b> ({}, {unit}): {} <i>{}.</i> Full score at {}, none at {}.{}</p>",
            escaped(metric.title),
            escaped(metric.name),
            escaped(metric.definition),
            escaped(metric.source),
            target(metric),
            escaped(&metric.zero.to_string()).replace('-', "&#8722;"),
            metric
                .recorded_definition
                .as_ref()
                .map_or(String::new(), |recorded| {
                    format!(" <b>In the recording:</b> {}", escaped(recorded))
                })
        );
    }
    if let Some(set) = &grade.thresholds {
        let _ = writeln!(html, "<p><b>Thresholds</b>: {}.</p>", escaped(&set.words()));
    }
    html.push_str("<p>Scores lie straight between both; the total is their mean by weight, less what is taken off for essentials, and is rounded to 0.1. Percentages and seconds are rounded to 0.1, millimetres to 0.01, newtons to 0.01.</p>\n");
    let _ = writeln!(
        html,
        "<p>Graded by program version {}, measures {MEASURES_SOURCE} (a hash over the sources of tick, events, exercise and grade).</p></details>",
        env!("CARGO_PKG_VERSION")
    );
}

#[cfg(test)]
mod tests {
    use super::clipped;

    #[test]
    fn a_long_reason_is_cut_between_characters_and_a_short_one_is_not() {
        assert_eq!(clipped("finger rest slipped", 200), "finger rest slipped");
        assert_eq!(clipped(&"ü".repeat(200), 200), "ü".repeat(200));
        assert_eq!(clipped(&"ü".repeat(201), 200), "ü".repeat(200) + "...");
        assert_eq!(clipped("slipped twice", 8), "slipped...");
    }
}
