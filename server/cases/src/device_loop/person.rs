//! Hands that follow the script of a case up to a moment and then stay.

use sulcus_core::math::{exp_rotation, log_rotation, norm};
use sulcus_core::{MAX_TOOLS, Pose};
use sulcus_operator::{Felt, Script};

/// Largest speed of a hand's target, m/s. The door takes the force from a faster hand, and nothing would swing.
const FASTEST_M_S: f64 = 0.3;
/// Largest rate of turn of a hand's target, rad/s.
const FASTEST_RAD_S: f64 = 6.0;

/// Hands that follow a script at a limited speed and then stay.
pub(super) struct Person {
    script: Box<dyn Script + Send>,
    rest_s: f64,
    targets: [Option<Pose>; MAX_TOOLS],
    /// Time from which the targets do not move, seconds.
    rested: Option<f64>,
}

impl Person {
    /// Hands that follow `script` up to `rest_s`.
    pub(super) fn new(script: Box<dyn Script + Send>, rest_s: f64) -> Self {
        Self {
            script,
            rest_s,
            targets: [None; MAX_TOOLS],
            rested: None,
        }
    }

    /// Time from which the targets do not move, seconds; `None` before.
    pub(super) fn rested_s(&self) -> Option<f64> {
        self.rested
    }

    /// Targets at `t`. The moment of rest ends the script; a limited target then still moves to its place.
    pub(super) fn targets(
        &mut self,
        t: f64,
        tick_s: f64,
        felt: &Felt,
    ) -> [Option<Pose>; MAX_TOOLS] {
        if self.rested.is_some() {
            return self.targets;
        }
        if t < self.rest_s {
            self.script.feel(felt);
        }
        let wanted = self.script.targets(t.min(self.rest_s));
        for (target, wanted) in self.targets.iter_mut().zip(&wanted) {
            *target = match (&*target, wanted) {
                (Some(from), Some(to)) => Some(towards(from, to, tick_s)),
                _ => *wanted,
            };
        }
        if t >= self.rest_s && self.targets == wanted {
            self.rested = Some(t);
        }
        self.targets
    }
}

/// Pose on the way from `from` to `to` that a hand reaches in `seconds`; `to` itself within reach.
fn towards(from: &Pose, to: &Pose, seconds: f64) -> Pose {
    let way = to.position - from.position;
    let turn = log_rotation(&(to.orientation * from.orientation.inverse()));
    let slower = (norm(&way) / (FASTEST_M_S * seconds))
        .max(norm(&turn) / (FASTEST_RAD_S * seconds))
        .max(1.0);
    if slower == 1.0 {
        return *to;
    }
    Pose::new(
        from.position + way / slower,
        exp_rotation(&(turn / slower)) * from.orientation,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::{Quat, Vec3};
    use sulcus_haptics::Shown;
    use sulcus_operator::script::OneTool;

    #[test]
    fn a_hand_goes_to_the_moment_of_rest_at_its_speed_and_stays() {
        let jump = |t: f64| {
            let x = if t < 0.1 { 0.0 } else { 0.03 };
            Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity())
        };
        let script = Box::new(OneTool {
            pose: jump,
            duration_s: 1.0,
        });
        let mut person = Person::new(script, 0.12);
        let felt = Felt {
            shown: Shown::NOTHING,
            hands: [None; MAX_TOOLS],
        };
        let mut last = 0.0;
        for k in 0..500 {
            let t = f64::from(k) * 1e-3;
            let x = person.targets(t, 1e-3, &felt)[0]
                .expect("a hand")
                .position
                .x;
            assert!(x - last <= FASTEST_M_S * 1e-3 + 1e-12, "{t} s");
            last = x;
        }
        let rested = person.rested_s().expect("a rest");
        assert!((0.199..0.202).contains(&rested), "{rested}");
        assert_eq!(last, 0.03);
    }
}
