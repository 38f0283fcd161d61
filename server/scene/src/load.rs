//! Reading STL files, binary and ASCII. STL has no unit: whoever names the file names the unit.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// Unit of length of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Metres.
    #[serde(rename = "m")]
    Metre,
}

impl Unit {
    /// Length of one unit, metres.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Millimetre => 1e-3,
            Unit::Metre => 1.0,
        }
    }
}

impl std::str::FromStr for Unit {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "mm" => Ok(Unit::Millimetre),
            "m" => Ok(Unit::Metre),
            other => Err(format!("unit is `{other}`, expected `mm` or `m`")),
        }
    }
}

/// Why a mesh file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be opened or read.
    #[error("{}: cannot read the file: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not STL.
    #[error("{}: found {what}, expected a binary or ASCII STL file", file.display())]
    Format {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// Reads an STL file and welds vertices with equal coordinates. Metres.
///
/// # Errors
/// If the file cannot be read or is not STL. Whether the mesh is usable is not looked at here.
pub fn load_stl(file: &Path, unit: Unit) -> Result<TriMesh, LoadError> {
    let bytes = std::fs::read(file).map_err(|source| LoadError::Read {
        file: file.to_owned(),
        source,
    })?;
    parse_stl(bytes, unit).map_err(|what| LoadError::Format {
        file: file.to_owned(),
        what,
    })
}

/// Bytes before the first triangle of a binary STL file.
const HEADER: usize = 84;
/// Bytes of a triangle.
const RECORD: usize = 50;

/// Reads STL from bytes and welds vertices with equal coordinates. Metres.
///
/// # Errors
/// One clause that says what was found.
pub fn parse_stl(mut bytes: Vec<u8>, unit: Unit) -> Result<TriMesh, String> {
    let counted = bytes
        .get(80..HEADER)
        .and_then(|count| count.try_into().ok())
        .map(|count| HEADER + RECORD * u32::from_le_bytes(count) as usize);
    if bytes.starts_with(b"solid") && counted == Some(bytes.len()) {
        // Many exporters begin binary files with "solid" too; the length tells them apart.
        bytes[..5].copy_from_slice(b"SOLID");
    } else if bytes.starts_with(b"solid\n") || bytes.starts_with(b"solid\r") {
        // The reader wants a name after "solid".
        bytes.splice(5..5, *b" -");
    } else if !bytes.starts_with(b"solid") {
        match counted {
            Some(length) if length == bytes.len() => {}
            Some(length) => {
                return Err(format!(
                    "{} bytes where the header announces {length}",
                    bytes.len()
                ));
            }
            None => return Err(format!("{} bytes", bytes.len())),
        }
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let scale = unit.metres();
    let welded = TriMesh {
        vertices: mesh
            .vertices
            .iter()
            .map(|v| Vec3::from(v.0.map(f64::from)) * scale)
            .collect(),
        triangles: mesh
            .faces
            .iter()
            .map(|face| face.vertices.map(|v| v as u32))
            .collect(),
    };
    Ok(welded.welded())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;

    #[test]
    fn binary_files_come_back_even_if_they_begin_with_solid() {
        let mesh = cuboid(Vec3::new(0.001, 0.002, 0.003));
        let mut bytes = to_stl(&mesh);
        for header in [b"plain ", b"solid "] {
            bytes[..6].copy_from_slice(header);
            let back = parse_stl(bytes.clone(), Unit::Millimetre).expect("binary STL");
            assert_eq!((back.vertices.len(), back.triangles.len()), (8, 12));
            assert!((back.signed_volume() / mesh.signed_volume() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn ascii_files_are_read_with_and_without_a_name() {
        let body = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
        for head in ["solid\n", "solid cube\n", "solid\r\n"] {
            let mesh =
                parse_stl(format!("{head}{body}").into_bytes(), Unit::Metre).expect("ASCII STL");
            assert_eq!(mesh.triangles.len(), 1);
            assert_eq!(mesh.bounds().1, Vec3::new(1.0, 1.0, 0.0));
        }
    }

    #[test]
    fn what_is_not_stl_is_refused_with_a_sentence() {
        assert!(
            parse_stl(b"v 0 0 0".to_vec(), Unit::Metre)
                .expect_err("not STL")
                .contains("7 bytes")
        );
        let mut short = to_stl(&cuboid(Vec3::repeat(0.01)));
        short.pop();
        assert!(
            parse_stl(short, Unit::Metre)
                .expect_err("cut")
                .contains("announces 684")
        );
        let missing = load_stl(Path::new("no/such.stl"), Unit::Metre)
            .expect_err("missing")
            .to_string();
        assert!(missing.starts_with("no/such.stl: cannot read"), "{missing}");
    }
}
