//! OBJ: numbered vertices, polygons that name them, and data that no mesh needs.

use std::fmt::Write;

use sulcus_core::Vec3;

use super::lines::numbered;
use super::{Malformed, brief};
use crate::mesh::TriMesh;
use crate::mesh::polygon::{FACE, triangulate};

/// Expected corner of a face.
const CORNER: &str = "the number of a vertex in the file, counted from 1 or, negative, backwards";

/// Reads OBJ in the file's unit. Materials are ignored, groups and objects are one mesh, lines and points are no
/// surface.
pub(super) fn parse(bytes: &[u8]) -> Result<TriMesh, Malformed> {
    let surface = surface_only(&String::from_utf8_lossy(bytes))?;
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(
        &mut surface.text.as_bytes(),
        &tobj::LoadOptions::default(),
        no_materials,
    )
    .map_err(|error| Malformed::new(brief(&error.to_string()), "an OBJ file"))?;
    let mut mesh = TriMesh::default();
    let mut lines = surface.lines.iter();
    for model in models {
        let first = mesh.vertices.len() as u32;
        let (points, _) = model.mesh.positions.as_chunks::<3>();
        mesh.vertices.extend(points.iter().map(|p| Vec3::from(*p)));
        // Without arities every face is a triangle.
        let triangles = model.mesh.indices.len() / 3;
        let arities = match &model.mesh.face_arities[..] {
            [] => vec![3; triangles],
            arities => arities.to_vec(),
        };
        let mut rest = &model.mesh.indices[..];
        for corners in arities {
            let Some((face, behind)) = rest.split_at_checked(corners as usize) else {
                break;
            };
            rest = behind;
            let face: Vec<u32> = face.iter().map(|v| first + v).collect();
            let line = lines.next().copied().unwrap_or_default();
            triangulate(&face, &mesh.vertices, &mut mesh.triangles)
                .map_err(|found| Malformed::new(format!("{found} in line {line}"), FACE))?;
        }
    }
    Ok(mesh)
}

/// Part of a file that the reader receives.
#[derive(Default)]
struct Surface {
    /// Vertices and faces, a line each.
    text: String,
    /// Line of each face in the file.
    lines: Vec<usize>,
}

/// Returns the vertices and faces of a file, checked line by line: `v` with its place, `f` with the numbers of its
/// corners.
///
/// Colours, normals, textures, names and materials are left out. The reader may fail on them, and does not name the
/// line.
fn surface_only(text: &str) -> Result<Surface, Malformed> {
    let mut found = Surface::default();
    let surface = &mut found.text;
    let mut vertices = 0_i64;
    // Faces may name later vertices, so the largest number is checked at the end.
    let mut largest = (0_i64, 0_usize);
    for (number, line) in logical_lines(text) {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let places: Vec<&str> = words.collect();
                let parsed: Vec<f64> = places.iter().map_while(|word| word.parse().ok()).collect();
                // A fourth number alone is a weight; more are a colour.
                let weight = (places.len() == 4).then(|| parsed.get(3)).flatten();
                if parsed.len() < 3 || weight == Some(&0.0) {
                    return Err(Malformed::new(
                        format!("`{}` in line {number}", brief(&line)),
                        "`v` with three numbers",
                    ));
                }
                let kept = if weight.is_some() { 4 } else { 3 };
                surface.push('v');
                for word in &places[..kept] {
                    surface.push(' ');
                    surface.push_str(word);
                }
                vertices += 1;
            }
            Some("f") => {
                found.lines.push(number);
                surface.push('f');
                let mut corners = 0;
                for word in words {
                    let corner = word.split('/').next().unwrap_or_default();
                    let wrong =
                        || Malformed::new(format!("`{}` in line {number}", brief(word)), CORNER);
                    let index: i64 = corner.parse().map_err(|_| wrong())?;
                    if index == 0 || index < -vertices {
                        return Err(wrong());
                    }
                    if index > largest.0 {
                        largest = (index, number);
                    }
                    let index = if index < 0 {
                        vertices + 1 + index
                    } else {
                        index
                    };
                    let _ = write!(surface, " {index}");
                    corners += 1;
                }
                if corners < 3 {
                    return Err(Malformed::new(
                        format!("a face of {corners} corners in line {number}"),
                        "at least 3",
                    ));
                }
            }
            _ => continue,
        }
        surface.push('\n');
    }
    if largest.0 > vertices {
        return Err(Malformed::new(
            format!(
                "vertex {} named in line {} of a file with {vertices} vertices",
                largest.0, largest.1
            ),
            CORNER,
        ));
    }
    if vertices == 0 {
        return Err(Malformed::new(
            "no line that begins with `v`",
            "an OBJ file with vertices and faces",
        ));
    }
    Ok(found)
}

/// Returns lines without comments, with their numbers from 1.
///
/// A backslash at the end continues a line in the next. A comment ends with its line in any case: paths in comments
/// end in backslashes.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, std::borrow::Cow<'_, str>)> {
    let mut lines = numbered(text).map(|(number, line)| match line.split_once('#') {
        Some((before, _)) => (number, before),
        None => (number, line),
    });
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        if !line.trim_end().ends_with('\\') {
            return Some((number, line.into()));
        }
        let mut joined = String::new();
        let mut part = line;
        while let Some(begun) = part.trim_end().strip_suffix('\\') {
            joined.push_str(begun);
            joined.push(' ');
            match lines.next() {
                Some((_, next)) => part = next,
                None => return Some((number, joined.into())),
            }
        }
        joined.push_str(part);
        Some((number, joined.into()))
    })
}

/// Returns a mesh as the text of an OBJ file, in metres. Reading it gives the same mesh to the last bit, and the same
/// tree.
pub fn to_obj(mesh: &TriMesh) -> String {
    let vertices = mesh.vertices.iter();
    let vertices = vertices.map(|v| format!("v {} {} {}\n", v.x, v.y, v.z));
    let triangles = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| v + 1);
        format!("f {a} {b} {c}\n")
    });
    vertices.chain(triangles).collect()
}
