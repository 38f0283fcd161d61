//! Hands that a loop reads once per period: simulated operator, mouse, and the merged hands of real devices.

use sulcus_core::math::normalised;
use sulcus_core::{MAX_TOOLS, Pose, RawPose, TickOutput, ToolInput, Vec3, Wrench};

/// Output of the simulation to a person in one period: forces on the hands and the picture on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Wrenches about the device points, world axes.
    pub wrenches: [Wrench; MAX_TOOLS],
    /// Graphic poses, `world_from_tool`; `None` before the first picture.
    pub graphics: [Option<Pose>; MAX_TOOLS],
}

impl Shown {
    /// Output before the first tick.
    pub const NOTHING: Self = Self {
        wrenches: [Wrench::ZERO; MAX_TOOLS],
        graphics: [None; MAX_TOOLS],
    };
}

impl From<&TickOutput> for Shown {
    fn from(output: &TickOutput) -> Self {
        Self {
            wrenches: std::array::from_fn(|t| output.tools[t].wrench),
            graphics: std::array::from_fn(|t| Some(output.tools[t].graphic)),
        }
    }
}

/// Source of up to two hands, in step with the loop that reads the hands. Poses are `world_from_tool` at the device
/// points. Wrenches are about these points, in world axes.
///
/// A haptic device with a clock of its own is a [`crate::device::Device`] instead.
pub trait HandSource: Send {
    /// Name, for the server's log and the recording.
    fn name(&self) -> &str;

    /// Takes the wrenches of one period, then returns the poses of the hands.
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS];

    /// Whether the person has finished. Most sources never know.
    fn is_done(&self) -> bool {
        false
    }
}

/// Returns the pose of `raw`. `None` for a number that is not finite, and for a quaternion length outside 0.5 to 2.
pub fn drawn(raw: &RawPose) -> Option<Pose> {
    let finite = |x: &f32| x.is_finite();
    let position = Vec3::from(raw.position.map(f64::from));
    let [w, x, y, z] = raw.orientation.map(f64::from);
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let valid = raw.position.iter().all(finite) && (0.5..2.0).contains(&length);
    valid.then(|| Pose::new(position, normalised(w, x, y, z)))
}
