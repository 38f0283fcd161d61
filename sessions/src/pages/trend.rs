//! Plot of a learner's scores over the attempts.

use super::svg::{Svg, points};
use crate::grade::class::Session;
use crate::grade::revision::Sidecar;

const WIDE: f64 = 150.0;
const HIGH: f64 = 62.0;

/// Plot of one learner's attempts at one exercise, in order.
pub fn plot(sessions: &[Session], pass_mark: f64) -> Svg {
    Svg::drawing(
        |svg| {
            svg.with("viewBox", format_args!("0 0 {WIDE} {HIGH}"))
                .with("role", "img")
                .with("aria-label", "score over attempts")
                .with("font-size", 8.5)
        },
        |svg| {
            scale(svg, pass_mark);
            scores(svg, sessions);
            for (k, session) in sessions.iter().enumerate() {
                attempt(svg, session, x(k, sessions.len()));
            }
        },
    )
}

/// Place of attempt `k` of `n`.
fn x(k: usize, n: usize) -> f64 {
    if n > 1 {
        22.0 + (WIDE - 34.0) * k as f64 / (n - 1) as f64
    } else {
        0.5 * WIDE
    }
}

/// Height of a score.
fn y(score: f64) -> f64 {
    6.0 + (HIGH - 20.0) * (1.0 - score / 100.0)
}

/// Lines of the scores 0 and 100, and of the pass mark.
fn scale(svg: &mut Svg, pass_mark: f64) {
    for mark in [0.0, 100.0] {
        svg.across(y(mark), 18, WIDE).stroke("#bbb", 0.6).end();
        svg.element("text")
            .with("x", 16)
            .at("y", y(mark) + 3.0)
            .with("text-anchor", "end")
            .text(mark);
    }
    svg.across(y(pass_mark), 18, WIDE)
        .stroke("#555", 0.8)
        .with("stroke-dasharray", "3 2")
        .end();
}

/// Line and dots of the program's scores: a full dot is passed.
fn scores(svg: &mut Svg, sessions: &[Session]) {
    let place = |(k, session): (usize, &Session)| {
        let passed = session.grade.passed == Some(true);
        let score = session.grade.score?;
        Some(((x(k, sessions.len()), y(score)), passed))
    };
    let known: Vec<((f64, f64), bool)> = sessions.iter().enumerate().filter_map(place).collect();
    svg.element("polyline")
        .with("points", points(known.iter().map(|one| one.0)))
        .with("fill", "none")
        .stroke("#111", 1.4)
        .end();
    for ((x, y), passed) in known {
        svg.element("circle")
            .at("cx", x)
            .at("cy", y)
            .with("r", 3)
            .with("fill", if passed { "#111" } else { "#fff" })
            .stroke("#111", 1.2)
            .end();
    }
}

/// Number of an attempt, and a diamond at an instructor's score.
fn attempt(svg: &mut Svg, session: &Session, x: f64) {
    if let Some(said) = session.sidecar.as_ref().and_then(Sidecar::latest) {
        let top = y(said.score) - 4.0;
        svg.element("path")
            .with("d", format_args!("M{x:.1},{top:.1}l4,4l-4,4l-4,-4Z"))
            .with("fill", "#fff")
            .stroke("#111", 1.2)
            .end();
    }
    svg.element("text")
        .xy(x, HIGH - 3.0)
        .with("text-anchor", "middle")
        .text(session.attempt);
}
