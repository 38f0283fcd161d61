//! Soft tissues as meshes for the wire, with the colour and the finish of each vertex.

mod colour;
mod finish;
mod lab;
mod noise;
mod tongue;

use sulcus_core::Vec3;
use sulcus_proto::CodecError;
use sulcus_proto::display::{DisplayMesh, Finish};
use sulcus_scene::anatomy::mouth::{Mark, Piece};

use crate::display::f32s;

/// Colour of a whole mesh where a screen has no colours of vertices: attached gingiva, sRGB.
const PLAIN: [u8; 4] = [183, 117, 108, 255];

/// Returns the mesh of a piece of the sheet.
pub(crate) fn piece(piece: &Piece) -> Result<DisplayMesh, CodecError> {
    let vertices: Vec<[f32; 3]> = piece.mesh.vertices.iter().map(f32s).collect();
    let at = |(v, mark): (&Vec3, &Mark)| {
        let at = v * 1e3;
        (colour::colour(&at, mark), finish::finish(&at, mark))
    };
    let (colours, finishes): (Vec<[u8; 4]>, Vec<Finish>) =
        piece.mesh.vertices.iter().zip(&piece.marks).map(at).unzip();
    DisplayMesh::new(&vertices, &piece.mesh.triangles, PLAIN, &colours)?.with_finishes(finishes)
}

/// Returns the mesh of a tongue. Its shape is the simulated one.
pub(crate) fn tongue(mesh: &sulcus_core::DisplayMesh) -> Result<DisplayMesh, CodecError> {
    let (colours, finishes) = tongue::tongue(mesh);
    DisplayMesh::new(&mesh.vertices, &mesh.triangles, mesh.colour, &colours)?
        .with_finishes(finishes)
}
