//! Hash of the sources that build trees and tissues. The hash is part of the file names of the cache.
//!
//! The hash is of the text: comments, layout and paths change it. Cached trees, tissues and scenes are then built
//! again. The trees in `family.bin` do not depend on it.

use std::error::Error;
use std::path::{Path, PathBuf};

/// Sources of sphere trees, blending, tissue models, finite elements, and their compilation from scene files.
const BUILDERS: [&str; 5] = [
    "src",
    "../fem/src",
    "../core/src/blend",
    "../core/src/tissue",
    "../core/src/tree",
];
/// Further files.
const FILES: [&str; 2] = ["../core/src/scene/skin.rs", "../core/src/tree.rs"];

/// Sources of compiled scenes: the same, and all other sources of the core, which has the defaults and checks of a
/// scene.
const SCENES: [&str; 3] = ["src", "../fem/src", "../core/src"];

fn main() -> Result<(), Box<dyn Error>> {
    let builders = hash_of(&BUILDERS, &FILES)?;
    println!("cargo::rustc-env=SULCUS_BUILDER_SOURCE={builders}");
    let scenes = hash_of(&SCENES, &[])?;
    println!("cargo::rustc-env=SULCUS_SCENE_SOURCE={scenes}");
    Ok(())
}

/// Returns the hash of all Rust files in these folders and of these files, hexadecimal.
fn hash_of(folders: &[&str], files: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
    for folder in folders {
        list(Path::new(folder), &mut files)?;
    }
    files.sort();
    let mut hasher = blake3::Hasher::new();
    for file in files {
        println!("cargo::rerun-if-changed={}", file.display());
        let text = std::fs::read(&file)?;
        for part in [file.to_string_lossy().as_bytes(), &text] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
    }
    Ok(hasher.finalize().to_hex()[..32].to_owned())
}

/// Adds all Rust files in a folder.
fn list(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs")
            && path.file_name().is_some_and(|name| name != "tests.rs")
        {
            files.push(path);
        }
    }
    Ok(())
}
