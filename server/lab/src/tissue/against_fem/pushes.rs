//! The loads under which models are held against the reference.

use anyhow::Context;
use sulcus_core::Vec3;

use crate::tissue::loads::traction;
use crate::tissue::organ::Organ;

/// A push on the tongue. Places are shares of its box.
pub(super) struct Push {
    pub(super) name: &'static str,
    /// The middle of the push lies on this line along `direction`.
    through: [f64; 3],
    direction: [f64; 3],
    /// Metres.
    radius: f64,
    /// A moderate one and, where there is one, a large one, newtons: about 4 and 10 mm of a tongue of 10 kPa.
    pub(super) forces: &'static [f64],
}

/// The pushes: a broad one on the back of the tip third, as of what holds the tongue down, and one on the left flank of it, as of
/// what holds it aside. Both as broad as this because a narrower one dents the tongue until its skin creases, where no
/// equilibrium is stable. And one over all of its back, as the paper's third load (Fig. 15c).
pub(super) const PUSHES: [Push; 3] = [
    Push {
        name: "tip pressed down",
        through: [0.8, 0.5, 0.5],
        direction: [0.0, 0.0, -1.0],
        radius: 18e-3,
        forces: &[0.2, 0.45],
    },
    Push {
        name: "left flank pushed aside",
        through: [0.82, 0.5, 0.5],
        direction: [0.0, -1.0, 0.0],
        radius: 18e-3,
        forces: &[0.35, 0.8],
    },
    Push {
        name: "back pressed down all over",
        through: [0.6, 0.5, 0.5],
        direction: [0.0, 0.0, -1.0],
        radius: 45e-3,
        forces: &[1.0],
    },
];

impl Push {
    /// One newton of it: on the nodes of the elements, and on the vertices of their surface.
    ///
    /// # Errors
    /// If it meets nothing that can move.
    pub(super) fn one_newton(&self, organ: &Organ) -> anyhow::Result<(Vec<Vec3>, Vec<Vec3>)> {
        let (low, high) = organ.surface.bounds();
        let through = low + Vec3::from(self.through).component_mul(&(high - low));
        let direction = Vec3::from(self.direction);
        let weight = pressing(through, direction, self.radius);
        traction(organ, &direction, &weight)
            .with_context(|| format!("{}: it meets nothing that can move", self.name))
    }
}

/// What a soft round pad of this radius (metres) does that comes along a line: full in its middle, less at its rim, and less on
/// faces that it meets askance; it does not go through to what lies beyond `through`.
fn pressing(through: Vec3, along: Vec3, radius: f64) -> impl Fn(&Vec3, &Vec3) -> f64 {
    move |place, normal| {
        let off = place - through;
        let depth = off.dot(&along);
        if depth > 0.0 {
            return 0.0;
        }
        let across = off - along * depth;
        let rim = (1.0 - across.norm_squared() / (radius * radius)).max(0.0);
        let facing = (-normal.dot(&along)).max(0.0);
        rim * rim * facing
    }
}
