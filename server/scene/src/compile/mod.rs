//! Compilation of a scene file to a [`Scene`].
//!
//! Meshes are loaded or made, checked, turned into sphere trees or taken from the cache, placed and validated.
//!
//! `parts` defines the `Compiler`; `mouth` and `sounded` add its methods for their kinds of part, which `parts` calls.

pub mod built_in;
mod compiled_cache;
mod error;
pub mod family;
mod mouth;
mod options;
pub(crate) mod parts;
pub mod printed;
mod sounded;
mod tooth_sizes;

use std::path::Path;

use sulcus_core::Scene;
use sulcus_program::PathText;

use crate::compile::parts::Compiler;
use crate::file;
use crate::file::{FileError, LOWER, SceneFile};
use crate::hand_written::read_text;

pub use error::BuildError;
pub use options::{BuildOptions, Compiled};

/// Compiles a scene file. `progress` receives the current step and the share that is done.
///
/// # Errors
/// [`BuildError`] with the file and its fault.
pub fn compile_file(
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    compile_text(&read_text(path)?, path, options, progress)
}

/// Compiles the text of a scene file. `path` is its name in errors, and its folder has the meshes.
///
/// # Errors
/// Errors of [`compile_file`].
pub fn compile_text(
    text: &str,
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    compile(&checked(text, path)?, text, path, options, progress)
}

/// Parses the text of a scene file and checks all its values, also against the parametric parts. Mesh files are not
/// opened.
///
/// # Errors
/// [`FileError`] with file, key, value found and value expected.
pub fn checked(text: &str, path: &Path) -> Result<SceneFile, FileError> {
    let scene = file::parse(text, path)?;
    tooth_sizes::tooth_sizes(&scene).map_err(|wrong| wrong.in_file(path))?;
    Ok(scene)
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
        // A scene that cannot be cached is compiled again next time. A failure to cache trees, in the same folder,
        // causes a warning.
        let _ = compiled_cache::store(dir, &key, &compiled);
    }
    Ok(compiled)
}

/// Compiles without the cache of compiled scenes. Also returns whether the scene may be cached.
fn compile_anew(
    source: &SceneFile,
    text: &str,
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<(Compiled, bool), BuildError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes());
    // All teeth count, also missing ones.
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
            "{}: [[object]] is missing, so no object can be touched",
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

/// Checks that every tool waits outside of every object. Its first motion would otherwise begin in penetration.
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
