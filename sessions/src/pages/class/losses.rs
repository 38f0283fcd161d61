//! Points that a class loses, by metric.

use crate::grade::class::Session;
use crate::grade::definitions::METRICS;
use crate::grade::stats::{mean, median};

/// Most metrics of the table.
const MOST: usize = 8;
/// Smallest loss that is listed, points: the smallest that is not rounded to 0.0.
const LEAST: f64 = 0.05;

/// Losses of a class at one exercise.
pub struct Losses {
    /// Titles of metrics with the mean loss in points, the largest first.
    pub metrics: Vec<(&'static str, f64)>,
    /// Smallest, largest and median score; none without a grade.
    pub scores: Option<[f64; 3]>,
}

impl Losses {
    /// Losses of all sessions.
    pub fn of(all: &[Session]) -> Self {
        let mut metrics: Vec<(&'static str, f64)> = Vec::new();
        for known in METRICS {
            let each = all.iter().filter_map(|session| lost(session, known.name));
            let each: Vec<f64> = each.collect();
            if let Some(mean) = mean(&each).filter(|mean| *mean >= LEAST) {
                metrics.push((known.title, mean));
            }
        }
        metrics.sort_by(|a, b| b.1.total_cmp(&a.1));
        metrics.truncate(MOST);
        let mut scores: Vec<f64> = all.iter().filter_map(|one| one.grade.score).collect();
        scores.sort_by(f64::total_cmp);
        let middle = median(&scores);
        Self {
            metrics,
            scores: middle.map(|middle| [scores[0], scores[scores.len() - 1], middle]),
        }
    }
}

/// Points that a session lost by one metric; none if the metric has no score.
fn lost(session: &Session, name: &str) -> Option<f64> {
    let metric = session.grade.metric(name)?;
    let weights = session.grade.metrics.iter().filter(|m| m.score.is_some());
    let sum: f64 = weights.map(|m| m.weight).sum();
    Some(metric.weight * (100.0 - metric.score?) / sum.max(1e-9) + metric.deducted)
}
