//! STL: a list of triangles, each with its own three corners.

use std::io::Cursor;

use sulcus_core::Vec3;

use super::lines::numbered;
use super::{Loaded, Malformed, brief};
use crate::mesh::TriMesh;
use crate::mesh::repair::join_equal;

/// Bytes before the first triangle of a binary file.
const HEADER: usize = 84;
/// Bytes of a triangle.
const RECORD: usize = 50;
/// The kinds of file that are read.
const EXPECTED: &str = "a complete binary or ASCII STL file";
/// Length of the beginning of a file that is searched for the words of ASCII STL, bytes.
const START: usize = 1 << 10;
/// Largest difference from 1 of the length of a stored normal in the data of a triangle.
const NEARLY_ONE: f32 = 1e-2;

/// Returns the number of triangles that a binary file announces.
fn announced(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(count)))
}

/// Returns the length of a binary file of this number of triangles, bytes.
fn length_of(triangles: u64) -> u64 {
    HEADER as u64 + RECORD as u64 * triangles
}

/// Returns whether the length fits the count of triangles exactly. Then the file is binary, even if it begins with
/// "solid", as many exporters write.
pub(super) fn is_exactly_binary(bytes: &[u8]) -> bool {
    announced(bytes).map(length_of) == Some(bytes.len() as u64)
}

/// Returns whether header and first triangle are those of a binary file, possibly with bytes behind its triangles.
pub(super) fn seems_binary(bytes: &[u8]) -> bool {
    let fits =
        announced(bytes).is_some_and(|count| count > 0 && length_of(count) <= bytes.len() as u64);
    fits && bytes[HEADER..]
        .first_chunk::<RECORD>()
        .is_some_and(is_triangle)
}

/// Returns whether it begins with the word of ASCII files, in any spelling.
fn begins_with_solid(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid")
}

/// Returns whether it begins like an ASCII file.
///
/// A count of triangles below 2^24 has a zero byte, so the header of a binary file does not look like text, whatever
/// its first word.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    // Zeros behind the last line are not part of the text.
    let text = bytes.len() - bytes.iter().rev().take_while(|&&byte| byte == 0).count();
    let start = &bytes[..text.min(START)];
    let lower = start.to_ascii_lowercase();
    let has = |word: &[u8]| lower.windows(word.len()).any(|window| window == word);
    begins_with_solid(start) && !start.contains(&0) && (has(b"facet") || has(b"endsolid"))
}

/// Reads STL in the file's unit.
pub(super) fn parse(bytes: Vec<u8>) -> Result<Loaded, Malformed> {
    let looks_like_text =
        begins_with_solid(&bytes) && !bytes[..bytes.len().min(START)].contains(&0);
    if !is_exactly_binary(&bytes) && (is_text(&bytes) || looks_like_text) {
        let (text, notes) = one_solid(&bytes)?;
        return Ok(Loaded {
            mesh: read(text)?,
            notes,
        });
    }
    let (bytes, notes) = whole(bytes)?;
    Ok(Loaded {
        mesh: read(bytes)?,
        notes,
    })
}

/// Returns the part of a binary file that its header describes, and a note about bytes behind it.
fn whole(mut bytes: Vec<u8>) -> Result<(Vec<u8>, Vec<String>), Malformed> {
    let length = bytes.len();
    let Some(triangles) = announced(&bytes) else {
        return Err(Malformed::new(format!("{length} bytes"), EXPECTED));
    };
    let end = length_of(triangles);
    if end > length as u64 {
        let held = (length - HEADER) / RECORD;
        return Err(Malformed::new(
            format!(
                "{length} bytes where the header announces {end} ({triangles} triangles, of which {held} are whole)"
            ),
            EXPECTED,
        ));
    }
    // The value is at most the length of the file, which is in memory.
    let end = end as usize;
    let behind = &bytes[end..];
    let mut notes = Vec::new();
    if !behind.is_empty() {
        let records = behind.len() / RECORD;
        if triangles == 0 {
            return Err(Malformed::new(
                format!(
                    "a header that announces 0 triangles before {} bytes of data ({records} triangles would fit)",
                    behind.len()
                ),
                "a header with the number of triangles",
            ));
        }
        if behind
            .as_chunks::<RECORD>()
            .0
            .first()
            .is_some_and(is_triangle)
        {
            return Err(Malformed::new(
                format!(
                    "a header that announces {triangles} triangles, and more triangles behind them ({} would fit into the file)",
                    triangles + records as u64
                ),
                "a header with the number of triangles",
            ));
        }
        notes.push(format!(
            "{} bytes behind the last of {triangles} triangles were not read{}",
            behind.len(),
            content(behind)
        ));
        bytes.truncate(end);
    }
    // The reader distinguishes the two kinds by this word alone.
    bytes[..5].copy_from_slice(b"-----");
    Ok((bytes, notes))
}

/// Returns whether 50 bytes are a plausible triangle with its normal.
fn is_triangle(record: &[u8; RECORD]) -> bool {
    let (words, _) = record.as_chunks::<4>();
    let numbers = words[..12].iter().map(|word| f32::from_le_bytes(*word));
    let numbers: Vec<f32> = numbers.collect();
    let length = numbers[..3].iter().map(|x| x * x).sum::<f32>().sqrt();
    let corners = [&numbers[3..6], &numbers[6..9], &numbers[9..12]];
    (length == 0.0 || (length - 1.0).abs() < NEARLY_ONE)
        && numbers
            .iter()
            .all(|x| x.is_finite() && (*x == 0.0 || x.abs() > 1e-20))
        && corners[0] != corners[1]
        && corners[1] != corners[2]
        && corners[2] != corners[0]
}

/// Returns the content of bytes that were not read, in brackets.
fn content(bytes: &[u8]) -> String {
    if bytes.iter().all(|&byte| byte == 0) {
        return " (zeros)".to_owned();
    }
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return " (white space)".to_owned();
    }
    match std::str::from_utf8(bytes) {
        Ok(text) if !text.contains('\0') => format!(" (`{}`)", brief(text)),
        _ => String::new(),
    }
}

fn read(bytes: Vec<u8>) -> Result<TriMesh, Malformed> {
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
    // The reader joins equal bits; 0.0 and -0.0 are also one place.
    join_equal(&mut mesh);
    Ok(mesh)
}

/// The lines of a triangle in an ASCII file: words, then a count of numbers.
const FACET: [(&[&str], usize, &str); 7] = [
    (
        &["facet", "normal"],
        3,
        "`facet normal` and three numbers, or `endsolid`",
    ),
    (&["outer", "loop"], 0, "`outer loop`"),
    (&["vertex"], 3, "`vertex` and three numbers"),
    (&["vertex"], 3, "`vertex` and three numbers"),
    (
        &["vertex"],
        3,
        "`vertex` and three numbers (a facet has three)",
    ),
    (&["endloop"], 0, "`endloop`"),
    (&["endfacet"], 0, "`endfacet`"),
];

/// Returns an ASCII file as one solid, checked line by line, in the spelling of the reader.
///
/// The reader would stop after the first of several solids. It expects small letters and a name, and does not name
/// the line of a fault.
fn one_solid(bytes: &[u8]) -> Result<(Vec<u8>, Vec<String>), Malformed> {
    let text = String::from_utf8_lossy(bytes).to_ascii_lowercase();
    let mut joined = String::with_capacity(text.len() + 32);
    joined.push_str("solid -\n");
    let mut notes = Vec::new();
    // Line of the beginning of the open solid, and position in the current triangle.
    let (mut begun, mut stage, mut last) = (None::<usize>, 0_usize, 1_usize);
    for (number, line) in numbered(&text) {
        let line = line.trim_matches(|c: char| c.is_whitespace() || c == '\0' || c == '\u{1a}');
        let mut words = line.split_whitespace();
        let Some(word) = words.clone().next() else {
            continue;
        };
        last = number;
        let unexpected =
            |expected| Malformed::new(format!("`{}` in line {number}", brief(line)), expected);
        match (word, begun) {
            ("solid", None) => begun = Some(number),
            ("solid", Some(line)) => {
                return Err(Malformed::new(
                    format!("a solid in line {number} within the solid of line {line}"),
                    "`endsolid` before the next solid",
                ));
            }
            (_, None) => {
                return Err(Malformed::new(
                    format!(
                        "`{}` in line {number} after the end of a solid",
                        brief(line)
                    ),
                    EXPECTED,
                ));
            }
            ("endsolid", Some(_)) if stage == 0 => begun = None,
            (_, Some(_)) => {
                let (expected, numbers, described) = FACET[stage];
                if !expected.iter().all(|&word| words.next() == Some(word)) {
                    return Err(unexpected(described));
                }
                let rest: Vec<&str> = words.collect();
                if rest.len() != numbers {
                    return Err(unexpected(described));
                }
                let finite = |word: &&str| word.parse::<f32>().is_ok_and(f32::is_finite);
                if stage == 0 {
                    // Normals are computed from the corners. For triangles without area they are NaN.
                    joined.push_str("facet normal 0 0 0\n");
                } else if let Some(wrong) = rest.iter().find(|word| !finite(word)) {
                    return Err(Malformed::new(
                        format!("`{}` in line {number}", brief(wrong)),
                        "a finite number",
                    ));
                } else {
                    joined.push_str(line);
                    joined.push('\n');
                }
                stage = (stage + 1) % FACET.len();
            }
        }
    }
    if let Some(begun) = begun {
        return Err(Malformed::new(
            format!(
                "an ASCII file that ends in line {last} before `endsolid` (its solid begins in line {begun})"
            ),
            EXPECTED,
        ));
    }
    let zeros = bytes.iter().rev().take_while(|&&byte| byte == 0).count();
    if zeros > 0 {
        notes.push(format!(
            "{zeros} bytes behind the last line were not read (zeros)"
        ));
    }
    joined.push_str("endsolid\n");
    Ok((joined.into_bytes(), notes))
}

/// Returns a mesh as binary STL bytes in millimetres, for export and tests.
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
