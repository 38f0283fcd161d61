//! Weak spring with damping that holds a free handle.

use sulcus_core::Vec3;
use sulcus_core::math::norm;

use super::tip::{Tip, bounded};

/// Stiffness, N/m. With 1 N the handle hangs at most 20 mm low.
const STIFFNESS: f64 = 50.0;
/// Damping, N s/m: critical for 20 g, and stable with a delay of 10 ms for a handle of 30 g or more.
const DAMPING: f64 = 2.0;
/// Largest speed of the target, m/s.
const SPEED: f64 = 0.03;

/// Holder of a free handle.
#[derive(Clone, Debug)]
pub(super) struct Holder {
    /// Place to hold, base axes, metres.
    pub place: Vec3,
    /// Force without motion, newtons: the measured bias against gravity.
    pub bias: Vec3,
    target: Vec3,
    most_n: f64,
}

impl Holder {
    /// Distance from the place at which a handle counts as lost, metres.
    const LOST_M: f64 = 0.06;
    /// Reason of a stage that ends with a lost handle.
    pub const LOST: &str = "the free handle left its place by more than 60 mm";

    /// Creates a holder at the tip's position, with a limit of the force in newtons.
    pub fn new(tip: &Tip, most_n: f64) -> Self {
        Self {
            place: tip.position,
            bias: Vec3::zeros(),
            target: tip.position,
            most_n,
        }
    }

    /// Returns the force of the next period, newtons. The target moves to the place slowly.
    pub fn force(&mut self, tip: &Tip) -> Vec3 {
        self.target += bounded(self.place - self.target, SPEED * tip.seconds);
        let force = (self.target - tip.position) * STIFFNESS - tip.velocity * DAMPING + self.bias;
        bounded(force, self.most_n)
    }

    /// Whether the target has reached the place.
    pub fn is_there(&self) -> bool {
        norm(&(self.place - self.target)) < 1e-6
    }

    /// Whether the handle is far from the place.
    pub fn is_lost(&self, tip: &Tip) -> bool {
        // In this form a NaN is lost.
        let near = norm(&(tip.position - self.target)) < Self::LOST_M;
        !near
    }
}
