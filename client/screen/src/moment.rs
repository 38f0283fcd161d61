//! An instant of a session: everything that moves in a picture.

use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3};
use sulcus_proto::TOOLS;
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{DisplayFrame, DisplayScene, FrameTool, Moved, Spot};

use crate::stage::MM;

/// Tool at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolAt {
    /// Whether a hand holds the tool.
    pub held: bool,
    /// Device point of the graphic tool, world axes, mm.
    pub position: Vector3<f32>,
    /// Orientation, `world_from_tool`.
    pub orientation: UnitQuaternion<f32>,
}

impl ToolAt {
    /// Tool at a pose of the wire.
    pub fn new(held: bool, pose: &WirePose) -> Self {
        let [w, i, j, k] = pose.orientation;
        let orientation = UnitQuaternion::try_new(Quaternion::new(w, i, j, k), 1e-6);
        Self {
            held,
            position: Vector3::from(pose.position) * MM,
            orientation: orientation.unwrap_or_default(),
        }
    }

    /// World from tool, mm.
    pub fn matrix(&self) -> Matrix4<f32> {
        Translation3::from(self.position).to_homogeneous() * self.orientation.to_homogeneous()
    }

    fn between(&self, later: &Self, share: f32) -> Self {
        Self {
            held: later.held,
            position: self.position.lerp(&later.position, share),
            // Half a turn has no shortest way; the later pose serves.
            orientation: self
                .orientation
                .try_slerp(&later.orientation, share, 1e-6)
                .unwrap_or(later.orientation),
        }
    }
}

/// Everything that moves, at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time in the session, seconds.
    pub time_s: f64,
    /// Tools by slot.
    pub tools: [ToolAt; TOOLS],
    /// Objects away from rest.
    pub moved: Vec<Moved>,
    /// Bleeding: the spot, and the time since its begin, seconds.
    pub spots: Vec<(Spot, f32)>,
}

impl Moment {
    /// Mouth at rest, with all tools at their places before the first entry, in no hand.
    pub fn rest(scene: &DisplayScene) -> Self {
        let mut tools = [ToolAt::new(false, &WirePose::IDENTITY); TOOLS];
        for (slot, tool) in tools.iter_mut().zip(&scene.tools) {
            *slot = ToolAt::new(false, &tool.park);
        }
        Self {
            time_s: 0.0,
            tools,
            moved: Vec::new(),
            spots: Vec::new(),
        }
    }

    /// Instant of a frame of this scene.
    pub fn of(scene: &DisplayScene, frame: &DisplayFrame) -> Self {
        let tick_s = scene.tick_ns as f64 / 1e9;
        let age = |spot: &Spot| (frame.tick.saturating_sub(spot.since) as f64 * tick_s) as f32;
        Self {
            time_s: frame.tick as f64 * tick_s,
            tools: frame
                .tools
                .map(|FrameTool { held, graphic }| ToolAt::new(held, &graphic)),
            moved: frame.moved.clone(),
            spots: frame.spots.iter().map(|spot| (*spot, age(spot))).collect(),
        }
    }

    /// Instant between this one and a later one. `share` 0 is this one, 1 the later one. Tools are interpolated; tissue
    /// and bleeding are those of the later instant.
    pub fn between(&self, later: &Self, share: f32) -> Self {
        let share = share.clamp(0.0, 1.0);
        let mut between = later.clone();
        between.time_s = self.time_s + (later.time_s - self.time_s) * f64::from(share);
        for (tool, (a, b)) in between
            .tools
            .iter_mut()
            .zip(self.tools.iter().zip(&later.tools))
        {
            *tool = a.between(b, share);
        }
        between
    }
}
