//! Compiled scenes on disk: a scene whose text names no other file is compiled once.

use std::path::Path;

use serde::{Deserialize, Serialize};
use sulcus_core::Scene;

use crate::cache;
use crate::compile::{BuildOptions, Compiled};

/// Prefix of the file names of compiled scenes.
const SCENE: &str = "scene";
/// Compiled scenes that are kept; a whole mouth takes 10 MB.
const MOST: usize = 32;
/// Hash of the sources that a compiled scene depends on.
const SOURCES: &str = env!("SULCUS_SCENE_SOURCE");

/// Everything of [`Compiled`] but the scene.
#[derive(Serialize, Deserialize)]
struct Beside {
    warnings: Vec<String>,
    patient: Option<String>,
    seed: Option<u64>,
}

/// Name of the scene that these options make from the text of a scene file.
pub(crate) fn key(text: &str, path: &Path, options: &BuildOptions) -> blake3::Hash {
    // The cache is a place, not an input.
    let BuildOptions {
        cache: _,
        anew,
        deepest,
        seed,
    } = options;
    let mut hasher = blake3::Hasher::new();
    // The path stands in warnings.
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

/// The compiled scene, if it is there and undamaged.
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
    // (A cache that cannot be written is as good for reading.)
    let _ = cache::used(dir, SCENE, key);
    Some(Compiled {
        source_hash: scene.source_hash.clone(),
        scene,
        warnings,
        patient,
        seed,
    })
}

/// Keeps a compiled scene, and deletes of too many those that were not used for the longest time.
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
