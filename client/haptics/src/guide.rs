//! Soft guide along the path of a recorded hand, the ghost of an instructor.
//!
//! A spring pulls the tip of the tool towards the tip of the ghost. Its force has a limit that a hand feels as a hint
//! and not as a contact. The ghost waits for a hand that falls behind. The guide's wrench is added to the wrench of the
//! simulation before the door, and passes the same limits.

use sulcus_core::math::{fmax, fmin, norm};
use sulcus_core::{MAX_TOOLS, Pose, Vec3, Wrench};

/// Parameters of a guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideParams {
    /// Stiffness of the spring, N/m. Default 150.
    pub n_per_m: f64,
    /// Largest force, N, at most [`GuideParams::MOST_N`]. Default 0.3.
    pub most_n: f64,
    /// Distance between the tips up to which the ghost keeps its speed, metres. Default 3 mm.
    pub near_m: f64,
    /// Distance from which the ghost waits, metres. Default 8 mm.
    pub far_m: f64,
}

impl GuideParams {
    /// Limit of the force of every guide, newtons.
    pub const MOST_N: f64 = 0.3;
}

impl Default for GuideParams {
    fn default() -> Self {
        Self {
            n_per_m: 150.0,
            most_n: GuideParams::MOST_N,
            near_m: 3e-3,
            far_m: 8e-3,
        }
    }
}

/// Poses of both tools in one moment of the path, `world_from_tool`; `None` for a tool without a hand.
pub type Moment = [Option<Pose>; MAX_TOOLS];

/// Guide of a session.
#[derive(Clone, Debug)]
pub struct Guide {
    params: GuideParams,
    /// Moments of the path, [`Guide::new`]'s period apart.
    path: Vec<Moment>,
    period_s: f64,
    /// Tips in the frames of the tools, metres.
    tips: [Vec3; MAX_TOOLS],
    /// Position in the path, seconds.
    at_s: f64,
}

impl Guide {
    /// Creates a guide along `path`, whose moments are `period_s` seconds apart. `tips` are the tips in the frames of
    /// the tools. A force limit above [`GuideParams::MOST_N`] is lowered to it.
    pub fn new(
        params: GuideParams,
        path: Vec<Moment>,
        period_s: f64,
        tips: [Vec3; MAX_TOOLS],
    ) -> Self {
        Self {
            params: GuideParams {
                most_n: fmin(params.most_n, GuideParams::MOST_N),
                ..params
            },
            path,
            period_s,
            tips,
            at_s: 0.0,
        }
    }

    /// Poses of the ghost; `None` for a tool without one. The poses stay at the last moment of the path.
    pub fn ghost(&self) -> Moment {
        let last = self.path.len().saturating_sub(1);
        let k = ((self.at_s / self.period_s) as usize).min(last);
        self.path.get(k).copied().unwrap_or([None; MAX_TOOLS])
    }

    /// Whether the ghost has reached the end of its path.
    pub fn is_over(&self) -> bool {
        self.at_s >= self.path.len().saturating_sub(1) as f64 * self.period_s
    }

    /// Advances the ghost by `seconds` and returns the wrenches on the hands, about the device points, world axes.
    /// `hands` are the poses of the tools; a hand without a pose gets no force.
    pub fn step(&mut self, hands: &Moment, seconds: f64) -> [Wrench; MAX_TOOLS] {
        let ghost = self.ghost();
        let away = |t: usize| {
            let (ghost, hand) = (ghost[t].as_ref()?, hands[t].as_ref()?);
            let tip = hand.transform(&self.tips[t]);
            Some((ghost.transform(&self.tips[t]) - tip, tip - hand.position))
        };
        let ways: [Option<(Vec3, Vec3)>; MAX_TOOLS] = std::array::from_fn(away);
        let farthest = ways
            .iter()
            .flatten()
            .map(|(way, _)| norm(way))
            .fold(0.0, fmax);
        // In this form a distance that is no number stops the ghost.
        let p = &self.params;
        let share = fmin(1.0, (p.far_m - farthest) / (p.far_m - p.near_m));
        if share > 0.0 {
            self.at_s += seconds * share;
        }
        ways.map(|way| way.map_or(Wrench::ZERO, |(way, arm)| self.pull(&way, &arm)))
    }

    /// Wrench about the device point for a way to the ghost's tip. `arm` leads from the device point to the tip.
    fn pull(&self, way: &Vec3, arm: &Vec3) -> Wrench {
        let force = way * self.params.n_per_m;
        let length = norm(&force);
        let force = if length > self.params.most_n {
            force * (self.params.most_n / length)
        } else {
            force
        };
        if !force.iter().all(|x| x.is_finite()) {
            return Wrench::ZERO;
        }
        Wrench {
            force,
            torque: arm.cross(&force),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sulcus_core::Quat;

    fn at(x: f64) -> Option<Pose> {
        Some(Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity()))
    }

    /// Path of 1 s along x with 10 mm/s.
    fn guide() -> Guide {
        let path = (0..=1000)
            .map(|ms| [at(f64::from(ms) * 1e-5), None])
            .collect();
        let tips = [Vec3::new(0.0, 0.0, -0.09); MAX_TOOLS];
        Guide::new(GuideParams::default(), path, 1e-3, tips)
    }

    #[test]
    fn the_ghost_waits_for_a_hand_that_falls_behind() {
        let mut guide = guide();
        for _ in 0..3000 {
            guide.step(&[at(0.0), None], 1e-3);
        }
        let x = guide.ghost()[0].expect("a pose").position.x;
        assert!(x > 3e-3 && x < 8e-3, "{x}");
        assert!(!guide.is_over());
        for _ in 0..2000 {
            let hand = guide.ghost()[0];
            guide.step(&[hand, None], 1e-3);
        }
        assert!(guide.is_over());
    }

    #[test]
    fn the_force_pulls_the_tip_to_the_tip() {
        let [wrench, other] = guide().step(&[at(-1e-3), at(0.0)], 1e-3);
        assert!((wrench.force - Vec3::new(0.15, 0.0, 0.0)).norm() < 1e-12);
        // About the device point 90 mm above the tip.
        assert!((wrench.torque - Vec3::new(0.0, -0.0135, 0.0)).norm() < 1e-12);
        assert_eq!(other, Wrench::ZERO);
    }

    proptest! {
        #[test]
        fn no_hand_and_no_path_draws_a_force_above_the_limit(
            most_n in 0.0..100.0_f64,
            n_per_m in 0.0..1e6_f64,
            positions in proptest::collection::vec(proptest::array::uniform3(proptest::num::f64::ANY), 2..20),
        ) {
            let pose = |p: &[f64; 3]| [Some(Pose::new(Vec3::from(*p), Quat::identity())), None];
            let path: Vec<Moment> = positions.iter().map(pose).collect();
            let params = GuideParams { most_n, n_per_m, ..GuideParams::default() };
            let mut guide = Guide::new(params, path, 1e-3, [Vec3::zeros(); MAX_TOOLS]);
            for hand in &positions {
                let [wrench, _] = guide.step(&pose(hand), 1e-3);
                let force = norm(&wrench.force);
                prop_assert!(force <= GuideParams::MOST_N + 1e-12, "{force}");
                prop_assert!(wrench.torque.iter().all(|x| x.is_finite() || force == 0.0));
            }
        }
    }
}
