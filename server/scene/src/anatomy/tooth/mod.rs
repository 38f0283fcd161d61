//! The teeth of a lower jaw: central and lateral incisor, canine, two premolars, two molars.
//!
//! Frame: x mesial, y buccal (labial), z occlusal (incisal). The origin lies on the tooth's axis at the height of the
//! buccal cemento-enamel junction (CEJ).
//!
//! Drawings are of the left side. A right tooth is the mirror image, y negated ([`Tooth::mesh_of_side`]).
//!
//! A tooth is an implicit function. Its walls follow its outlines (`section`) and are cut by a chewing surface
//! (`occlusal`). Grooves and fossae are carved into both. The two roots of a molar are joined on (`root`).
//!
//! Each tooth is drawn once, in the average sizes of dental anatomy, and stretched to the requested ones. Source:
//! Nelson, *Wheeler's Dental Anatomy, Physiology, and Occlusion*.

mod canine;
mod creases;
mod form;
mod incisor;
mod measure;
mod molar;
mod occlusal;
mod premolar;
mod root;
mod section;

use sulcus_core::Vec3;

use crate::mesh::TriMesh;
use crate::mesh::implicit::ramp;
use crate::mesh::polygonise::polygonise_distance;
use form::{Form, Size};

pub use crate::file::ToothSizes;
pub use creases::Fissure;
pub use measure::Furcation;

/// A lower tooth: its number and its dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Tooth {
    /// FDI number as requested.
    fdi: u8,
    size: Size,
    relief: f64,
    grid_mm: f64,
}

impl Tooth {
    /// Returns the tooth of an FDI number, 31 to 37 or 41 to 47, in its average size. The drawing is of the left
    /// side.
    pub fn lower(fdi: u8) -> Option<Self> {
        form(fdi).map(|form| Self {
            fdi,
            size: form.usual,
            relief: 1.0,
            grid_mm: form.grid,
        })
    }

    /// Returns the tooth in other sizes. Omitted sizes stay.
    pub fn with_sizes(mut self, sizes: &ToothSizes) -> Self {
        let set = |to: &mut f64, from: Option<f64>| {
            if let Some(x) = from {
                *to = x;
            }
        };
        set(&mut self.size.mesiodistal, sizes.mesiodistal_mm);
        set(&mut self.size.buccolingual, sizes.buccolingual_mm);
        set(&mut self.size.crown, sizes.crown_height_mm);
        set(&mut self.size.root, sizes.root_length_mm);
        set(&mut self.relief, sizes.relief);
        set(&mut self.grid_mm, sizes.grid_mm);
        self
    }

    /// FDI number.
    pub fn fdi(&self) -> u8 {
        self.fdi
    }

    /// Largest mesiodistal width of the crown, mm.
    pub fn mesiodistal_mm(&self) -> f64 {
        self.size.mesiodistal
    }

    /// Largest buccolingual width of the crown, mm.
    pub fn buccolingual_mm(&self) -> f64 {
        self.size.buccolingual
    }

    /// Height of the highest cusp or of the incisal edge above the buccal CEJ, mm.
    pub fn crown_height_mm(&self) -> f64 {
        self.size.crown
    }

    /// Length of the (longer) root, mm.
    pub fn root_length_mm(&self) -> f64 {
        self.size.root
    }

    /// Edge of the grid that the surface is made on, mm.
    pub fn grid_mm(&self) -> f64 {
        self.grid_mm
    }

    /// The closed surface, metres, in the frame of this module.
    pub fn mesh(&self) -> TriMesh {
        let size = &self.size;
        let margin = 0.7 + self.grid_mm;
        // The crown of a premolar leans over its root, so half its width is not enough.
        let (x, y) = (
            0.62 * size.mesiodistal + margin,
            0.62 * size.buccolingual + margin,
        );
        let low = Vec3::new(-x, -y, -size.root - margin);
        let high = Vec3::new(x, y, size.crown + margin);
        let inside = |p: &Vec3| self.distance(p);
        // In a groove narrower than the grid, two walls may share an edge on one grid and not on the next. The first
        // grid that gives a manifold is taken.
        let on_grid = |k: u32| {
            let shift = Vec3::new(0.37, 0.61, 0.83) * (self.grid_mm * 0.25 * f64::from(k));
            polygonise_distance(&inside, low - shift, high, self.grid_mm)
                .placed(1e-3, Vec3::zeros())
        };
        let mut mesh = on_grid(0);
        for k in 1..8 {
            if crate::mesh::check::check(&mesh, "tooth").is_ok() {
                break;
            }
            mesh = on_grid(k);
        }
        mesh
    }

    /// Returns [`Tooth::mesh`] for the side of the FDI number; right teeth are mirrored.
    pub fn mesh_of_side(&self) -> TriMesh {
        let mut mesh = self.mesh();
        if self.fdi >= 40 {
            for vertex in &mut mesh.vertices {
                vertex.y = -vertex.y;
            }
            for triangle in &mut mesh.triangles {
                triangle.swap(1, 2);
            }
        }
        mesh
    }

    /// Height of the CEJ, mm, at an angle from mesial over buccal, radians.
    pub fn cej(&self, around: f64) -> f64 {
        // The drawing is also stretched across, and directions with it.
        let (x, y) = (libm::cos(around), libm::sin(around));
        let form = self.form();
        let drawn_x = x * form.drawn.mesiodistal / self.size.mesiodistal;
        let drawn_y = y * form.drawn.buccolingual / self.size.buccolingual;
        self.raised(form.walls.cej(drawn_x, drawn_y))
    }

    fn form(&self) -> &'static Form {
        // Only numbers with a form make a tooth.
        form(self.fdi).unwrap_or(&incisor::CENTRAL)
    }

    /// Returns about the signed distance to the surface, mm, at a point in mm; negative inside.
    pub fn distance(&self, p: &Vec3) -> f64 {
        let (form, size) = (self.form(), &self.size);
        let q = Vec3::new(
            p.x * form.drawn.mesiodistal / size.mesiodistal,
            p.y * form.drawn.buccolingual / size.buccolingual,
            self.lowered(p.z),
        );
        form.distance(&q, self.relief)
    }

    /// Returns the factor of the stretch at a height. Crown and root have a factor each; the change is spread over
    /// the neck.
    fn factor(&self, z: f64) -> f64 {
        let (drawn, size) = (&self.form().drawn, &self.size);
        let (up, down) = (size.crown / drawn.crown, size.root / drawn.root);
        down + (up - down) * ramp(z, -3.0, 3.0)
    }

    /// Returns the drawn height of a height.
    fn lowered(&self, z: f64) -> f64 {
        z / self.factor(z)
    }

    /// Returns the height of a drawn height, by iteration.
    fn raised(&self, drawn: f64) -> f64 {
        let mut z = drawn;
        for _ in 0..40 {
            let next = drawn * self.factor(z);
            // Further steps would repeat this one.
            if next == z {
                break;
            }
            z = next;
        }
        z
    }
}

/// Returns the drawing of a tooth.
fn form(fdi: u8) -> Option<&'static Form> {
    if !(3..=4).contains(&(fdi / 10)) {
        return None;
    }
    match fdi % 10 {
        1 => Some(&incisor::CENTRAL),
        2 => Some(&incisor::LATERAL),
        3 => Some(&canine::CANINE),
        4 => Some(&premolar::FIRST),
        5 => Some(&premolar::SECOND),
        6 => Some(&molar::FIRST),
        7 => Some(&molar::SECOND),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
