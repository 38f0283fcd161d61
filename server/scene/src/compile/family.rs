//! Trees that are part of the program: those of the built-in scenes and of the pockets of the hard cases.
//!
//! Teeth take minutes to build and are the same for every patient.
//!
//! `sulcus-server scene family` makes the file. It holds the content of cached files: each tree under the hash of
//! mesh, options, importance and builder version.
//!
//! The hash does not depend on the text of the sources. A changed shape has another hash, is not found, and is built.
//! A test reports it.

use std::path::Path;

use sulcus_core::SphereTree;

use crate::cache;

static FAMILY: &[u8] = include_bytes!("../../../scenes/family.bin");

/// Returns the tree of a key, if it is in the family.
pub(crate) fn find(key: &blake3::Hash) -> Option<SphereTree> {
    let mut rest = FAMILY;
    while let Some((length, more)) = rest.split_at_checked(8) {
        let length = u64::from_le_bytes(length.try_into().ok()?);
        let (file, more) = more.split_at_checked(usize::try_from(length).ok()?)?;
        if let Some(content) = cache::content(file, key) {
            return cache::decode(content);
        }
        rest = more;
    }
    None
}

/// Returns the bytes of a family: all trees in a folder of the cache, in the order of their keys.
///
/// # Errors
/// An error if the folder or a file in it cannot be read.
pub fn pack(dir: &Path) -> std::io::Result<Vec<u8>> {
    let mut files: Vec<_> = std::fs::read_dir(dir)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()?;
    files.retain(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("tree-") && name.ends_with(".bin")
    });
    let mut trees: Vec<Vec<u8>> = files.iter().map(std::fs::read).collect::<Result<_, _>>()?;
    trees.sort_by(|a, b| cache::key_of(a).cmp(&cache::key_of(b)));
    let mut packed = Vec::new();
    for bytes in trees {
        packed.extend((bytes.len() as u64).to_le_bytes());
        packed.extend(bytes);
    }
    Ok(packed)
}
