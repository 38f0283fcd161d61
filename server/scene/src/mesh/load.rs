//! Reading of mesh files: STL, OBJ and PLY, text and binary.
//!
//! The formats do not name their unit; the caller names it.
//!
//! The content decides the format, because extensions are often wrong. The extension is used only in the message
//! about unknown content.
//!
//! Any bytes are allowed. They never cause a panic, and memory is proportional to the size of the file, whatever its
//! header announces.
//!
//! The readers of the formats and this module depend on each other: the formats return this module's `Loaded` and
//! `Malformed`, and this module selects the format.
//!
//! This module neither repairs ([`crate::mesh::repair`]) nor checks ([`crate::mesh::check`]) a mesh.
//!
//! Faces with many corners are triangulated ([`crate::mesh::polygon`]). A face without a triangulation is refused.

mod lines;
mod obj;
mod ply;
mod stl;
mod unit;

use std::io::Read;
use std::path::{Path, PathBuf};

use sulcus_program::PathText;

use crate::mesh::TriMesh;

pub use obj::to_obj;
pub use stl::to_stl;
pub use unit::Unit;

/// Largest file that is read, bytes: about twenty million triangles of binary STL.
pub const LARGEST_FILE: u64 = 1 << 30;

/// Mark that some editors write before text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reason why a mesh file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be opened or read.
    #[error("{}: cannot read the file: {source}", file.shown())]
    Read {
        /// The file.
        file: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file is larger than [`LARGEST_FILE`].
    #[error("{}: found more than {LARGEST_FILE} bytes, expected a mesh of at most that size", file.shown())]
    TooLarge {
        /// The file.
        file: PathBuf,
    },
    /// The file is not a mesh in a known format.
    #[error("{}: found {found}, expected {expected}", file.shown())]
    Format {
        /// The file.
        file: PathBuf,
        /// Content found, and its place.
        found: String,
        /// Content expected.
        expected: &'static str,
    },
}

/// Content found in place of the expected content.
#[derive(Debug, PartialEq)]
struct Malformed {
    found: String,
    expected: &'static str,
}

impl Malformed {
    fn new(found: impl Into<String>, expected: &'static str) -> Self {
        Self {
            found: found.into(),
            expected,
        }
    }
}

/// The mesh of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The mesh, metres, in the file's own frame.
    pub mesh: TriMesh,
    /// Parts of the file that were not read, a sentence each, for the user.
    pub notes: Vec<String>,
}

impl From<TriMesh> for Loaded {
    fn from(mesh: TriMesh) -> Self {
        Self {
            mesh,
            notes: Vec::new(),
        }
    }
}

/// Reads an STL, OBJ or PLY file. The result is in metres, in the file's own frame. Polygons become triangles; groups
/// and objects become one mesh.
///
/// STL repeats every corner, so corners with equal coordinates become one vertex. Indices of OBJ and PLY stay.
///
/// # Errors
/// [`LoadError`] if the file cannot be read or is not a mesh file. Whether the mesh is a solid is not checked.
pub fn load_mesh(file: &Path, unit: Unit) -> Result<Loaded, LoadError> {
    let read = |source| LoadError::Read {
        file: file.to_owned(),
        source,
    };
    let mut bytes = Vec::new();
    std::fs::File::open(file)
        .map_err(read)?
        .take(LARGEST_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(read)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(LoadError::TooLarge {
            file: file.to_owned(),
        });
    }
    parse_mesh(bytes, file, unit)
}

/// Reads a mesh from bytes. Messages name it as `file`; its extension has the effect of [`load_mesh`].
///
/// # Errors
/// [`LoadError`] if the bytes are not a mesh.
pub fn parse_mesh(mut bytes: Vec<u8>, file: &Path, unit: Unit) -> Result<Loaded, LoadError> {
    if bytes.starts_with(BYTE_ORDER_MARK) && !stl::is_exactly_binary(&bytes) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    let parsed = match sniff(&bytes).or_else(|| named(file)) {
        Some(Format::Stl) => stl::parse(bytes),
        Some(Format::Obj) => obj::parse(&bytes).map(Loaded::from),
        Some(Format::Ply) => ply::parse(bytes),
        None => Err(Malformed::new(
            format!("{} bytes of another format", bytes.len()),
            "a mesh as STL, OBJ or PLY",
        )),
    };
    let mut loaded = parsed.map_err(|Malformed { found, expected }| LoadError::Format {
        file: file.to_owned(),
        found,
        expected,
    })?;
    for vertex in &mut loaded.mesh.vertices {
        *vertex *= unit.metres();
    }
    Ok(loaded)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Stl,
    Obj,
    Ply,
}

fn named(file: &Path) -> Option<Format> {
    let extension = file.extension()?.to_str()?;
    [
        ("stl", Format::Stl),
        ("obj", Format::Obj),
        ("ply", Format::Ply),
    ]
    .into_iter()
    .find(|(name, _)| extension.eq_ignore_ascii_case(name))
    .map(|(_, format)| format)
}

/// Returns the format of the content, if the content is unambiguous.
fn sniff(bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Some(Format::Ply);
    }
    if stl::is_exactly_binary(bytes) || stl::is_text(bytes) || stl::seems_binary(bytes) {
        return Some(Format::Stl);
    }
    // An OBJ file is text. Its first line that is neither a comment nor a name begins with a known word.
    let start = &bytes[..bytes.len().min(1 << 16)];
    if start.contains(&0) {
        return None;
    }
    start
        .split(|&byte| byte == b'\n' || byte == b'\r')
        .any(|line| {
            let mut words = line
                .split(|byte| byte.is_ascii_whitespace())
                .filter(|word| !word.is_empty());
            words.next() == Some(b"v")
                && words.clone().count() >= 3
                && words.take(3).all(|word| {
                    std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok())
                })
        })
        .then_some(Format::Obj)
}

/// Returns text of a file or a crate for a message: one short line.
fn brief(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = words.join(" ");
    match line.char_indices().nth(120) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_content_decides_and_the_extension_helps() {
        let cases: [(&[u8], &str, Option<Format>); 7] = [
            (b"ply\nformat ascii 1.0\n", "a.stl", Some(Format::Ply)),
            (
                b"# exported\no tooth\nv 0 0 1\n",
                "a.stl",
                Some(Format::Obj),
            ),
            (b"solid x\nfacet normal 0 0 1\n", "a.obj", Some(Format::Stl)),
            (b"solid x\nendsolid x\n", "a", Some(Format::Stl)),
            (b"vn 0 0 1\n", "a.OBJ", Some(Format::Obj)),
            (b"\0\0\0", "a.ply", Some(Format::Ply)),
            (b"hello", "a.txt", None),
        ];
        for (bytes, name, expected) in cases {
            let found = sniff(bytes).or_else(|| named(Path::new(name)));
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn messages_stay_on_one_line_and_short() {
        assert_eq!(brief("a\n\tb  c"), "a b c");
        assert_eq!(brief(&"ü".repeat(500)).chars().count(), 123);
    }
}
