//! Mesh files: OBJ as text, PLY as a small binary.

use std::io::{self, Write};

use sulcus_core::DisplayMesh;

/// Format of mesh files. Metres, world axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront: text, colours after the coordinates of each vertex.
    Obj,
    /// Stanford: binary, little-endian.
    Ply,
}

impl MeshFormat {
    /// Ending of the file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
        }
    }

    /// Writes `mesh` with its vertices at `vertices`.
    pub(super) fn write(
        self,
        out: &mut impl Write,
        mesh: &DisplayMesh,
        vertices: &[[f32; 3]],
    ) -> io::Result<()> {
        match self {
            Self::Obj => obj(out, mesh, vertices),
            Self::Ply => ply(out, mesh, vertices),
        }
    }
}

fn colour(mesh: &DisplayMesh, vertex: usize) -> [u8; 4] {
    mesh.vertex_colours
        .get(vertex)
        .copied()
        .unwrap_or(mesh.colour)
}

fn obj(out: &mut impl Write, mesh: &DisplayMesh, vertices: &[[f32; 3]]) -> io::Result<()> {
    writeln!(
        out,
        "# metres; world: x anterior, y to the patient's left, z up"
    )?;
    for (v, [x, y, z]) in vertices.iter().enumerate() {
        let [r, g, b, _] = colour(mesh, v).map(|c| f32::from(c) / 255.0);
        writeln!(out, "v {x} {y} {z} {r:.3} {g:.3} {b:.3}")?;
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| v + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

fn ply(out: &mut impl Write, mesh: &DisplayMesh, vertices: &[[f32; 3]]) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment metres; world: x anterior, y to the patient's left, z up\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        mesh.triangles.len()
    )?;
    for (v, vertex) in vertices.iter().enumerate() {
        for x in vertex {
            out.write_all(&x.to_le_bytes())?;
        }
        out.write_all(&colour(mesh, v))?;
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for v in triangle {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    Ok(())
}
