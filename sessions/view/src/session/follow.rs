//! Frame of the close-up. The frame follows the probe's tip smoothly, seen from the tip's side of the tooth. So strokes
//! of the probe are visible rather than motions of the eye.

use crate::review::Standing;
use sulcus_core::Vec3;

/// Time constant of the frame's place, seconds.
const SOON_S: f64 = 0.35;
/// Time constant of the frame's direction, seconds.
const TURN_S: f64 = 0.6;
/// Share of the direction along the row of teeth in the view of a proximal site. A view straight along the row would be
/// blocked by a neighbour.
pub(crate) const ALONG: f64 = 0.45;

/// Frame with the origin at the tip, x towards the eye (horizontal), z up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Follow {
    at: Option<Vec3>,
    /// Direction of x about z, radians.
    bearing: f64,
    wanted: f64,
}

impl Follow {
    /// Frame that looks outward from the middle of the scene at first.
    pub fn new(bearing: f64) -> Self {
        Self {
            at: None,
            bearing,
            wanted: bearing,
        }
    }

    /// Follows the tip (metres), `step_s` after the last step. `towards`: direction from the tooth to the eye, radians
    /// about z; `None` leaves the direction.
    pub fn step(&mut self, tip: Vec3, towards: Option<f64>, step_s: f64) {
        self.wanted = towards.unwrap_or(self.wanted);
        let Some(at) = &mut self.at else {
            self.at = Some(tip);
            self.bearing = self.wanted;
            return;
        };
        let share = |soon: f64| step_s / (soon + step_s);
        *at += (tip - *at) * share(SOON_S);
        let turn = std::f64::consts::TAU;
        let mut left = (self.wanted - self.bearing) % turn;
        if left > turn / 2.0 {
            left -= turn;
        } else if left < -turn / 2.0 {
            left += turn;
        }
        self.bearing += left * share(TURN_S);
    }

    /// Place and orientation of the frame.
    pub fn standing(&self) -> Standing {
        let at = self.at.unwrap_or_else(Vec3::zeros) * 1e3;
        let half = self.bearing / 2.0;
        Standing {
            at: [at.x, at.y, at.z].map(|x| x as f32),
            turned: [0.0, 0.0, libm::sin(half) as f32, libm::cos(half) as f32],
        }
    }
}
