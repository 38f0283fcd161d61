//! The load on the floor, as a hand infers it from the whole wrench on the probe, and how lightly the hand holds the probe
//! across its shaft while it reads.
//!
//! Contacts of the shaft are smooth: each pushes across the shaft alone, and has a moment about the tip. The floor pushes along
//! the tooth's axis at the tip, without a moment.

use sulcus_core::{Pose, Vec3, Wrench};

use super::strokes::Stroke;
use super::{FEEL, KEEP, MOST_ASIDE, Tour};

/// Height over the tip at which a leaning shaft rests on the crown's bulge, or is pushed by the pocket's wall, metres. (Of 16
/// readings in two exercises: 2.0 mm at the sides of teeth, 2.6 mm where a wall pushed.)
const LEVER: f64 = 2e-3;
/// How fast the hand gives way to what pushes the probe across its shaft, m/(N s): with a grip of 300 N/m within 70 ms.
const YIELD: f64 = 0.05;
/// Sine of the angle from the mesial or distal midline, below which the hand does not give way towards the midline.
const NEAR_MIDLINE: f64 = 0.1;
/// Largest share of the force along the probe that a hand takes for a wall's push on a shaft in a col.
const MOST_WALL: f64 = 0.25;

/// Push of a deep pocket's walls over the square of the wall's area (depth times the tooth's radius), N/m^4. A probe that leans
/// over a bulging crown is pushed the more against a root that flares. (Of 210 readings at depths of 7 mm: 0.10 +-0.04 N in
/// molars, 0.05 in premolars and 0.02 in incisors; the force on the way down, before the floor, said nothing about it.)
const WALLS: f64 = 1.1e8;
/// Depth from which the walls push, and further depth over which the push grows to its full value, metres. (Of 12 readings at 1
/// to 3 mm the floor's force was 0.01 N more than the force felt along the probe.)
const SHALLOW_WALL: f64 = 3.1e-3;
const WALL_GROWS: f64 = 0.5e-3;

impl Tour {
    /// Feels the wrench on the probe for one tick.
    pub(super) fn sense(&mut self, wrench: &Wrench, graphic: Option<&Pose>) {
        let load = self.load_on_floor(wrench, graphic);
        self.force += (load - self.force) * (self.dt / FEEL);
        let reads = self.returning && matches!(self.stroke, Stroke::Down | Stroke::Read(..));
        if reads && self.seen > 0.0 {
            // A light grip: pressed against tooth or wall the tip bears more than the hand feels.
            let up = self.up(graphic);
            let across = wrench.force - up * wrench.force.dot(&up);
            // Not over the col's midline: there the tip would be in a zone of the other side.
            let along = self
                .path()
                .tooth()
                .axis
                .cross(&self.path().outward(self.at));
            let into_col = along * (-self.at.signum() * libm::cos(self.at).signum());
            let is_near = libm::fabs(libm::sin(self.at)) < NEAR_MIDLINE;
            let held = if is_near {
                across.dot(&into_col).max(0.0)
            } else {
                0.0
            };
            self.yielded += (across - into_col * held) * (YIELD * self.dt);
            self.yielded *= MOST_ASIDE / self.yielded.norm().max(MOST_ASIDE);
        } else {
            self.yielded *= 1.0 - KEEP * self.dt;
        }
    }

    /// The floor's load once the tip stands on it, without the push of a deep pocket's walls, newtons.
    pub(super) fn floor_force(&self) -> f64 {
        let depth = self.seen.max(0.0);
        let wall = depth * self.path().radius(self.at, depth);
        let share = ((depth - SHALLOW_WALL) / WALL_GROWS).clamp(0.0, 1.0);
        self.force - share * WALLS * wall * wall
    }

    /// Unit vector up along the working end: as it is seen, else as it is meant.
    fn up(&self, graphic: Option<&Pose>) -> Vec3 {
        match graphic {
            Some(graphic) => -(graphic.orientation * self.tool.tip_axis),
            None => self.path().place(self.around, self.depth, self.tilt).up,
        }
    }

    /// Push of the floor along the tooth's axis, newtons.
    fn load_on_floor(&self, wrench: &Wrench, graphic: Option<&Pose>) -> f64 {
        let axis = self.path().tooth().axis;
        let up = self.up(graphic);
        // Across the shaft nothing but the shaft's own contacts is felt: along it the floor alone, by the cosine of the lean.
        let along = wrench.force.dot(&up) / up.dot(&axis).max(0.5);
        let Some(graphic) = graphic.filter(|_| self.seen > 0.0) else {
            return along;
        };
        let tip = graphic.transform(&self.tool.tip);
        let outward = self.path().outward(self.at);
        let moment = wrench.torque + (graphic.position - tip).cross(&wrench.force);
        let bent = moment.dot(&axis.cross(&outward));
        // Push of the shaft's contact down along the tooth's axis.
        let down = up.dot(&outward) * bent / LEVER;
        let sine = libm::sin(self.at);
        let side = sine * sine;
        let at_side = wrench.force.dot(&axis) + down;
        let in_col = along + down.min(0.0).max(-MOST_WALL * along.max(0.0));
        side * at_side + (1.0 - side) * in_col
    }
}
