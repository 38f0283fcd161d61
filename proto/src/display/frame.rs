//! The moving part of a display, one instant at a time.

use serde::{Deserialize, Serialize};

use super::scene::{DisplayScene, within};
use super::{FRAME_BYTES, SITES, finite, rule};
use crate::TOOLS;
use crate::codec::{self, CodecError};
use crate::datagram::WirePose;

/// Step of a handle's displacement, metres: 2^-19 m, about 1.9 um. Rounding is off by at most half a step along each
/// axis. The largest displacement is 62 mm.
pub const STEP_M: f32 = 1.0 / 524_288.0;

/// Tool in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameTool {
    /// Whether a hand holds the tool.
    pub held: bool,
    /// Graphic pose, `world_from_tool`. The graphic tool never penetrates an object.
    pub graphic: WirePose,
}

/// Displacement of one handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MovedHandle {
    /// Number of the handle in the object's skin.
    pub handle: u16,
    /// Displacement from rest, world axes, in steps of [`STEP_M`]; never all zero.
    pub by: [i16; 3],
}

impl MovedHandle {
    /// Displacement from rest, world axes, metres.
    pub fn by_m(&self) -> [f32; 3] {
        self.by.map(|steps| f32::from(steps) * STEP_M)
    }
}

/// Object that is not at rest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Moved {
    /// Number of the object in the scene.
    pub object: u16,
    /// Handles away from rest, in ascending order. All others are at rest.
    pub handles: Vec<MovedHandle>,
}

/// Bleeding that shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spot {
    /// Number of the gingiva in the scene's objects.
    pub object: u16,
    /// Number of the site, 0 to 5, in the order of `DisplayObject::sites`.
    pub site: u8,
    /// Tick in which the bleeding began to show.
    pub since: u64,
}

/// Moving shapes at an instant. A frame is complete in itself: an object that is not listed is at rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplayFrame {
    /// Number of the frame, counted from the start of the feed. A gap shows lost frames.
    pub sequence: u64,
    /// First bytes of the hash of the scene to which all numbers belong.
    pub scene: [u8; 8],
    /// Tick of this instant.
    pub tick: u64,
    /// Whether the session is paused.
    pub paused: bool,
    /// Tools by slot. The slot of a tool that the scene lacks is not held and at the identity.
    pub tools: [FrameTool; TOOLS],
    /// Objects away from rest, in ascending order.
    pub moved: Vec<Moved>,
    /// Bleeding that shows, in ascending order of object and site.
    pub spots: Vec<Spot>,
}

impl DisplayFrame {
    /// Encodes the frame. Equal frames have equal bytes.
    ///
    /// # Errors
    /// A field breaks a rule, or the frame is longer than [`FRAME_BYTES`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, CodecError> {
        self.check()?;
        let mut bytes = Vec::new();
        codec::encode_onto(self, &mut bytes)?;
        within(bytes.len(), FRAME_BYTES)?;
        Ok(bytes)
    }

    /// Decodes a frame.
    ///
    /// # Errors
    /// The bytes are no valid frame; the error names the violated rule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        within(bytes.len(), FRAME_BYTES)?;
        let frame: Self = codec::decode::<_, FRAME_BYTES>(bytes)?;
        frame.check()?;
        Ok(frame)
    }

    /// Whether all numbers of objects, handles and sites exist in `scene`. A screen draws no other frame.
    pub fn fits(&self, scene: &DisplayScene) -> bool {
        let moved = self.moved.iter().all(|moved| {
            let object = scene.objects.get(usize::from(moved.object));
            let skin = object.and_then(|object| object.skin.as_ref());
            // Handles ascend, so the last is the largest.
            let last = moved.handles.last().map(|last| usize::from(last.handle));
            skin.is_some_and(|skin| last.is_none_or(|last| last < skin.handles.len()))
        });
        moved
            && self.spots.iter().all(|spot| {
                let object = scene.objects.get(usize::from(spot.object));
                object.is_some_and(|object| usize::from(spot.site) < object.sites.len())
            })
    }

    fn check(&self) -> Result<(), CodecError> {
        for tool in &self.tools {
            let pose = &tool.graphic;
            finite(
                "a graphic pose",
                pose.position.iter().chain(&pose.orientation),
            )?;
        }
        rule(
            self.moved.is_sorted_by(|a, b| a.object < b.object),
            "the moved objects do not ascend",
        )?;
        for moved in &self.moved {
            rule(!moved.handles.is_empty(), "a moved object is at rest")?;
            rule(
                moved.handles.is_sorted_by(|a, b| a.handle < b.handle),
                "the handles do not ascend",
            )?;
            rule(
                moved.handles.iter().all(|one| one.by != [0; 3]),
                "a moved handle is at rest",
            )?;
        }
        rule(
            self.spots
                .is_sorted_by(|a, b| (a.object, a.site) < (b.object, b.site)),
            "the spots do not ascend",
        )?;
        rule(
            self.spots.iter().all(|spot| usize::from(spot.site) < SITES),
            "a spot is at no site",
        )
    }
}
