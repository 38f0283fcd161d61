//! The constant part of a display: meshes at rest, skins, tools.

use serde::{Deserialize, Serialize};

use super::mesh::DisplayMesh;
use super::skin::Skin;
use super::{OBJECTS, SCENE_BYTES, SITES, finite, rule};
use crate::codec::{self, CodecError};
use crate::datagram::WirePose;
use crate::limits::NAME_BYTES;
use crate::{PROTOCOL_VERSION, TOOLS};

/// Largest coordinate, metres: the range of the simulation.
pub(super) const FAR_M: f32 = 10.0;
/// Largest number of bands of a probe.
const BANDS: usize = 64;

/// BLAKE3 hash of an encoded scene. Its first eight bytes name the scene in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SceneHash(pub [u8; 32]);

impl SceneHash {
    /// Hash of an encoded scene.
    pub fn of(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }

    /// First eight bytes, which name the scene in a frame.
    pub fn short(&self) -> [u8; 8] {
        let [a, b, c, d, e, f, g, h, ..] = self.0;
        [a, b, c, d, e, f, g, h]
    }
}

impl std::fmt::Display for SceneHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&crate::hex::hex(&self.0))
    }
}

/// Kind of an object, from which a screen chooses name and material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// A tooth.
    Tooth,
    /// Gingiva round a tooth.
    Gingiva,
    /// Mucosa on bone: jaw, floor of the mouth, healed ridge.
    Mucosa,
    /// A tongue.
    Tongue,
    /// Any other object.
    Other,
}

/// Object of the mouth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayObject {
    /// Kind.
    pub kind: Kind,
    /// Two-digit FDI number of a tooth or of a gingiva's tooth; 0 for other objects.
    pub fdi: u8,
    /// Mesh, world axes at rest.
    pub mesh: DisplayMesh,
    /// Skin of the mesh; `None` for an object that never moves.
    pub skin: Option<Skin>,
    /// Places of bleeding at the margin of a gingiva, world axes at rest, metres: mesiobuccal, buccal, distobuccal,
    /// distolingual, lingual, mesiolingual. Empty for other objects.
    pub sites: Vec<[f32; 3]>,
}

/// Band of a probe, measured from the tip along the probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayBand {
    /// Start, metres from the tip.
    pub from: f32,
    /// End, metres from the tip.
    pub to: f32,
    /// Whether the band is dark.
    pub dark: bool,
}

/// Reflecting face of a mouth mirror: a flat disc in the tool's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayGlass {
    /// Middle of the disc, metres.
    pub centre: [f32; 3],
    /// Unit normal, out of the reflecting side.
    pub normal: [f32; 3],
    /// Radius of the disc, metres.
    pub radius: f32,
}

/// Tool in a hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayTool {
    /// Name, at most 256 bytes.
    pub name: String,
    /// Mesh, in the tool's frame. Its origin is the device point.
    pub mesh: DisplayMesh,
    /// Bands of a probe; empty for other tools.
    pub bands: Vec<DisplayBand>,
    /// Glass of a mirror; `None` for other tools.
    pub glass: Option<DisplayGlass>,
    /// Outermost point of the tip, in the tool's frame, metres.
    pub tip: [f32; 3],
    /// Unit vector along the working end, pointing out of the tip, in the tool's frame.
    pub tip_axis: [f32; 3],
    /// Pose before the first entry, `world_from_tool`.
    pub park: WirePose,
}

/// Constant part of a display.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayScene {
    /// Duration of a tick, nanoseconds. Ticks of a frame are converted to time by this number.
    pub tick_ns: u64,
    /// Tools, in the order of the slots of a frame.
    pub tools: Vec<DisplayTool>,
    /// Objects, in the order of their numbers in frames.
    pub objects: Vec<DisplayObject>,
}

impl DisplayScene {
    /// Encodes the scene: one byte of protocol version, then the fields. Equal scenes have equal bytes.
    ///
    /// # Errors
    /// A field breaks a rule, or the scene is longer than [`SCENE_BYTES`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, CodecError> {
        self.check()?;
        let mut bytes = vec![PROTOCOL_VERSION];
        codec::encode_onto(self, &mut bytes)?;
        within(bytes.len(), SCENE_BYTES)?;
        Ok(bytes)
    }

    /// Decodes a scene.
    ///
    /// # Errors
    /// The bytes are no valid scene; the error names the violated rule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        within(bytes.len(), SCENE_BYTES)?;
        let (&version, body) = bytes.split_first().ok_or(CodecError::Length {
            found: 0,
            expected: 1,
        })?;
        if version != PROTOCOL_VERSION {
            return Err(CodecError::Version { found: version });
        }
        let scene: Self = codec::decode::<_, SCENE_BYTES>(body)?;
        scene.check()?;
        Ok(scene)
    }

    fn check(&self) -> Result<(), CodecError> {
        rule(
            (1..=TOOLS).contains(&self.tools.len()),
            "a scene has neither one tool nor two",
        )?;
        rule(
            self.objects.len() <= OBJECTS,
            "a scene has too many objects",
        )?;
        rule(self.tick_ns > 0, "a tick takes no time")?;
        for tool in &self.tools {
            rule(tool.name.len() <= NAME_BYTES, "a tool's name is too long")?;
            rule(tool.bands.len() <= BANDS, "a tool has too many bands")?;
            tool.mesh.check()?;
            let ends = tool.bands.iter().flat_map(|band| [band.from, band.to]);
            let places = tool.tip.iter().chain(&tool.tip_axis);
            let park = tool.park.position.iter().chain(&tool.park.orientation);
            let glass = tool.glass.iter();
            let glass = glass.flat_map(|g| g.centre.into_iter().chain(g.normal).chain([g.radius]));
            let numbers: Vec<f32> = places
                .chain(park)
                .copied()
                .chain(ends)
                .chain(glass)
                .collect();
            finite("a number of a tool", &numbers)?;
        }
        for object in &self.objects {
            object.mesh.check()?;
            if let Some(skin) = &object.skin {
                skin.check(object.mesh.len())?;
            }
            rule(
                object.sites.is_empty() || object.sites.len() == SITES,
                "an object has neither six sites nor none",
            )?;
            finite("a site", object.sites.iter().flatten())?;
        }
        Ok(())
    }
}

pub(super) fn within(found: usize, limit: usize) -> Result<(), CodecError> {
    if found > limit {
        return Err(CodecError::TooLong { found, limit });
    }
    Ok(())
}
