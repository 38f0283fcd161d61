//! Trend over attempts: scores of the sessions of each attempt.

use std::collections::BTreeMap;

use crate::house::Recorded;

/// Width of the drawing, pixels of its own scale.
pub const WIDTH: f64 = 640.0;
/// Height of the drawing.
pub const HEIGHT: f64 = 220.0;
/// Margin left and below, for the axes.
const MARGIN: f64 = 34.0;
/// Largest attempt that is drawn.
const MOST: usize = 20;

/// Attempt of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// Number, from 1.
    pub number: usize,
    /// Number of learners.
    pub learners: usize,
    /// Mean of the final scores.
    pub mean: f64,
}

/// Point of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// To the right.
    pub x: f64,
    /// Downwards.
    pub y: f64,
}

/// Trend of sessions of one exercise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trend {
    /// Attempts, the first first.
    pub attempts: Vec<Attempt>,
    /// Sessions, as points.
    pub points: Vec<Point>,
    /// Line through the means.
    pub line: String,
    /// Places of the numbers of the attempts, with the numbers.
    pub ticks: Vec<(f64, usize)>,
}

fn place(number: usize, of: usize, score: f64) -> Point {
    let step = (WIDTH - 2.0 * MARGIN) / (of.max(2) - 1) as f64;
    Point {
        x: (MARGIN + step * (number - 1) as f64).round(),
        y: (HEIGHT - MARGIN - (HEIGHT - 1.5 * MARGIN) * score.clamp(0.0, 100.0) / 100.0).round(),
    }
}

/// Trend of sessions of one exercise. An attempt is a learner's session with a final score; exams and sessions without
/// a learner id are left out.
pub fn trend<'a>(sessions: impl Iterator<Item = &'a Recorded>) -> Trend {
    let mut by_learner: BTreeMap<&str, Vec<(&str, f64)>> = BTreeMap::new();
    for one in sessions.filter(|one| !one.is_exam() && !one.learner.is_empty()) {
        if let (Some(score), _) = one.counts() {
            let attempts = by_learner.entry(&one.learner).or_default();
            attempts.push((&one.started, score));
        }
    }
    let mut scores: Vec<Vec<f64>> = Vec::new();
    for attempts in by_learner.values_mut() {
        attempts.sort_by(|a, b| a.0.cmp(b.0));
        for (k, (_, score)) in attempts.iter().enumerate().take(MOST) {
            if scores.len() <= k {
                scores.push(Vec::new());
            }
            scores[k].push(*score);
        }
    }
    let of = scores.len();
    let mut trend = Trend::default();
    for (k, scores) in scores.iter().enumerate() {
        let number = k + 1;
        let mean = scores.iter().sum::<f64>() / scores.len() as f64;
        trend
            .points
            .extend(scores.iter().map(|score| place(number, of, *score)));
        let at = place(number, of, mean);
        trend.line += &format!("{}{},{}", if k == 0 { "" } else { " " }, at.x, at.y);
        trend.ticks.push((at.x, number));
        trend.attempts.push(Attempt {
            number,
            learners: scores.len(),
            mean,
        });
    }
    trend
}

/// Height of a score in the drawing.
pub fn level(score: f64) -> f64 {
    place(1, 2, score).y
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(learner: &str, started: &str, score: f64, mode: &str) -> Recorded {
        Recorded {
            learner: learner.into(),
            started: started.into(),
            score: Some(score),
            mode: mode.into(),
            ..Recorded::default()
        }
    }

    #[test]
    fn attempts_are_counted_by_learner_in_the_order_of_time() {
        let all = [
            session("s-1", "2026-11-26 09:00", 60.0, "practice"),
            session("s-1", "2026-11-25 09:00", 40.0, "practice"),
            session("s-2", "2026-11-25 10:00", 50.0, "practice"),
            session("s-2", "2026-11-26 10:00", 90.0, "exam"),
            session("", "2026-11-26 10:00", 10.0, "practice"),
        ];
        let found = trend(all.iter());
        let means: Vec<(usize, usize, f64)> = found
            .attempts
            .iter()
            .map(|attempt| (attempt.number, attempt.learners, attempt.mean))
            .collect();
        assert_eq!(means, [(1, 2, 45.0), (2, 1, 60.0)]);
        assert_eq!(found.points.len(), 3);
        assert!(found.points[2].x > found.points[0].x);
        assert!(level(100.0) < level(0.0));
        assert_eq!(trend([].iter()), Trend::default());
    }
}
