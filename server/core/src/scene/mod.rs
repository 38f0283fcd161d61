//! Constant part of a simulation: sphere trees, tissue models, parameters, display meshes.
//!
//! A compiled scene is a byte string: built and hashed offline, validated once on load, part of every recording.

pub mod coupling;
pub mod displayable;
mod former;
pub mod params;
pub mod skin;
pub mod tool;

pub use coupling::Coupling;
pub use tool::{Band, DisplayMesh, Tool};

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use crate::MAX_TOOLS;
use crate::math::{Vec3, fmax, fmin, norm};
use crate::scene::params::{ParamError, Params, within};
use crate::tissue::{TissueError, TissueModel};
use crate::tree::SphereTree;

/// Version of the compiled scene's byte layout.
pub const SCENE_VERSION: u16 = 8;
/// First bytes of a compiled scene.
const MAGIC: [u8; 8] = *b"SULCSCN\0";
/// Largest number of rows of a problem with a yielding object, for both tools together.
///
/// The compliance matrix is dense. All rows can bear load and enter the active set one at a time: more rows would take
/// more iterations than a tick allows.
const MAX_TISSUE_ROWS: usize = 256;
/// Capacity of the contact list of a scene with blended surfaces, per contact of `max_contacts`.
const CONTACTS_PER_ROW: usize = 4;
/// Largest compiled scene accepted, bytes.
const MAX_SCENE_BYTES: usize = 256 << 20;

/// Object of a scene that tools can touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Name for display.
    pub name: String,
    /// Two-digit FDI number of a tooth; 0 for other objects.
    pub fdi: u8,
    /// Sphere tree, in **world** axes at rest, metres.
    pub tree: SphereTree,
    /// Level of the tree in contact; 0 is the root.
    pub level: u8,
    /// Tissue model: rigid or yielding.
    pub tissue: TissueModel,
    /// Display mesh, world axes at rest, metres.
    pub mesh: DisplayMesh,
    /// Leaf of the tree that carries each vertex of `mesh` when the tissue moves. Empty where the mesh does not show
    /// the surface of the tree.
    pub carriers: Vec<u32>,
}

/// Constant data of a simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name for display.
    pub name: String,
    /// Hash of the sources (scene file and meshes), hexadecimal.
    pub source_hash: String,
    /// Parameters of the tick.
    pub params: Params,
    /// Tools, one or two.
    pub tools: Vec<Tool>,
    /// Objects that tools can touch, in a fixed order.
    pub objects: Vec<Object>,
}

/// Error of compiled bytes that are no scene, or of a scene that is not usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The bytes are no compiled scene: wrong first bytes, wrong length or not decodable. The text has the reason.
    #[error("not a compiled scene: {0}")]
    Format(String),
    /// The layout has another version.
    #[error("compiled scene has version {found}, expected {SCENE_VERSION}; build it again")]
    Version {
        /// Version found.
        found: u16,
    },
    /// The bytes are damaged.
    #[error("compiled scene is damaged: checksum is {found:016x}, expected {expected:016x}")]
    Checksum {
        /// Checksum of the bytes.
        found: u64,
        /// Checksum in the header.
        expected: u64,
    },
    /// A parameter is out of range.
    #[error(transparent)]
    Params(#[from] ParamError),
    /// A tissue model is invalid.
    #[error("{part}: {source}")]
    Tissue {
        /// Object, such as ``object `tongue` ``.
        part: String,
        /// Error of the tissue model.
        source: TissueError,
    },
    /// A field is invalid.
    #[error("{part}: {field} is {found}, expected {expected}")]
    Field {
        /// Part of the scene: `scene`, or the tool or object with its name.
        part: String,
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: String,
        /// Value expected.
        expected: &'static str,
    },
}

impl Object {
    /// Returns the height z of the highest point of the spheres in contact, and the corners (lowest, highest) of a box.
    /// The box encloses the spheres with centres less than `below` under that height. All lengths are in metres, world
    /// axes at rest.
    ///
    /// For a tooth, the box encloses the crown. The result does not depend on the density of the spheres.
    pub fn top(&self, below: f64) -> (f64, [Vec3; 2]) {
        let spheres = || {
            self.tree
                .shape_at(self.level)
                .map(|(_, node)| node.sphere())
        };
        let top = spheres().fold(f64::NEG_INFINITY, |top, s| fmax(top, s.centre.z + s.radius));
        let none = [f64::INFINITY, f64::NEG_INFINITY].map(Vec3::repeat);
        let crown = spheres().filter(|s| s.centre.z > top - below);
        let about = crown.fold(none, |[low, high], s| {
            [
                low.zip_map(&s.centre, |a, x| fmin(a, x - s.radius)),
                high.zip_map(&s.centre, |a, x| fmax(a, x + s.radius)),
            ]
        });
        (top, about)
    }
}

impl Scene {
    /// Duration that one tick of this scene simulates, seconds.
    #[inline]
    pub fn tick_s(&self) -> f64 {
        self.params.tick_s()
    }

    /// Returns the blend length used on object `k`, metres; 0 for an object touched sphere by sphere. Only rigid
    /// objects are blended: tissue compliance acts on single spheres.
    #[inline]
    pub fn blend_of(&self, k: usize) -> f64 {
        let object = &self.objects[k];
        if self.params.blend && object.tissue.is_rigid() {
            object.tree.blend_at(object.level)
        } else {
            0.0
        }
    }

    /// Returns the capacity of the contact list per tool, contacts. A blended row has many contacts, so a scene with
    /// blended objects has four times the capacity.
    pub(crate) fn most_contacts(&self) -> usize {
        let rows = usize::from(self.params.max_contacts);
        let blended = (0..self.objects.len()).any(|k| self.blend_of(k) > 0.0);
        if blended {
            rows * CONTACTS_PER_ROW
        } else {
            rows
        }
    }

    /// Whether the scene has a yielding object.
    pub fn yields(&self) -> bool {
        self.objects.iter().any(|object| !object.tissue.is_rigid())
    }

    /// Returns the largest number of rows of one problem. With a yielding object the dense compliance matrix limits the
    /// number; otherwise there can be as many rows as contacts.
    pub(crate) fn most_rows(&self) -> usize {
        if self.yields() {
            usize::from(self.params.max_contacts).min(MAX_TISSUE_ROWS)
        } else {
            self.most_contacts() * self.tools.len()
        }
    }

    /// Returns the compiled bytes: magic, version, checksum, bincode.
    ///
    /// # Errors
    /// The scene cannot be encoded.
    pub fn to_bytes(&self) -> Result<Vec<u8>, SceneError> {
        let body = bincode::serde::encode_to_vec(self, bincode::config::standard())
            .map_err(|error| SceneError::Format(error.to_string()))?;
        let mut bytes = Vec::with_capacity(body.len() + 18);
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&SCENE_VERSION.to_le_bytes());
        bytes.extend_from_slice(&xxh3_64(&body).to_le_bytes());
        bytes.extend_from_slice(&body);
        Ok(bytes)
    }

    /// Reads compiled bytes and validates the scene. Never panics. A scene of version 7 is read with the behaviour that
    /// it had.
    ///
    /// # Errors
    /// The bytes are no compiled scene of a version that is read, are damaged, or contain an invalid scene.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SceneError> {
        let Some((head, body)) = bytes.split_at_checked(18) else {
            return Err(SceneError::Format(format!(
                "only {} bytes long",
                bytes.len()
            )));
        };
        if head[..8] != MAGIC {
            return Err(SceneError::Format("it does not begin with SULCSCN".into()));
        }
        let version = u16::from_le_bytes([head[8], head[9]]);
        if version != SCENE_VERSION && version != former::VERSION {
            return Err(SceneError::Version { found: version });
        }
        let expected = u64::from_le_bytes([
            head[10], head[11], head[12], head[13], head[14], head[15], head[16], head[17],
        ]);
        let found = xxh3_64(body);
        if found != expected {
            return Err(SceneError::Checksum { found, expected });
        }
        let scene = match version {
            SCENE_VERSION => decoded::<Scene>(body)?,
            _ => decoded::<former::Scene>(body)?.into(),
        };
        scene.validate()?;
        Ok(scene)
    }

    /// Checks every part of the scene. A tick on a valid scene does not panic.
    ///
    /// # Errors
    /// A part is invalid. The error has the part, the field, the value found and the value expected.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.params.validate()?;
        let field = |part: &str, field, found: String, expected| {
            Err(SceneError::Field {
                part: part.to_owned(),
                field,
                found,
                expected,
            })
        };
        if self.tools.is_empty() || self.tools.len() > MAX_TOOLS {
            return field(
                "scene",
                "number of tools",
                self.tools.len().to_string(),
                "1 or 2",
            );
        }
        if self.objects.len() > usize::from(u16::MAX) {
            return field(
                "scene",
                "number of objects",
                self.objects.len().to_string(),
                "at most 65535",
            );
        }
        let trees = self.tools.iter().map(|tool| (&tool.name, &tool.tree));
        for (name, tree) in trees.chain(
            self.objects
                .iter()
                .map(|object| (&object.name, &object.tree)),
        ) {
            // The root encloses all spheres. With farther spheres the trust region would allow hardly any motion per
            // pass.
            let root = &tree.nodes()[0];
            let reach = norm(&root.centre) + root.bound_radius;
            if !within(reach, 0.0, 10.0) {
                return field(
                    &format!("`{name}`"),
                    "sphere tree",
                    format!("up to {reach} m from its origin"),
                    "within 10 m",
                );
            }
        }
        for tool in &self.tools {
            let part = format!("tool `{}`", tool.name);
            Coupling::of(tool).validate(&part)?;
            for (name, v) in [
                ("working_point", tool.working_point),
                ("tip", tool.tip),
                ("park", tool.park.position),
            ] {
                if !v.iter().all(|x| within(*x, -10.0, 10.0)) {
                    return field(&part, name, format!("{v:?}"), "within 10 m");
                }
            }
            if !within(tool.park.orientation.norm(), 1.0 - 1e-9, 1.0 + 1e-9) {
                return field(
                    &part,
                    "park orientation",
                    format!("{:?}", tool.park.orientation),
                    "a unit quaternion",
                );
            }
            if !within(tool.tip_axis.norm(), 1.0 - 1e-9, 1.0 + 1e-9) {
                return field(
                    &part,
                    "tip_axis",
                    format!("{:?}", tool.tip_axis),
                    "a unit vector",
                );
            }
            check_mesh(&part, &tool.mesh)?;
        }
        for object in &self.objects {
            if let Err(error) = object.tissue.validate(&object.tree, self.params.tick_s()) {
                return Err(SceneError::Tissue {
                    part: format!("object `{}`", object.name),
                    source: error,
                });
            }
            if let TissueModel::Gingiva(model) = &object.tissue
                && model.level != object.level
            {
                // Only spheres of the gingiva's level yield.
                return field(
                    &format!("object `{}`", object.name),
                    "level of the gingiva",
                    model.level.to_string(),
                    "the level in contact",
                );
            }
            if let TissueModel::PrintedGingiva(model) = &object.tissue
                && usize::from(model.tooth) >= self.objects.len()
            {
                return field(
                    &format!("object `{}`", object.name),
                    "tooth",
                    format!("object {}", model.tooth),
                    "an object of the scene",
                );
            }
            let (carriers, vertices) = (&object.carriers, object.mesh.vertices.len());
            let nodes = object.tree.nodes().len();
            let unknown = carriers.iter().find(|&&node| node as usize >= nodes);
            if unknown.is_some() || !(carriers.is_empty() || carriers.len() == vertices) {
                return field(
                    &format!("object `{}`", object.name),
                    "carriers",
                    match unknown {
                        Some(node) => format!("node {node} of {nodes}"),
                        None => format!("{} for {vertices} vertices", carriers.len()),
                    },
                    "a node of the tree for each vertex, or none at all",
                );
            }
            check_mesh(&format!("object `{}`", object.name), &object.mesh)?;
        }
        Ok(())
    }
}

/// Returns the value that takes up all of `body`.
fn decoded<T: serde::de::DeserializeOwned>(body: &[u8]) -> Result<T, SceneError> {
    let config = bincode::config::standard().with_limit::<MAX_SCENE_BYTES>();
    let (value, used): (T, usize) = bincode::serde::decode_from_slice(body, config)
        .map_err(|error| SceneError::Format(error.to_string()))?;
    if used != body.len() {
        return Err(SceneError::Format(format!(
            "{} trailing bytes",
            body.len() - used
        )));
    }
    Ok(value)
}

/// Checks the vertex indices of the triangles and the number of vertex colours. `part` is the tool or object for the
/// error.
fn check_mesh(part: &str, mesh: &DisplayMesh) -> Result<(), SceneError> {
    let n = mesh.vertices.len();
    let field = |field, found, expected| {
        Err(SceneError::Field {
            part: part.to_owned(),
            field,
            found,
            expected,
        })
    };
    if let Some(&v) = mesh.triangles.iter().flatten().find(|&&v| v as usize >= n) {
        let found = format!("vertex {v} of {n}");
        return field("mesh triangle", found, "an index of an existing vertex");
    }
    let coloured = mesh.vertex_colours.len();
    if coloured != 0 && coloured != n {
        let found = format!("{coloured} for {n} vertices");
        return field(
            "vertex colours of the mesh",
            found,
            "one for each vertex, or none",
        );
    }
    Ok(())
}
