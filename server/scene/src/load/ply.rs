//! PLY: a header that describes a table of vertices and a table of faces, then the tables as text
//! or binary in either byte order.

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};
use sulcus_core::Vec3;

use super::{Malformed, brief};
use crate::mesh::TriMesh;

/// Longest header that is read, bytes.
const LONGEST_HEADER: usize = 1 << 20;
/// Names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads PLY; lengths stay in the file's unit.
pub(super) fn parse(mut bytes: Vec<u8>) -> Result<TriMesh, Malformed> {
    let end = bytes[..bytes.len().min(LONGEST_HEADER)]
        .windows(10)
        .position(|word| word == b"end_header")
        .ok_or_else(|| {
            Malformed::new(
                format!("no `end_header` in the first {LONGEST_HEADER} bytes"),
                "a PLY header",
            )
        })?;
    // Comments may be in any character set; the reader wants UTF-8.
    for byte in &mut bytes[..end] {
        if !byte.is_ascii() {
            *byte = b'?';
        }
    }
    let mut reader = Reader::new(&bytes[..]);
    let header = Parser::<Vertex>::new()
        .read_header(&mut reader)
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
        line: bytes[..end].iter().filter(|&&byte| byte == b'\n').count() + 1,
        rest: reader.into_inner(),
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
                mesh.triangles.extend(face.fan(mesh.vertices.len())?);
                Ok(())
            })?,
            _ => payload.each(element, |_: Other| Ok(()))?,
        }
    }
    Ok(mesh)
}

/// Whether the header describes a surface, and no more of it than the file can hold.
fn described(header: &Header, available: usize) -> Result<(), Malformed> {
    let names: Vec<&str> = header.elements.keys().map(String::as_str).collect();
    let place = |name| header.elements.get_index_of(name);
    let (Some(vertex), Some(face)) = (place("vertex"), place("face")) else {
        return Err(Malformed::new(
            format!("a PLY file of [{}]", brief(&names.join(", "))),
            "elements `vertex` and `face`",
        ));
    };
    if face < vertex {
        return Err(Malformed::new(
            "`face` before `vertex`",
            "vertices before the faces that name them",
        ));
    }
    for axis in ["x", "y", "z"] {
        let property = header.elements[vertex].properties.get(axis);
        if !property.is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_))) {
            return Err(Malformed::new(
                format!("no number `{axis}` in element `vertex`"),
                "properties x, y and z",
            ));
        }
    }
    let corners = CORNERS
        .iter()
        .find_map(|name| header.elements[face].properties.get(*name));
    if !corners.is_some_and(|p| {
        matches!(&p.data_type, PropertyType::List(_, of) if !matches!(of, ScalarType::Float | ScalarType::Double))
    }) {
        return Err(Malformed::new(
            "no list of whole numbers `vertex_indices` in element `face`",
            "faces that name their vertices",
        ));
    }
    let mut needed = 0_u128;
    for element in header.elements.values() {
        needed += element.count as u128 * smallest(element, header.encoding) as u128;
        // The last line of a text file may lack its end.
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
        // A digit and what parts it from the next; at least the end of the line.
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

/// What follows the header.
struct Payload<'a> {
    rest: &'a [u8],
    encoding: Encoding,
    /// Lines read so far, for text.
    line: usize,
}

impl Payload<'_> {
    /// Reads the entries of one element, one at a time: what is kept is for the taker to say.
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

    /// The next line of text that is not blank (or any, where blank is right).
    fn text_line(&mut self, blank: bool) -> Option<String> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|&byte| byte == b'\n');
            let (line, rest) = match end {
                Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
                None => (self.rest, &[][..]),
            };
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

/// A polygon's corners.
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
    fn fan(&self, vertices: usize) -> Result<Vec<[u32; 3]>, Malformed> {
        if self.0.len() < 3 {
            return Err(Malformed::new(
                format!("{} corners", self.0.len()),
                "at least 3",
            ));
        }
        let mut corners = Vec::with_capacity(self.0.len());
        for &corner in &self.0 {
            match u32::try_from(corner) {
                Ok(known) if (known as usize) < vertices => corners.push(known),
                _ => {
                    return Err(Malformed::new(
                        format!("vertex {corner} of {vertices}"),
                        "a vertex of the file, counted from 0",
                    ));
                }
            }
        }
        Ok((2..corners.len())
            .map(|k| [corners[0], corners[k - 1], corners[k]])
            .collect())
    }
}

/// Anything else, read over.
struct Other;

impl PropertyAccess for Other {
    fn new() -> Self {
        Self
    }
}
