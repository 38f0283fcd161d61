//! The page of a class: who stands where, which sites are hard, what to teach next, and the trend of every learner.

use std::fmt::Write as _;

use sulcus_core::tissue::gingiva::Site;

use super::jaw::{Jaw, across};
use super::{Look, escaped, page, trend};
use crate::grade::class::Session;
use crate::grade::definitions::METRICS;
use crate::grade::revision::Sidecar;
use crate::grade::stats::{mean, median, percent, rounded};

/// The page of all sessions, sorted by exercise, learner and attempt; `unread`: files that could not be read, and why.
pub fn class_page(sessions: &[Session], unread: &[(String, String)], look: &Look<'_>) -> String {
    let mut html = String::from("<h1>Class</h1>\n");
    let graded = sessions
        .iter()
        .filter(|session| session.grade.score.is_some())
        .count();
    let _ = writeln!(
        html,
        "<p class=\"who\">{} sessions, {graded} of them graded; scores are proposals of the program, from replays.</p>",
        sessions.len()
    );
    for (file, why) in unread {
        let _ = writeln!(
            html,
            "<p class=\"fail\">Not read: {}: {}</p>",
            escaped(file),
            escaped(why)
        );
    }
    for group in sessions.chunk_by(|a, b| a.grade.exercise == b.grade.exercise) {
        exercise(&mut html, group, look);
    }
    page("Class", &html)
}

fn exercise(html: &mut String, all: &[Session], look: &Look<'_>) {
    let name = escaped(&all[0].grade.exercise);
    let mut rubrics: Vec<String> = Vec::new();
    for used in all
        .iter()
        .filter_map(|session| session.grade.rubric.as_ref())
    {
        let one = format!(
            "{} version {} ({})",
            escaped(&used.name),
            used.version,
            &used.blake3[..12]
        );
        if !rubrics.contains(&one) {
            rubrics.push(one);
        }
    }
    let _ = writeln!(
        html,
        "<section><h2>Exercise {name}</h2><p class=\"small\">rubric {}</p>",
        rubrics.join("; ")
    );
    if rubrics.len() > 1 {
        html.push_str("<p class=\"fail\">Graded by more than one rubric: scores cannot be compared as they stand.</p>\n");
    }
    // (In an exam neither what is prescribed nor what to practise is shown, and of one session the map tells both.)
    let open: Vec<Session> = all.iter().filter(|one| !one.is_exam()).cloned().collect();
    let heat = heat_map(&open, look);
    let learners: Vec<&[Session]> = all.chunk_by(|a, b| a.is_of_the_same(b)).collect();
    html.push_str("<div class=\"two\"><section>\n<h2>Learners, last attempt</h2>\n");
    table(html, &learners, look);
    html.push_str("</section><section>\n<h2>What the class loses points on</h2>\n");
    losses(html, all);
    html.push_str("</section></div>\n");
    if !heat.is_empty() {
        let _ = writeln!(
            html,
            "<section><h2>Sites: share of calls within 1 mm, and mean error</h2>\n{heat}<p class=\"small\">Upper number: percent of all sessions but exams in which the site was called within 1 mm of what is prescribed (a site that was missed counts as not); the darker, the fewer. Lower number: mean of called less prescribed, mm; positive reads too deep. {}; the patient&#8217;s right is on the left.</p></section>",
            look.numbering.name()
        );
    }
    html.push_str("<section><h2>Trend over attempts</h2>\n<div style=\"display:grid;grid-template-columns:repeat(auto-fill,minmax(140px,1fr));gap:6px 12px\">\n");
    for attempts in learners {
        let mut marks = attempts.iter().rev().filter_map(|one| one.grade.pass_mark);
        let pass = marks.next().unwrap_or_default();
        let all: Vec<&Session> = attempts.iter().collect();
        let _ = writeln!(
            html,
            "<div style=\"break-inside:avoid\"><div class=\"small\"><b>{}</b>{}</div>{}</div>",
            look.learner(&attempts[0].grade.learner_id),
            if attempts[0].is_exam() { ", exam" } else { "" },
            trend::svg(&all, pass)
        );
    }
    html.push_str("</div>\n<p class=\"small\">Full dot: passed, ring: not passed, diamond: an instructor&#8217;s score, broken line: pass mark. One session says little: averages over many do.</p></section></section>\n");
}

fn table(html: &mut String, learners: &[&[Session]], look: &Look<'_>) {
    html.push_str("<table><thead><tr><th>learner</th><th class=\"text\">mode</th><th>attempts</th><th>score</th><th>own</th><th>revised</th><th class=\"text\">passed</th><th class=\"text\">weakest</th></tr></thead><tbody>\n");
    for attempts in learners {
        let Some(last) = attempts.last() else {
            continue;
        };
        let number = |x: Option<f64>| x.map_or("&#8211;".into(), |x| format!("{x:.1}"));
        let revised = last.sidecar.as_ref().and_then(Sidecar::latest);
        let passed = match last.counts().1 {
            Some(true) => "yes",
            Some(false) => "no",
            None => "no grade",
        };
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"text\">{passed}</td><td class=\"text\">{}</td></tr>",
            look.learner(&last.grade.learner_id),
            last.shown.mode,
            last.attempt,
            number(last.grade.score),
            number(last.self_score),
            number(revised.map(|said| said.score)),
            last.grade
                .advice
                .first()
                .filter(|_| !last.is_exam())
                .map_or(String::new(), |advice| escaped(advice.title)),
        );
    }
    html.push_str("</tbody></table>\n");
}

/// Metrics by the points that they cost on average.
fn losses(html: &mut String, all: &[Session]) {
    let mut lost: Vec<(f64, &str)> = Vec::new();
    for known in METRICS {
        let each: Vec<f64> = all
            .iter()
            .filter_map(|session| {
                let metric = session.grade.metric(known.name)?;
                let weights = session.grade.metrics.iter().filter(|m| m.score.is_some());
                let sum: f64 = weights.map(|m| m.weight).sum();
                Some(metric.weight * (100.0 - metric.score?) / sum.max(1e-9) + metric.deducted)
            })
            .collect();
        if let Some(mean) = mean(&each).filter(|mean| *mean >= 0.05) {
            lost.push((mean, known.title));
        }
    }
    lost.sort_by(|a, b| b.0.total_cmp(&a.0));
    html.push_str(
        "<table><thead><tr><th>metric</th><th>points lost, mean</th></tr></thead><tbody>\n",
    );
    for (points, title) in lost.iter().take(8) {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{points:.1}</td></tr>",
            escaped(title)
        );
    }
    html.push_str("</tbody></table>\n");
    let mut scores: Vec<f64> = all
        .iter()
        .filter_map(|session| session.grade.score)
        .collect();
    scores.sort_by(f64::total_cmp);
    if let Some(middle) = median(&scores) {
        let _ = writeln!(
            html,
            "<p class=\"small\">Scores {:.1} to {:.1}, median {middle:.1}.</p>",
            scores[0],
            scores[scores.len() - 1]
        );
    }
}

/// What a class made of one site.
struct OfClass {
    within: Option<f64>,
    bias: Option<f64>,
}

fn of_site(all: &[Session], tooth: u8, site: Site) -> Option<OfClass> {
    let zones: Vec<_> = all
        .iter()
        .flat_map(|session| &session.grade.sites)
        .filter(|one| one.asked && (one.tooth, one.site) == (tooth, site))
        .collect();
    if zones.is_empty() {
        return None;
    }
    let errors: Vec<f64> = zones.iter().filter_map(|one| one.error_mm()).collect();
    let near = errors
        .iter()
        .filter(|error| error.abs() <= 1.0 + 1e-9)
        .count();
    Some(OfClass {
        within: percent(near, zones.len()),
        bias: mean(&errors),
    })
}

/// The teeth asked for, six cells to a tooth, laid out as on a chart.
fn heat_map(all: &[Session], look: &Look<'_>) -> String {
    const CELL: f64 = 40.0;
    const HIGH: f64 = 27.0;
    let mut svg = String::new();
    for jaw in [Jaw::Upper, Jaw::Lower] {
        let asked = |fdi: &u8| {
            Site::ALL
                .iter()
                .any(|site| of_site(all, *fdi, *site).is_some())
        };
        let teeth: Vec<u8> = jaw.teeth().into_iter().filter(asked).collect();
        if teeth.is_empty() {
            continue;
        }
        let wide = 3.0 * CELL + 10.0;
        let width = 60.0 + wide * teeth.len() as f64;
        let height = 2.0 * HIGH + 20.0;
        let _ = write!(
            svg,
            "<svg viewBox=\"0 0 {width:.0} {height:.0}\" style=\"max-width:{width:.0}px\" role=\"img\" aria-label=\"heat map of sites, {}\" font-size=\"10\">",
            jaw.name()
        );
        for (row, (buccal, name)) in jaw.rows().into_iter().enumerate() {
            let top = if row == 0 { 0.0 } else { HIGH + 18.0 };
            let _ = write!(
                svg,
                "<text x=\"0\" y=\"{:.1}\">{name}</text>",
                top + 0.6 * HIGH
            );
            for (k, fdi) in teeth.iter().enumerate() {
                for (j, site) in across(*fdi, buccal).into_iter().enumerate() {
                    let x = 54.0 + wide * k as f64 + CELL * j as f64;
                    cell(&mut svg, of_site(all, *fdi, site), (x, top), (CELL, HIGH));
                }
            }
        }
        for (k, fdi) in teeth.iter().enumerate() {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"12\" font-weight=\"700\" text-anchor=\"middle\">{}</text>",
                54.0 + wide * k as f64 + 1.5 * CELL,
                HIGH + 13.0,
                look.numbering.of(*fdi)
            );
        }
        svg.push_str("</svg>\n");
    }
    svg
}

fn cell(svg: &mut String, site: Option<OfClass>, (x, y): (f64, f64), (wide, high): (f64, f64)) {
    let Some(site) = site else {
        let _ = write!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide}\" height=\"{high}\" fill=\"none\" stroke=\"#ccc\"/>"
        );
        return;
    };
    let within = site.within.unwrap_or_default();
    // From white to a red so dark that it is nearly black in grey.
    let mix = |full: f64| (255.0 - (255.0 - full) * (1.0 - within / 100.0)).round() as u8;
    let (r, g, b) = (mix(122.0), mix(10.0), mix(30.0));
    let ink = if within < 55.0 { "#fff" } else { "#000" };
    let bias = site.bias.map_or("&#8211;".into(), |bias| {
        format!("{:+.1}", rounded(bias, 1)).replace('-', "&#8722;")
    });
    let _ = write!(
        svg,
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide}\" height=\"{high}\" fill=\"rgb({r},{g},{b})\" stroke=\"#333\"/><text x=\"{0:.1}\" y=\"{1:.1}\" text-anchor=\"middle\" font-weight=\"700\" fill=\"{ink}\">{within:.0} %</text><text x=\"{0:.1}\" y=\"{2:.1}\" text-anchor=\"middle\" font-size=\"9\" fill=\"{ink}\">{bias}</text>",
        x + 0.5 * wide,
        y + 12.0,
        y + 23.0
    );
}
