//! Pose of a hand's motion at a time.

use sulcus_standins::pose::{Pose, add, norm, scale, unit};
use sulcus_standins::setup::Motion;

/// Pose of `motion` after `t` s.
pub fn at(motion: &Motion, t: f64) -> Pose {
    match motion {
        Motion::Rest(pose) => *pose,
        Motion::Path(points) => path(points, t),
        Motion::Sine {
            middle,
            amplitude,
            turn,
            hz,
        } => {
            let s = (std::f64::consts::TAU * hz * t).sin();
            let pose = Pose {
                position: add(middle.position, *amplitude, s),
                ..*middle
            };
            if norm(*turn) > 0.0 {
                pose.turned(scale(*turn, 1.0), norm(*turn) * s)
            } else {
                pose
            }
        }
        Motion::Jumps { poses, period } => {
            let step = (t / period.max(1e-6)) as usize;
            poses
                .get(step % poses.len().max(1))
                .copied()
                .unwrap_or_default()
        }
    }
}

/// A cubic curve through the points, with the slope between the neighbours at each inner point.
fn path(points: &[(f64, Pose)], t: f64) -> Pose {
    let Some(after) = points.iter().position(|p| p.0 > t) else {
        return points.last().map(|p| p.1).unwrap_or_default();
    };
    if after == 0 {
        return points[0].1;
    }
    let (a, b) = (after - 1, after);
    let span = points[b].0 - points[a].0;
    let u = (t - points[a].0) / span;
    let weights = [
        (1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u),
        u * (1.0 - u) * (1.0 - u) * span,
        u * u * (3.0 - 2.0 * u),
        u * u * (u - 1.0) * span,
    ];
    let (pa, pb) = (flat(&points[a].1), flat(&points[b].1));
    let (va, vb) = (slope(points, a), slope(points, b));
    let mut value = [0.0; 7];
    for i in 0..7 {
        value[i] =
            weights[0] * pa[i] + weights[1] * va[i] + weights[2] * pb[i] + weights[3] * vb[i];
    }
    Pose {
        position: [value[0], value[1], value[2]],
        rotation: unit([value[3], value[4], value[5], value[6]]),
    }
}

fn flat(pose: &Pose) -> [f64; 7] {
    let ([x, y, z], [a, b, c, d]) = (pose.position, pose.rotation);
    [x, y, z, a, b, c, d]
}

/// Slope at the point `i`; zero at both ends.
fn slope(points: &[(f64, Pose)], i: usize) -> [f64; 7] {
    let mut v = [0.0; 7];
    if i == 0 || i + 1 >= points.len() {
        return v;
    }
    let (before, after) = (&points[i - 1], &points[i + 1]);
    let (from, to) = (flat(&before.1), flat(&after.1));
    for k in 0..7 {
        v[k] = (to[k] - from[k]) / (after.0 - before.0);
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_passes_its_points_and_rests_at_its_ends() {
        let points = vec![
            (0.5, Pose::at([0.0; 3])),
            (1.0, Pose::at([0.01, 0.0, 0.0])),
            (1.5, Pose::at([0.03, 0.01, 0.0])),
        ];
        let motion = Motion::Path(points.clone());
        for (t, pose) in &points {
            assert!(norm(add(at(&motion, *t).position, pose.position, -1.0)) < 1e-12);
        }
        assert_eq!(at(&motion, 0.0).position, [0.0; 3]);
        assert_eq!(at(&motion, 9.0).position, [0.03, 0.01, 0.0]);
        let early = at(&motion, 0.501).position[0] / 0.001;
        assert!(early < 1e-3, "speed {early} m/s at the first point");
    }

    #[test]
    fn jumps_return_to_the_first_pose() {
        let motion = Motion::Jumps {
            poses: vec![Pose::at([0.0; 3]), Pose::at([0.1, 0.0, 0.0])],
            period: 0.5,
        };
        let x: Vec<f64> = [0.1, 0.6, 1.1]
            .iter()
            .map(|t| at(&motion, *t).position[0])
            .collect();
        assert_eq!(x, [0.0, 0.1, 0.0]);
    }
}
