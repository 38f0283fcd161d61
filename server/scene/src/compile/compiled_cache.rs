//! Cache of compiled scenes on disk. It holds scenes whose text names no other file.

use std::path::Path;

use serde::{Deserialize, Serialize};
use sulcus_core::Scene;

use crate::cache;
use crate::compile::options::{BuildOptions, Compiled};

/// Prefix of the file names of compiled scenes.
const SCENE: &str = "scene";
/// Largest number of cached scenes; a whole mouth takes 10 MB.
const MOST: usize = 32;
/// Hash of the sources that a compiled scene depends on.
const SOURCES: &str = env!("SULCUS_SCENE_SOURCE");

/// All of [`Compiled`] except the scene.
#[derive(Serialize, Deserialize)]
struct Beside {
    warnings: Vec<String>,
    patient: Option<String>,
    seed: Option<u64>,
}

/// Returns the key of the scene of these options and this text of a scene file.
pub(crate) fn key(text: &str, path: &Path, options: &BuildOptions) -> blake3::Hash {
    // The cache is no input of the scene.
    let BuildOptions {
        cache: _,
        copies: _,
        anew,
        deepest,
        seed,
    } = options;
    let mut hasher = blake3::Hasher::new();
    // The path is part of warnings.
    let options = format!("{anew} {deepest:?} {seed:?}");
    for part in [
        SOURCES.as_bytes(),
        path.as_os_str().as_encoded_bytes(),
        options.as_bytes(),
        text.as_bytes(),
    ] {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize()
}

/// Returns the compiled scene; `None` if it is absent or damaged.
pub(crate) fn load(dir: &Path, key: &blake3::Hash) -> Option<Compiled> {
    let bytes = cache::load_bytes(dir, SCENE, key)?;
    let (length, rest) = bytes.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (beside, scene) = rest.split_at_checked(length)?;
    let Beside {
        warnings,
        patient,
        seed,
    } = serde_json::from_slice(beside).ok()?;
    let scene = Scene::from_bytes(scene).ok()?;
    // A cache that cannot be written can still be read.
    let _ = cache::used(dir, SCENE, key);
    Some(Compiled {
        source_hash: scene.source_hash.clone(),
        scene,
        warnings,
        patient,
        seed,
    })
}

/// Caches a compiled scene. Of more than [`MOST`], deletes those that were not used for the longest time.
pub(crate) fn store(dir: &Path, key: &blake3::Hash, compiled: &Compiled) -> std::io::Result<()> {
    let beside = serde_json::to_vec(&Beside {
        warnings: compiled.warnings.clone(),
        patient: compiled.patient.clone(),
        seed: compiled.seed,
    })?;
    let scene = compiled.scene.to_bytes().map_err(std::io::Error::other)?;
    let mut bytes = (beside.len() as u64).to_le_bytes().to_vec();
    bytes.extend(beside);
    bytes.extend(scene);
    cache::store_bytes(dir, SCENE, key, &bytes)?;
    cache::prune(dir, SCENE, MOST)
}
