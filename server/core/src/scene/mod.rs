//! The constant part of a simulation: trees, tissue models, parameters, display meshes.
//!
//! A compiled scene is bytes: built and hashed offline, validated once on load, carried by every
//! recording.

pub mod displayable;
pub mod params;
pub mod skin;
pub mod tool;

pub use tool::{Band, DisplayMesh, Tool};

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use crate::MAX_TOOLS;
use crate::math::{Vec3, fmax, fmin, norm};
use crate::scene::params::{ParamError, Params, within};
use crate::tissue::{TissueError, TissueModel};
use crate::tree::SphereTree;

/// Version of the compiled scene's byte layout.
pub const SCENE_VERSION: u16 = 7;
/// First bytes of a compiled scene.
const MAGIC: [u8; 8] = *b"SULCSCN\0";
/// Most rows of a problem where something yields, both tools' together: the matrix of compliances is dense.
/// All of them can bear load, and enter one by one: more would take more iterations than a tick has.
const MAX_TISSUE_ROWS: usize = 256;
/// Contacts that the list of a scene with blended surfaces can hold for each of `max_contacts`.
const CONTACTS_PER_ROW: usize = 4;
/// Largest compiled scene that is read, bytes.
const MAX_SCENE_BYTES: usize = 256 << 20;

/// Something that can be touched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Name, for people.
    pub name: String,
    /// FDI number of a tooth; 0 for anything else.
    pub fdi: u8,
    /// Spheres, in **world** axes at rest, metres.
    pub tree: SphereTree,
    /// Level of the tree in contact unless the input says otherwise.
    pub level: u8,
    /// How it yields.
    pub tissue: TissueModel,
    /// To look at, world axes at rest.
    pub mesh: DisplayMesh,
    /// For each vertex of `mesh` the leaf of the tree that carries it when the tissue moves; empty where
    /// the mesh is not what the tree stands for.
    pub carriers: Vec<u32>,
}

/// Everything constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name, for people.
    pub name: String,
    /// Hash of what this was compiled from (scene file and meshes), hexadecimal.
    pub source_hash: String,
    /// Parameters of the tick.
    pub params: Params,
    /// One or two tools.
    pub tools: Vec<Tool>,
    /// What can be touched, in a fixed order.
    pub objects: Vec<Object>,
}

/// Why bytes are not a scene, or a scene is not usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The bytes do not begin as a compiled scene does.
    #[error("not a compiled scene: {0}")]
    Format(String),
    /// Another version of the layout.
    #[error("compiled scene has version {found}, expected {SCENE_VERSION}; build it again")]
    Version {
        /// Version found.
        found: u16,
    },
    /// The bytes were damaged.
    #[error("compiled scene is damaged: checksum is {found:016x}, expected {expected:016x}")]
    Checksum {
        /// Checksum of the bytes.
        found: u64,
        /// Checksum the file claims.
        expected: u64,
    },
    /// A parameter is out of range.
    #[error(transparent)]
    Params(#[from] ParamError),
    /// A tissue model cannot stand.
    #[error("{part}: {source}")]
    Tissue {
        /// Object.
        part: String,
        /// What is wrong.
        source: TissueError,
    },
    /// A field is wrong.
    #[error("{part}: {field} is {found}, expected {expected}")]
    Field {
        /// Tool or object.
        part: String,
        /// Field.
        field: &'static str,
        /// Value found.
        found: String,
        /// What it must be.
        expected: &'static str,
    },
}

impl Object {
    /// The highest point of its spheres in contact, and the box about those whose centres lie no more than `below` metres under it: of
    /// a tooth, what its crown takes up. (It does not depend on where spheres are crowded.) Metres, world axes at rest.
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
    /// Seconds that one tick of this scene simulates.
    #[inline]
    pub fn tick_s(&self) -> f64 {
        self.params.tick_s()
    }

    /// Blend length in force on object `k`, metres; 0 where its spheres are touched as they are. Blending is
    /// for what is rigid: tissue compliance acts on single spheres.
    #[inline]
    pub fn blend_of(&self, k: usize) -> f64 {
        let object = &self.objects[k];
        if self.params.blend && object.tissue.is_rigid() {
            object.tree.blend_at(object.level)
        } else {
            0.0
        }
    }

    /// Contacts that one tool's list can hold. A blended row has many.
    pub(crate) fn most_contacts(&self) -> usize {
        let rows = usize::from(self.params.max_contacts);
        let blended = (0..self.objects.len()).any(|k| self.blend_of(k) > 0.0);
        if blended {
            rows * CONTACTS_PER_ROW
        } else {
            rows
        }
    }

    /// Whether anything in it can yield.
    pub fn yields(&self) -> bool {
        self.objects.iter().any(|object| !object.tissue.is_rigid())
    }

    /// Rows that one problem can hold: as many as there can be contacts, but where something yields no more
    /// than its dense matrix has room for.
    pub(crate) fn most_rows(&self) -> usize {
        if self.yields() {
            usize::from(self.params.max_contacts).min(MAX_TISSUE_ROWS)
        } else {
            self.most_contacts() * self.tools.len()
        }
    }

    /// Compiled bytes: magic, version, checksum, bincode.
    ///
    /// # Errors
    /// Only when the scene is too large to encode.
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

    /// Reads compiled bytes and validates the scene.
    ///
    /// # Errors
    /// Says what is wrong; never panics, whatever the bytes.
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
        if version != SCENE_VERSION {
            return Err(SceneError::Version { found: version });
        }
        let expected = u64::from_le_bytes([
            head[10], head[11], head[12], head[13], head[14], head[15], head[16], head[17],
        ]);
        let found = xxh3_64(body);
        if found != expected {
            return Err(SceneError::Checksum { found, expected });
        }
        let config = bincode::config::standard().with_limit::<MAX_SCENE_BYTES>();
        let (scene, used): (Scene, usize) = bincode::serde::decode_from_slice(body, config)
            .map_err(|error| SceneError::Format(error.to_string()))?;
        if used != body.len() {
            return Err(SceneError::Format(format!(
                "{} trailing bytes",
                body.len() - used
            )));
        }
        scene.validate()?;
        Ok(scene)
    }

    /// Checks every part; a scene that passes cannot make a tick panic.
    ///
    /// # Errors
    /// Names the part, the field, the value found and the value expected.
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
            // The root encloses all: farther spheres would leave nothing of the motion per pass.
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
            if !within(tool.stiffness_n_per_m, 1.0, 1e5) {
                return field(
                    &part,
                    "stiffness_n_per_m",
                    tool.stiffness_n_per_m.to_string(),
                    "1 to 1e5 N/m",
                );
            }
            if !within(tool.stiffness_nm_per_rad, 1e-4, 1e3) {
                return field(
                    &part,
                    "stiffness_nm_per_rad",
                    tool.stiffness_nm_per_rad.to_string(),
                    "1e-4 to 1e3 N m/rad",
                );
            }
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
                // Spheres of another level would not yield.
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
