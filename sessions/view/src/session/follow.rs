//! The frame in which the pocket is seen close up: it follows the probe's tip, from the side of the tooth that the tip is
//! on, smoothly, so that the strokes of the probe are seen and not those of the eye.

use crate::Standing;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Scene, TickOutput, Vec3};

/// How soon it is where the tip is, seconds.
const SOON_S: f64 = 0.35;
/// How soon it looks from the side that the tip is on, seconds.
const TURN_S: f64 = 0.6;
/// How much of the way along the row of teeth is looked from, at a proximal site: straight along it a neighbour stands.
const ALONG: f64 = 0.45;

/// The frame: origin at the tip, x towards the eye (horizontal), z up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follow {
    at: Option<Vec3>,
    /// Direction of x about z, radians.
    bearing: f64,
    wanted: f64,
}

impl Follow {
    /// Looks outward from the middle of the scene at first.
    pub fn new(bearing: f64) -> Self {
        Self {
            at: None,
            bearing,
            wanted: bearing,
        }
    }

    /// Takes in where the tip is, `step_s` after the last time.
    pub fn step(&mut self, scene: &Scene, output: &TickOutput, probe: usize, step_s: f64) {
        let (tool, out) = (&scene.tools[probe], &output.tools[probe]);
        let tip = out.graphic.transform(&tool.tip);
        if let Some(reading) = &out.pocket
            && let Some(object) = scene.objects.get(usize::from(reading.object))
            && let TissueModel::Gingiva(gingiva) = &object.tissue
        {
            let (sin, cos) = (libm::sin(reading.around), libm::cos(reading.around));
            let side = if sin < 0.0 { -1.0 } else { 1.0 };
            let towards = gingiva.tooth.buccal * side + gingiva.tooth.mesial * (ALONG * cos);
            self.wanted = libm::atan2(towards.y, towards.x);
        }
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

    /// Where it is.
    pub fn standing(&self) -> Standing {
        let at = self.at.unwrap_or_else(Vec3::zeros) * 1e3;
        let half = self.bearing / 2.0;
        Standing {
            at: [at.x, at.y, at.z].map(|x| x as f32),
            turned: [0.0, 0.0, libm::sin(half) as f32, libm::cos(half) as f32],
        }
    }
}
