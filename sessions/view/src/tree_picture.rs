//! Picture of a sphere tree as plain data: the JSON that `sulcus-review tree` reads from standard input.

use serde::{Deserialize, Serialize};

use crate::error::ViewError;

/// Sphere tree with its mesh. Lengths in millimetres, x anterior, y to the patient's left, z up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TreePicture {
    /// Name of the mesh.
    pub name: String,
    /// Vertices of the mesh, fine enough for a colour each.
    pub vertices: Vec<[f32; 3]>,
    /// Unit normal of each vertex.
    pub normals: Vec<[f32; 3]>,
    /// Triangles as vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Levels, coarse to fine.
    pub levels: Vec<LevelPicture>,
}

/// Level of the tree.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelPicture {
    /// Number of the level.
    pub level: u8,
    /// Colour (sRGB) of each vertex of the mesh, by its error.
    pub vertex_colours: Vec<[u8; 3]>,
    /// Centres of the spheres.
    pub centres: Vec<[f32; 3]>,
    /// Radii of the spheres.
    pub radii: Vec<f32>,
    /// Colour (sRGB) of each sphere.
    pub sphere_colours: Vec<[u8; 3]>,
    /// Caption of the level, Markdown.
    pub caption: String,
}

impl TreePicture {
    /// Checks that the lists of every level match the mesh and each other.
    ///
    /// # Errors
    /// A list has another length: the level, the list, the length found and the length expected.
    pub fn fits(&self) -> Result<(), ViewError> {
        for level in &self.levels {
            for (field, found, expected) in [
                ("normals", self.normals.len(), self.vertices.len()),
                (
                    "vertex_colours",
                    level.vertex_colours.len(),
                    self.vertices.len(),
                ),
                ("radii", level.radii.len(), level.centres.len()),
                (
                    "sphere_colours",
                    level.sphere_colours.len(),
                    level.centres.len(),
                ),
            ] {
                if found != expected {
                    return Err(ViewError::Shape {
                        level: level.level,
                        field,
                        found,
                        expected,
                    });
                }
            }
        }
        Ok(())
    }
}
