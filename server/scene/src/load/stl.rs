//! STL: a list of triangles, each with its own three corners.

use std::io::Cursor;

use sulcus_core::Vec3;

use super::{Malformed, brief};
use crate::mesh::TriMesh;
use crate::repair::join_equal;

/// Bytes before the first triangle of a binary file.
const HEADER: usize = 84;
/// Bytes of a triangle.
const RECORD: usize = 50;
/// What a file should be.
const EXPECTED: &str = "a complete binary or ASCII STL file";

/// Length of a binary file according to its own count of triangles.
fn announced(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    Some(HEADER as u64 + RECORD as u64 * u64::from(u32::from_le_bytes(count)))
}

/// Whether the length fits the count of triangles: then it is binary, though many exporters begin
/// binary files with "solid" too.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    announced(bytes) == Some(bytes.len() as u64)
}

/// Whether it begins as ASCII files do.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 10)];
    let start = start.trim_ascii_start().to_ascii_lowercase();
    let has = |word: &[u8]| start.windows(word.len()).any(|window| window == word);
    start.starts_with(b"solid") && !start.contains(&0) && (has(b"facet") || has(b"endsolid"))
}

/// Reads STL; lengths stay in the file's unit.
pub(super) fn parse(mut bytes: Vec<u8>) -> Result<TriMesh, Malformed> {
    if is_binary(&bytes) {
        // The reader tells the two kinds apart by this word alone.
        bytes[..5].copy_from_slice(b"-----");
    } else if bytes.trim_ascii_start().len() >= 5
        && bytes.trim_ascii_start()[..5].eq_ignore_ascii_case(b"solid")
    {
        bytes = one_solid(&bytes)?;
    } else {
        return Err(match announced(&bytes) {
            Some(length) => Malformed::new(
                format!("{} bytes where the header announces {length}", bytes.len()),
                EXPECTED,
            ),
            None => Malformed::new(format!("{} bytes", bytes.len()), EXPECTED),
        });
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes))
        .map_err(|error| Malformed::new(brief(&error.to_string()), EXPECTED))?;
    let mut mesh = TriMesh {
        vertices: mesh
            .vertices
            .iter()
            .map(|v| Vec3::from(v.0.map(f64::from)))
            .collect(),
        triangles: mesh
            .faces
            .iter()
            .map(|face| face.vertices.map(|v| v as u32))
            .collect(),
    };
    // The reader joins equal bits; 0.0 and -0.0 are one place too.
    join_equal(&mut mesh);
    Ok(mesh)
}

/// An ASCII file as one solid, in the spelling that the reader knows: it would stop after the first
/// of several solids, and wants small letters and a name.
fn one_solid(bytes: &[u8]) -> Result<Vec<u8>, Malformed> {
    let text = String::from_utf8_lossy(bytes).to_ascii_lowercase();
    let mut joined = String::with_capacity(text.len() + 32);
    joined.push_str("solid -\n");
    let (mut begun, mut ended) = (0_usize, 0_usize);
    for line in text.split(['\n', '\r']).map(str::trim) {
        match line.split_whitespace().next() {
            Some("solid") => begun += 1,
            Some("endsolid") => ended += 1,
            Some(_) if begun == ended => {
                return Err(Malformed::new(
                    format!("`{}` after the end of a solid", brief(line)),
                    EXPECTED,
                ));
            }
            Some(_) => {
                joined.push_str(line);
                joined.push('\n');
            }
            None => {}
        }
        if begun != ended && begun != ended + 1 {
            return Err(Malformed::new("a solid within a solid", EXPECTED));
        }
    }
    if begun != ended {
        return Err(Malformed::new(
            "an ASCII file that ends before `endsolid`",
            EXPECTED,
        ));
    }
    joined.push_str("endsolid\n");
    Ok(joined.into_bytes())
}

/// A mesh as binary STL bytes in millimetres (for export and tests).
pub fn to_stl(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in 0..mesh.triangles.len() {
        let area = mesh.area_vector(triangle);
        let length = area.norm();
        let normal = if length > 0.0 {
            area / length
        } else {
            Vec3::zeros()
        };
        for v in std::iter::once(normal).chain(mesh.corners(triangle).map(|corner| corner * 1e3)) {
            bytes.extend(v.iter().flat_map(|x| (*x as f32).to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    bytes
}
