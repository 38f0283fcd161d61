//! Scores over attempts, a little plot for each learner: averages over many tell more than one session.

use std::fmt::Write as _;

use crate::grade::class::Session;
use crate::grade::revision::Sidecar;

const WIDE: f64 = 150.0;
const HIGH: f64 = 62.0;

/// One learner's attempts at one exercise, in order.
pub fn svg(sessions: &[&Session], pass_mark: f64) -> String {
    let n = sessions.len();
    let x = |k: usize| {
        if n > 1 {
            22.0 + (WIDE - 34.0) * k as f64 / (n - 1) as f64
        } else {
            0.5 * WIDE
        }
    };
    let y = |score: f64| 6.0 + (HIGH - 20.0) * (1.0 - score / 100.0);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDE} {HIGH}\" role=\"img\" aria-label=\"score over attempts\" font-size=\"8.5\">"
    );
    for mark in [0.0, 100.0] {
        let _ = write!(
            svg,
            "<line x1=\"18\" y1=\"{0:.1}\" x2=\"{WIDE}\" y2=\"{0:.1}\" stroke=\"#bbb\" stroke-width=\"0.6\"/><text x=\"16\" y=\"{1:.1}\" text-anchor=\"end\">{mark}</text>",
            y(mark),
            y(mark) + 3.0
        );
    }
    let _ = write!(
        svg,
        "<line x1=\"18\" y1=\"{0:.1}\" x2=\"{WIDE}\" y2=\"{0:.1}\" stroke=\"#555\" stroke-width=\"0.8\" stroke-dasharray=\"3 2\"/>",
        y(pass_mark)
    );
    let known: Vec<(usize, f64)> = sessions
        .iter()
        .enumerate()
        .filter_map(|(k, session)| Some((k, session.grade.score?)))
        .collect();
    let line: Vec<String> = known
        .iter()
        .map(|(k, score)| format!("{:.1},{:.1}", x(*k), y(*score)))
        .collect();
    let _ = write!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#111\" stroke-width=\"1.4\"/>",
        line.join(" ")
    );
    for (k, score) in &known {
        let passed = sessions[*k].grade.passed == Some(true);
        let fill = if passed { "#111" } else { "#fff" };
        let _ = write!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{fill}\" stroke=\"#111\" stroke-width=\"1.2\"/>",
            x(*k),
            y(*score)
        );
    }
    for (k, session) in sessions.iter().enumerate() {
        if let Some(said) = session.sidecar.as_ref().and_then(Sidecar::latest) {
            let (a, b) = (x(k), y(said.score));
            let _ = write!(
                svg,
                "<path d=\"M{a:.1},{:.1}l4,4l-4,4l-4,-4Z\" fill=\"#fff\" stroke=\"#111\" stroke-width=\"1.2\"/>",
                b - 4.0
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            x(k),
            HIGH - 3.0,
            session.attempt
        );
    }
    svg + "</svg>"
}
