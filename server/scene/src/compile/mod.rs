//! From a scene file to a [`Scene`]: meshes loaded or made, checked, turned into sphere trees
//! (or taken from the cache), put in place, validated.

pub mod built_in;
mod compiled_cache;
pub mod family;
mod mouth;
pub(crate) mod parts;
pub mod printed;
mod sounded;

use std::path::{Path, PathBuf};

use sulcus_core::{Scene, SceneError};
use sulcus_program::PathText;

use crate::anatomy::patient::LOWER;
use crate::anatomy::sulcus::SulcusError;
use crate::compile::built_in::{BuiltIn, compile_built_in};
use crate::compile::parts::Compiler;
use crate::file;
use crate::file::{FileError, SceneFile};
use crate::mesh::check::MeshError;
use crate::mesh::load::LoadError;
use crate::mesh::solid::SolidError;
use crate::organ::OrganError;
use crate::organ::skeleton::SkeletonError;
use crate::organ::springs::SpringsError;
use crate::tree::build::TreeBuildError;

/// How to build, apart from what the scene file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// Directory of built trees; none keeps none.
    pub cache: Option<PathBuf>,
    /// Takes no tree from those that the program brings along ([`crate::compile::family`]).
    pub anew: bool,
    /// Builds no tree deeper than this (contact levels follow), for quick tries and tests.
    pub deepest: Option<u8>,
    /// Seed of a generated patient instead of the scene file's.
    pub seed: Option<u64>,
}

impl BuildOptions {
    /// Uses the cache at its usual place.
    pub fn cached() -> Self {
        Self {
            cache: crate::cache::default_cache_dir(),
            ..Self::default()
        }
    }
}

/// A scene ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Compiled {
    /// The scene.
    pub scene: Scene,
    /// What is usable but probably not meant, a sentence each.
    pub warnings: Vec<String>,
    /// Hash of scene file and meshes, hexadecimal; also in the scene.
    pub source_hash: String,
    /// Text of the patient file, written or generated; none where the scene has no patient.
    pub patient: Option<String>,
    /// Seed that the patient was generated from; none where it is written, or there is none.
    pub seed: Option<u64>,
}

/// Why there is no scene. One sentence each.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The scene file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A mesh file cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A mesh is not a solid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The base of a mesh cannot be closed.
    #[error("{0}")]
    Base(SolidError),
    /// A tree cannot be built.
    #[error("{part}: {source}")]
    Tree {
        /// Tool or object.
        part: String,
        /// Why.
        source: TreeBuildError,
    },
    /// A skeleton cannot be made.
    #[error("{part}: {source}")]
    Skeleton {
        /// The object.
        part: String,
        /// Why.
        source: SkeletonError,
    },
    /// A gingiva's mesh has no sulcus round its tooth.
    #[error("{part}: {source}")]
    Sulcus {
        /// The object.
        part: String,
        /// Why.
        source: SulcusError,
    },
    /// Fitted springs cannot be used.
    #[error("{part}: {source}")]
    Springs {
        /// The object.
        part: String,
        /// Why.
        source: SpringsError,
    },
    /// No parametric tooth has this number. The check of the scene file refuses such a number first.
    #[error("{part}: fdi is {fdi}, expected a lower tooth, 31 to 37 or 41 to 47")]
    NoSuchTooth {
        /// Object.
        part: String,
        /// FDI number found.
        fdi: u8,
    },
    /// A patient's gingiva cannot be laid out.
    #[error("patient: {0}")]
    Patient(String),
    /// Finite elements cannot be made or condensed.
    #[error("{part}: {source}")]
    Organ {
        /// The object.
        part: String,
        /// Why.
        source: OrganError,
    },
    /// The parts do not make a scene.
    #[error("{}: {source}", file.shown())]
    Scene {
        /// The scene file.
        file: PathBuf,
        /// Why.
        source: SceneError,
    },
    /// A tool waits inside something.
    #[error("{}: `park_mm` of tool `{tool}` is {depth_mm:.2} mm inside object `{object}`, expected a place outside everything", file.shown())]
    ParkedInside {
        /// The scene file.
        file: PathBuf,
        /// The tool.
        tool: String,
        /// What it is inside of.
        object: String,
        /// How deep, millimetres.
        depth_mm: f64,
    },
}

impl From<SolidError> for BuildError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Load(error) => Self::Load(error),
            SolidError::Mesh(error) => Self::Mesh(error),
            error @ SolidError::Base { .. } => Self::Base(error),
        }
    }
}

/// Compiles a scene file. `progress` gets what is being done and how much of the whole is done.
///
/// # Errors
/// One sentence that names the file and what is wrong in it.
pub fn compile_file(
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    let (scene, text) = file::read(path)?;
    compile(&scene, &text, path, options, progress)
}

/// Compiles the scene that is used when none is named: a lower molar and a probe.
///
/// # Errors
/// Only if the program was built from a broken source.
pub fn compile_default(
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    compile_built_in(BuiltIn::Crown, options, progress)
}

/// Compiles the text of a scene file; `path` is what errors call it, and where its meshes are looked for.
///
/// # Errors
/// As [`compile_file`].
pub fn compile_text(
    text: &str,
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    compile(&file::parse(text, path)?, text, path, options, progress)
}

fn compile(
    source: &SceneFile,
    text: &str,
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    let dir = options.cache.as_deref().filter(|_| !options.anew);
    let key = compiled_cache::key(text, path, options);
    if let Some(kept) = dir.and_then(|dir| compiled_cache::load(dir, &key)) {
        progress("done", 1.0);
        return Ok(kept);
    }
    let (compiled, cacheable) = compile_anew(source, text, path, options, progress)?;
    if let Some(dir) = dir.filter(|_| cacheable) {
        // A scene that cannot be kept is compiled again next time; trees, which go to the same folder, say so.
        let _ = compiled_cache::store(dir, &key, &compiled);
    }
    Ok(compiled)
}

/// Compiles without the cache of compiled scenes; also gives whether the scene may be cached.
fn compile_anew(
    source: &SceneFile,
    text: &str,
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<(Compiled, bool), BuildError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes());
    // (Teeth are counted as if all were there.)
    let teeth = if source.mouth.is_some() {
        LOWER.len()
    } else {
        0
    };
    let parts = source.tools.len() + source.objects.len() + teeth;
    let mut compiler = Compiler {
        path,
        options,
        progress,
        hasher,
        warnings: Vec::new(),
        cacheable: true,
        parts,
        done: 0,
    };
    let mut tools = Vec::new();
    for entry in &source.tools {
        tools.push(compiler.tool(entry)?);
    }
    let mut objects = Vec::new();
    for entry in &source.objects {
        objects.push(compiler.object(entry, &source.objects)?);
    }
    let (mut patient, mut seed) = (None, None);
    if let Some(entry) = &source.mouth {
        let asked = options.seed.unwrap_or(entry.seed);
        let made = compiler.mouth(entry, asked)?;
        objects.extend(made.objects);
        patient = Some(made.patient);
        seed = entry.patient.is_none().then_some(asked);
    }
    let source_hash = compiler.hasher.finalize().to_hex().to_string();
    let (cacheable, mut warnings) = (compiler.cacheable, compiler.warnings);
    if objects.is_empty() {
        warnings.push(format!(
            "{}: there is no [[object]], so there is nothing to touch",
            path.shown()
        ));
    }
    let scene = Scene {
        name: source.name.clone(),
        source_hash: source_hash.clone(),
        params: source.params.clone(),
        tools,
        objects,
    };
    scene.validate().map_err(|source| BuildError::Scene {
        file: path.to_owned(),
        source,
    })?;
    parked_outside(&scene, path)?;
    progress("done", 1.0);
    let compiled = Compiled {
        scene,
        warnings,
        source_hash,
        patient,
        seed,
    };
    Ok((compiled, cacheable))
}

/// Every tool must wait outside of everything, or its first way would begin in penetration.
fn parked_outside(scene: &Scene, path: &Path) -> Result<(), BuildError> {
    for tool in &scene.tools {
        let spheres: Vec<_> = tool
            .tree
            .shape_at(tool.level)
            .map(|(_, node)| (tool.park.transform(&node.centre), node.contact_radius))
            .collect();
        for object in &scene.objects {
            let mut depth = 0.0;
            for (_, node) in object.tree.shape_at(object.level) {
                for (centre, radius) in &spheres {
                    let gap = (centre - node.centre).norm() - radius - node.contact_radius;
                    depth = if -gap > depth { -gap } else { depth };
                }
            }
            if depth > 0.0 {
                return Err(BuildError::ParkedInside {
                    file: path.to_owned(),
                    tool: tool.name.clone(),
                    object: object.name.clone(),
                    depth_mm: depth * 1e3,
                });
            }
        }
    }
    Ok(())
}
