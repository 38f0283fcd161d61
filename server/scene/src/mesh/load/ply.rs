//! PLY: a header that describes a table of vertices and a table of faces, then the tables. They are text or binary in
//! either byte order.
//!
//! `header` depends on this module for the names of the elements of a surface.

mod header;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};
use sulcus_core::Vec3;

use super::lines;
use super::{Loaded, Malformed, brief};
use crate::mesh::TriMesh;
use crate::mesh::polygon::{FACE, triangulate};

/// Names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Elements that hold the surface: polygons, and strips of triangles with -1 between them.
const SURFACES: [&str; 2] = ["face", "tristrips"];

/// Reads PLY in the file's unit.
pub(super) fn parse(bytes: Vec<u8>) -> Result<Loaded, Malformed> {
    let written = header::normalised(&bytes)?;
    let header = Parser::<Vertex>::new()
        .read_header(&mut Reader::new(written.text.as_bytes()))
        .map_err(|error| {
            Malformed::new(
                format!(
                    "a header that is wrong in line {} ({})",
                    error.line().unwrap_or(1),
                    brief(&error.to_string())
                ),
                "a PLY header",
            )
        })?;
    let mut payload = Payload {
        line: written.lines,
        rest: &bytes[written.length..],
        encoding: header.encoding,
    };
    described(&header, payload.rest.len())?;
    let mut mesh = TriMesh::default();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => payload.each(element, |vertex: Vertex| {
                mesh.vertices.push(Vec3::from(vertex.0));
                Ok(())
            })?,
            "face" => payload.each(element, |face: Face| {
                let corners = face.corners(mesh.vertices.len())?;
                triangulate(&corners, &mesh.vertices, &mut mesh.triangles)
                    .map_err(|found| Malformed::new(found, FACE))
            })?,
            "tristrips" => payload.each(element, |strips: Face| {
                strips.strips(mesh.vertices.len(), &mut mesh.triangles)
            })?,
            _ => payload.each(element, |_: Other| Ok(()))?,
        }
    }
    let behind = payload.rest.trim_ascii_end().len();
    let notes =
        (behind > 0).then(|| format!("{behind} bytes behind the last element were not read"));
    Ok(Loaded {
        mesh,
        notes: notes.into_iter().collect(),
    })
}

/// Checks that the header describes a surface, and not more entries than the file can hold.
fn described(header: &Header, available: usize) -> Result<(), Malformed> {
    let names: Vec<&str> = header.elements.keys().map(String::as_str).collect();
    let place = |name: &str| header.elements.get_index_of(name);
    let surfaces: Vec<usize> = SURFACES.iter().filter_map(|name| place(name)).collect();
    let (Some(vertex), false) = (place("vertex"), surfaces.is_empty()) else {
        return Err(Malformed::new(
            format!("a PLY file of [{}]", brief(&names.join(", "))),
            "elements `vertex` and `face` (or `tristrips`)",
        ));
    };
    for axis in ["x", "y", "z"] {
        let property = header.elements[vertex].properties.get(axis);
        if !property.is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_))) {
            return Err(Malformed::new(
                format!("no number `{axis}` in element `vertex`"),
                "properties x, y and z",
            ));
        }
    }
    for face in surfaces {
        let name = names[face];
        if face < vertex {
            return Err(Malformed::new(
                format!("`{name}` before `vertex`"),
                "vertices before the faces that name them",
            ));
        }
        let properties = &header.elements[face].properties;
        let mut lists = CORNERS.iter().filter_map(|name| properties.get(*name));
        let corners = lists.next();
        if lists.next().is_some() {
            return Err(Malformed::new(
                format!("both `vertex_indices` and `vertex_index` in element `{name}`"),
                "one list of corners",
            ));
        }
        if !corners.is_some_and(|p| {
            matches!(&p.data_type, PropertyType::List(_, of) if !matches!(of, ScalarType::Float | ScalarType::Double))
        }) {
            return Err(Malformed::new(
                format!("no list of whole numbers `vertex_indices` in element `{name}`"),
                "faces that name their vertices",
            ));
        }
    }
    let mut needed = 0_u128;
    for element in header.elements.values() {
        needed += element.count as u128 * smallest(element, header.encoding) as u128;
        // The last line of a text file may have no end.
        if needed > available as u128 + 1 {
            return Err(Malformed::new(
                format!(
                    "{available} bytes of data where the header announces {} of element `{}` and so at least {needed} bytes",
                    element.count,
                    brief(&element.name),
                ),
                "as much data as the header announces",
            ));
        }
    }
    Ok(())
}

/// Fewest bytes that an entry of an element takes.
fn smallest(element: &ElementDef, encoding: Encoding) -> usize {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    match encoding {
        // A digit and its separator, at least the end of the line.
        Encoding::Ascii => (2 * element.properties.len()).max(1),
        _ => element
            .properties
            .values()
            .map(|property| match &property.data_type {
                PropertyType::Scalar(scalar) => size(scalar),
                PropertyType::List(count, _) => size(count),
            })
            .sum(),
    }
}

/// Content after the header.
struct Payload<'a> {
    rest: &'a [u8],
    encoding: Encoding,
    /// Lines read so far, for text.
    line: usize,
}

impl Payload<'_> {
    /// Reads the entries of one element, one at a time. The receiver decides what is kept.
    fn each<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(E) -> Result<(), Malformed>,
    ) -> Result<(), Malformed> {
        let parser = Parser::<E>::new();
        if element.properties.is_empty() && self.encoding != Encoding::Ascii {
            return Ok(());
        }
        for entry in 0..element.count {
            let read = match self.encoding {
                Encoding::Ascii => match self.text_line(element.properties.is_empty()) {
                    Some(line) => parser.read_ascii_element(&line, element),
                    None => {
                        return Err(Malformed::new(
                            format!(
                                "the end of the file after {entry} of {} entries of element `{}`",
                                element.count,
                                brief(&element.name)
                            ),
                            "as much data as the header announces",
                        ));
                    }
                },
                Encoding::BinaryBigEndian => {
                    parser.read_big_endian_element(&mut self.rest, element)
                }
                Encoding::BinaryLittleEndian => {
                    parser.read_little_endian_element(&mut self.rest, element)
                }
            };
            let place = |found: &str| {
                let line = match self.encoding {
                    Encoding::Ascii => format!(", line {}", self.line),
                    _ => String::new(),
                };
                format!("{found} in `{}` {entry}{line}", brief(&element.name))
            };
            let value = read.map_err(|error| {
                Malformed::new(
                    place(&brief(&error.to_string())),
                    "an entry as the header describes it",
                )
            })?;
            take(value).map_err(|wrong| Malformed::new(place(&wrong.found), wrong.expected))?;
        }
        Ok(())
    }

    /// Returns the next line of text that is not blank; with `blank`, any line.
    fn text_line(&mut self, blank: bool) -> Option<String> {
        while let Some((line, rest)) = lines::first(self.rest) {
            self.rest = rest;
            self.line += 1;
            if blank || !line.trim_ascii().is_empty() {
                return Some(String::from_utf8_lossy(line).into_owned());
            }
        }
        None
    }
}

/// A vertex's place.
struct Vertex([f64; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 3])
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = match value {
            Property::Char(x) => f64::from(x),
            Property::UChar(x) => f64::from(x),
            Property::Short(x) => f64::from(x),
            Property::UShort(x) => f64::from(x),
            Property::Int(x) => f64::from(x),
            Property::UInt(x) => f64::from(x),
            Property::Float(x) => f64::from(x),
            Property::Double(x) => x,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// The list of a polygon's corners, or of strips.
struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match value {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

impl Face {
    /// Returns the corners, if they are vertices of the file.
    fn corners(&self, vertices: usize) -> Result<Vec<u32>, Malformed> {
        if self.0.len() < 3 {
            return Err(Malformed::new(
                format!("{} corners", self.0.len()),
                "at least 3",
            ));
        }
        let corners = self.0.iter().map(|&corner| known(corner, vertices));
        corners.collect()
    }

    /// Appends the triangles of strips with -1 between them.
    ///
    /// Every other triangle of a strip has the opposite direction. A triangle with a repeated corner leads the strip
    /// elsewhere and is not part of the surface.
    fn strips(&self, vertices: usize, triangles: &mut Vec<[u32; 3]>) -> Result<(), Malformed> {
        let between = |corner: &i64| *corner == -1 || *corner == i64::from(u32::MAX);
        for strip in self.0.split(between) {
            let corners: Vec<u32> = strip
                .iter()
                .map(|&corner| known(corner, vertices))
                .collect::<Result<_, _>>()?;
            for (k, step) in corners.windows(3).enumerate() {
                let [a, b, c] = [step[0], step[1], step[2]];
                if a != b && b != c && c != a {
                    triangles.push(if k % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
        Ok(())
    }
}

/// Returns a corner, if it is one of the vertices.
fn known(corner: i64, vertices: usize) -> Result<u32, Malformed> {
    match u32::try_from(corner) {
        Ok(known) if (known as usize) < vertices => Ok(known),
        _ => Err(Malformed::new(
            format!("vertex {corner} of {vertices}"),
            "a vertex of the file, counted from 0",
        )),
    }
}

/// Any other element, skipped.
struct Other;

impl PropertyAccess for Other {
    fn new() -> Self {
        Self
    }
}
