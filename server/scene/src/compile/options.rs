//! Options and result of a compilation.

use std::path::PathBuf;

use sulcus_core::Scene;

/// Options of a compilation besides the scene file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// Folder of the cache; `None` caches nothing.
    pub cache: Option<PathBuf>,
    /// Ignores the trees of the program ([`crate::compile::family`]) and cached scenes.
    pub anew: bool,
    /// Also puts the trees of the program that the scene has into the cache.
    pub copies: bool,
    /// Deepest level of all trees, for quick attempts and tests. Contact levels follow.
    pub deepest: Option<u8>,
    /// Seed of a generated patient, instead of the scene file's.
    pub seed: Option<u64>,
}

impl BuildOptions {
    /// Returns options with the cache in its default folder.
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
    /// Warnings of values that are usable but probably unintended, a sentence each.
    pub warnings: Vec<String>,
    /// Hash of scene file and meshes, hexadecimal; also in the scene.
    pub source_hash: String,
    /// Text of the patient file, written or generated; `None` if the scene has no patient.
    pub patient: Option<String>,
    /// Seed of a generated patient; `None` if the patient is written or absent.
    pub seed: Option<u64>,
}
