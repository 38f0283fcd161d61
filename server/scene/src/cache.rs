//! Cache of built trees on disk. The key is a hash of mesh, options and builder version.
//!
//! The name of a file also contains a hash of the builder's sources, comments included (`build.rs`). After any change
//! of the sources, cached files are not found and trees are built again. The trees of [`crate::compile::family`] are
//! found by the key alone.

use std::path::{Path, PathBuf};

use sulcus_core::tree::MAX_LEVEL;
use sulcus_core::{Blending, Node, SphereTree, Vec3};

use crate::mesh::TriMesh;
use crate::tree::build::{BUILDER_VERSION, TreeBuildError, TreeOptions, build_tree};
use crate::tree::filled::check_filled;

/// Prefix of the file names of trees.
const TREE: &str = "tree";
const MAGIC: &[u8; 8] = b"SULCTRE\x02";
/// Bytes of a node: centre, contact radius, inset, first child, number of children, level.
const RECORD: usize = 5 * 8 + 4 + 2;
/// Bytes before the nodes: a blend length for each level.
const LENGTHS: usize = 8 * (MAX_LEVEL as usize + 1);

/// Returns the default folder of the cache: `$SULCUS_CACHE`, else `$XDG_CACHE_HOME/sulcus`, else
/// `$HOME/.cache/sulcus`.
pub fn default_cache_dir() -> Option<PathBuf> {
    let set = |name: &str| {
        std::env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    set("SULCUS_CACHE")
        .or_else(|| set("XDG_CACHE_HOME").map(|dir| dir.join("sulcus")))
        .or_else(|| set("HOME").map(|dir| dir.join(".cache").join("sulcus")))
}

/// Returns the key of the tree of a mesh and options. `weights` names the importance of its places; it is empty if
/// all count the same.
pub(crate) fn key(mesh: &TriMesh, options: &TreeOptions, weights: &str) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(MAGIC);
    hasher.update(&BUILDER_VERSION.to_le_bytes());
    hasher.update(&[options.levels]);
    hasher.update(&(options.samples as u64).to_le_bytes());
    hasher.update(&options.good_enough.to_bits().to_le_bytes());
    hasher.update(&[u8::from(options.volumetric), u8::from(options.blended)]);
    mesh.hash_into(&mut hasher);
    hasher.update(weights.as_bytes());
    hasher.finalize()
}

/// Returns the tree of `mesh` and `options` from the cache in `dir`; otherwise builds and caches it.
///
/// A failure to cache is ignored: the tree is built again next time.
///
/// # Errors
/// [`TreeBuildError`] if the tree cannot be built.
pub fn kept_or_built(
    mesh: &TriMesh,
    options: &TreeOptions,
    dir: Option<&Path>,
    progress: &dyn Fn(&str, f64),
) -> Result<SphereTree, TreeBuildError> {
    let key = key(mesh, options, "");
    let kept = dir.and_then(|dir| load(dir, &key));
    if let Some(tree) = kept.filter(|tree| check_filled(tree, mesh, options, false).is_ok()) {
        return Ok(tree);
    }
    let tree = build_tree(mesh, options, progress)?;
    if let Some(dir) = dir {
        let _ = store(dir, &key, &tree);
    }
    Ok(tree)
}

/// Marks a cached file as used. [`prune`] deletes the files that were not used for the longest time.
pub(crate) fn used(dir: &Path, what: &str, key: &blake3::Hash) -> std::io::Result<()> {
    let file = std::fs::File::options()
        .append(true)
        .open(path(dir, what, key))?;
    file.set_modified(std::time::SystemTime::now())
}

/// Deletes all files of a kind except the `most` that were used last.
pub(crate) fn prune(dir: &Path, what: &str, most: usize) -> std::io::Result<()> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(dir)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let ours = name
            .strip_prefix(what)
            .is_some_and(|rest| rest.starts_with('-'));
        if ours && name.ends_with(".bin") {
            files.push((entry.metadata()?.modified()?, entry.path()));
        }
    }
    files.sort();
    let surplus = files.len().saturating_sub(most);
    files[..surplus]
        .iter()
        .try_for_each(|(_, file)| std::fs::remove_file(file))
}

/// Hash of the sources of all builders. A program with other sources finds none of these files.
const SOURCES: &str = env!("SULCUS_BUILDER_SOURCE");

fn path(dir: &Path, what: &str, key: &blake3::Hash) -> PathBuf {
    let mut hasher = blake3::Hasher::new();
    hasher.update(key.as_bytes());
    hasher.update(SOURCES.as_bytes());
    let name = hasher.finalize().to_hex();
    dir.join(format!("{what}-{}.bin", &name[..32]))
}

/// Returns the key in a file of the cache; `None` if it is no such file.
pub(crate) fn key_of(file: &[u8]) -> Option<&[u8]> {
    file.strip_prefix(MAGIC)?.get(..32)
}

/// Returns the content cached under a key; `None` if it is absent or damaged.
pub(crate) fn load_bytes(dir: &Path, what: &str, key: &blake3::Hash) -> Option<Vec<u8>> {
    let bytes = std::fs::read(path(dir, what, key)).ok()?;
    content(&bytes, key).map(<[u8]>::to_vec)
}

/// Returns the content of a file's bytes; `None` if the file is damaged or has another key.
pub(crate) fn content<'a>(file: &'a [u8], key: &blake3::Hash) -> Option<&'a [u8]> {
    let body = file.strip_prefix(MAGIC)?.strip_prefix(key.as_bytes())?;
    let (sum, content) = body.split_at_checked(32)?;
    (blake3::hash(content).as_bytes() == sum).then_some(content)
}

/// Caches bytes under a key. Readers see the old file or the whole new one.
pub(crate) fn store_bytes(
    dir: &Path,
    what: &str,
    key: &blake3::Hash,
    content: &[u8],
) -> std::io::Result<()> {
    let mut bytes = Vec::with_capacity(content.len() + 72);
    bytes.extend(MAGIC);
    bytes.extend(key.as_bytes());
    bytes.extend(blake3::hash(content).as_bytes());
    bytes.extend(content);
    std::fs::create_dir_all(dir)?;
    let target = path(dir, what, key);
    // The name is unique for each writer, so two builds at once do not mix.
    static WRITES: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let write = WRITES.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let partial = target.with_extension(format!("{}-{write}.partial", std::process::id()));
    let written = std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, &target));
    if written.is_err() {
        let _ = std::fs::remove_file(&partial);
    }
    written
}

/// Returns the cached tree; `None` if it is absent or damaged.
pub(crate) fn load(dir: &Path, key: &blake3::Hash) -> Option<SphereTree> {
    decode(&load_bytes(dir, TREE, key)?)
}

/// Returns the tree in the content of a file.
pub(crate) fn decode(content: &[u8]) -> Option<SphereTree> {
    let (lengths, nodes) = content.split_at_checked(LENGTHS)?;
    if nodes.len() % RECORD != 0 {
        return None;
    }
    let records: Vec<(Node, f64)> = nodes
        .chunks_exact(RECORD)
        .map(node)
        .collect::<Option<_>>()?;
    let (nodes, insets): (Vec<Node>, Vec<f64>) = records.into_iter().unzip();
    let tree = SphereTree::with_bounds(nodes).ok()?;
    let lengths: Vec<f64> = lengths
        .chunks_exact(8)
        .take(usize::from(tree.depth()) + 1)
        .map(|word| Some(f64::from_bits(u64::from_le_bytes(word.try_into().ok()?))))
        .collect::<Option<_>>()?;
    if lengths.iter().all(|length| *length == 0.0) {
        return Some(tree);
    }
    tree.with_blending(Blending { lengths, insets }).ok()
}

/// Caches a tree.
pub(crate) fn store(dir: &Path, key: &blake3::Hash, tree: &SphereTree) -> std::io::Result<()> {
    let blending = tree.blending();
    let mut nodes = Vec::with_capacity(LENGTHS + tree.nodes().len() * RECORD);
    for level in 0..=MAX_LEVEL {
        let length = blending.lengths.get(usize::from(level)).unwrap_or(&0.0);
        nodes.extend(length.to_bits().to_le_bytes());
    }
    for (k, node) in tree.nodes().iter().enumerate() {
        for x in [
            node.centre.x,
            node.centre.y,
            node.centre.z,
            node.contact_radius,
            blending.insets.get(k).copied().unwrap_or(0.0),
        ] {
            nodes.extend(x.to_bits().to_le_bytes());
        }
        nodes.extend(node.first_child.to_le_bytes());
        nodes.extend([node.children, node.level]);
    }
    store_bytes(dir, TREE, key, &nodes)
}

/// Returns a node with its inset.
fn node(record: &[u8]) -> Option<(Node, f64)> {
    let real = |at: usize| {
        Some(f64::from_bits(u64::from_le_bytes(
            record.get(at..at + 8)?.try_into().ok()?,
        )))
    };
    let node = Node {
        centre: Vec3::new(real(0)?, real(8)?, real(16)?),
        contact_radius: real(24)?,
        bound_radius: real(24)?,
        first_child: u32::from_le_bytes(record.get(40..44)?.try_into().ok()?),
        children: *record.get(44)?,
        level: *record.get(45)?,
    };
    Some((node, real(32)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::icosphere;

    #[test]
    fn a_kept_tree_comes_back_and_a_damaged_one_does_not() {
        let dir = tempfile::tempdir().expect("temporary directory");
        let mesh = icosphere(0.005, 3);
        let options = TreeOptions {
            levels: 2,
            samples: 2000,
            blended: true,
            ..TreeOptions::default()
        };
        let tree = build_tree(&mesh, &options, &|_, _| ()).expect("tree");
        let name = key(&mesh, &options, "");
        assert_eq!(load(dir.path(), &name), None);
        store(dir.path(), &name, &tree).expect("stored");
        assert_eq!(load(dir.path(), &name), Some(tree.clone()));
        assert_eq!(
            std::fs::read_dir(dir.path()).expect("dir").count(),
            1,
            "no partial file is left"
        );

        let file = path(dir.path(), TREE, &name);
        let good = std::fs::read(&file).expect("bytes");
        for at in (0..good.len()).step_by(97) {
            let mut bad = good.clone();
            bad[at] ^= 4;
            std::fs::write(&file, &bad).expect("written");
            assert_eq!(load(dir.path(), &name), None, "byte {at}");
            std::fs::write(&file, &good[..at]).expect("written");
            assert_eq!(load(dir.path(), &name), None, "cut at {at}");
        }
        // A file of another mesh under this name is ignored.
        let other = key(
            &mesh,
            &TreeOptions {
                volumetric: true,
                ..options
            },
            "",
        );
        std::fs::write(path(dir.path(), TREE, &other), &good).expect("written");
        assert_eq!(load(dir.path(), &other), None);
    }

    #[test]
    fn files_that_were_used_last_stay() {
        let dir = tempfile::tempdir().expect("temporary directory");
        let key = |k: u8| blake3::hash(&[k]);
        let there = |k: u8| load_bytes(dir.path(), "x", &key(k)).is_some();
        let at = |k: u8, seconds| {
            let file = std::fs::File::options()
                .append(true)
                .open(path(dir.path(), "x", &key(k)));
            let time = std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(seconds);
            file.and_then(|file| file.set_modified(time))
                .expect("a time");
        };
        for k in 0..6 {
            store_bytes(dir.path(), "x", &key(k), &[k]).expect("stored");
            at(k, 1000 + u64::from(k));
        }
        // Another kind, and a name with the same beginning.
        store_bytes(dir.path(), "y", &key(0), b"y").expect("stored");
        store_bytes(dir.path(), "xx", &key(0), b"xx").expect("stored");
        used(dir.path(), "x", &key(0)).expect("noted");
        prune(dir.path(), "x", 3).expect("pruned");
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(there),
            [true, false, false, false, true, true]
        );
        assert_eq!(std::fs::read_dir(dir.path()).expect("files").count(), 5);
    }
}
