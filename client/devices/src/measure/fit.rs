//! Motion of a mass with drag after a step of the force, fitted to positions.
//!
//! `x(t) = a (s - (1 - exp(-c s)) / c) / c` with `s = t - t0` above 0: acceleration `a` at the onset `t0`, and `c` =
//! drag by mass.

/// Motion after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    /// Onset, seconds.
    pub onset: f64,
    /// Acceleration at the onset, m/s2.
    pub acceleration: f64,
    /// Drag by mass, 1/s.
    pub drag: f64,
    /// Sum of the squares of the residuals, m2.
    residual: f64,
}

/// Latest onset of a fit, seconds.
const LATEST: f64 = 0.04;
/// Largest drag by mass of a fit, 1/s.
const MOST_DRAG: f64 = 160.0;

/// Fits a motion to `points`: seconds and metres. `None` for points without a motion in the positive direction.
pub(super) fn fitted(points: &[(f64, f64)]) -> Option<Motion> {
    let (mut best, mut middle) = (None::<Motion>, (0.5 * LATEST, 0.5 * MOST_DRAG));
    let (mut width, mut drags) = (0.55 * LATEST, 0.5 * MOST_DRAG);
    for (along, across) in [(44, 10), (10, 10), (10, 10), (10, 10)] {
        for i in 0..=2 * along {
            let onset = middle.0 + width * (f64::from(i) / f64::from(along) - 1.0);
            for j in 0..=2 * across {
                let drag = middle.1 + drags * (f64::from(j) / f64::from(across) - 1.0);
                let motion = with(points, onset, drag.max(0.0));
                if motion.is_some_and(|m| best.is_none_or(|b| m.residual < b.residual)) {
                    best = motion;
                }
            }
        }
        let found = best?;
        middle = (found.onset, found.drag);
        (width, drags) = (
            2.0 * width / f64::from(along),
            2.0 * drags / f64::from(across),
        );
    }
    best
}

/// Onset of `points` for a given acceleration and drag, seconds. The positions may have an offset of up to `offset`,
/// metres: the place of the rest in a step of the position.
pub(super) fn onset(points: &[(f64, f64)], of: &Motion, offset: f64) -> f64 {
    let residual = |onset: f64| {
        let off = |&(t, x): &(f64, f64)| x - of.acceleration * shape(t - onset, of.drag);
        let count = points.len().max(1) as f64;
        let mean = points.iter().map(off).sum::<f64>() / count;
        let kept = mean.clamp(-offset, offset);
        points
            .iter()
            .map(|point| (off(point) - kept).powi(2))
            .sum::<f64>()
    };
    let (mut best, mut width) = (of.onset, 0.5 * LATEST);
    for _ in 0..4 {
        let steps = (-20..=20).map(|k| best + width * f64::from(k) / 20.0);
        best = steps
            .min_by(|a, b| residual(*a).total_cmp(&residual(*b)))
            .unwrap_or(best);
        width /= 10.0;
    }
    best
}

/// Best acceleration for a given onset and drag.
pub(super) fn with(points: &[(f64, f64)], onset: f64, drag: f64) -> Option<Motion> {
    let (mut shape_shape, mut shape_x, mut x_x) = (0.0, 0.0, 0.0);
    for &(t, x) in points {
        let shape = shape(t - onset, drag);
        shape_shape += shape * shape;
        shape_x += shape * x;
        x_x += x * x;
    }
    let acceleration = shape_x / shape_shape;
    (shape_shape > 0.0 && acceleration > 0.0).then_some(Motion {
        onset,
        acceleration,
        drag,
        residual: x_x - acceleration * shape_x,
    })
}

fn shape(s: f64, drag: f64) -> f64 {
    if s <= 0.0 {
        return 0.0;
    }
    let turns = drag * s;
    if turns < 1e-2 {
        return s * s * (0.5 - turns / 6.0 + turns * turns / 24.0);
    }
    (s + (-turns).exp_m1() / drag) / drag
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_motion_is_found() {
        for (onset, acceleration, drag) in [(0.002, 6.0, 40.0), (0.0, 1.0, 0.0), (0.011, 3.0, 90.0)]
        {
            let points: Vec<(f64, f64)> = (0..60)
                .map(|k| f64::from(k) * 1e-3)
                .map(|t| (t, acceleration * shape(t - onset, drag)))
                .collect();
            let found = fitted(&points).expect("a motion");
            assert!((found.onset - onset).abs() < 1e-4, "{found:?}");
            assert!(
                (found.acceleration / acceleration - 1.0).abs() < 0.03,
                "{found:?}"
            );
            assert!((found.drag - drag).abs() < 3.0, "{found:?}");
        }
        assert_eq!(fitted(&[(0.0, 0.0), (1e-3, -1e-3)]), None);
        assert_eq!(fitted(&[]), None);
    }
}
