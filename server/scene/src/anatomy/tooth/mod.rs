//! The teeth of a lower jaw: central and lateral incisor, canine, two premolars, two molars.
//!
//! Frame: x mesial, y buccal (labial), z occlusal (incisal); the origin lies on the tooth's axis at the height of the
//! buccal cemento-enamel junction (CEJ). A tooth is drawn as one of the left side; one of the right side is its mirror
//! image (y negated, [`Tooth::mesh_of_side`]).
//!
//! A tooth is an implicit function: walls that follow its outlines (`section`) cut by a chewing surface
//! (`occlusal`), grooves and fossae carved into both; the two roots of a molar are joined on (`root`). Each tooth is
//! drawn once in the average sizes of dental anatomy (Nelson, *Wheeler's Dental Anatomy, Physiology, and Occlusion*) and
//! stretched to those asked for.

mod canine;
mod incisor;
mod measure;
mod molar;
mod occlusal;
mod premolar;
mod root;
mod section;

use serde::{Deserialize, Serialize};
use sulcus_core::Vec3;

use crate::mesh::TriMesh;
use crate::mesh::implicit::{bell, ramp, smooth_max, smooth_min};
use crate::mesh::polygonise::polygonise;
use root::Roots;
use section::{Spot, Walls};

/// Dimensions of a tooth, millimetres. What is left out is the average of that tooth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ToothSizes {
    /// Largest mesiodistal width of the crown, mm.
    pub mesiodistal_mm: Option<f64>,
    /// Largest buccolingual width of the crown, mm.
    pub buccolingual_mm: Option<f64>,
    /// Height of the highest cusp or of the incisal edge above the buccal CEJ, mm.
    pub crown_height_mm: Option<f64>,
    /// Length of the (longer) root from the buccal CEJ to its apex, mm.
    pub root_length_mm: Option<f64>,
    /// Depth of the chewing surface's relief relative to the usual one. Without effect on incisors.
    pub relief: Option<f64>,
    /// Edge of the grid that the surface is made on, mm. Smaller: more triangles.
    pub grid_mm: Option<f64>,
}

/// An entrance between two roots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Furcation {
    /// Where on the tooth it opens: angle from mesial over buccal, radians, -pi to pi.
    pub around: f64,
    /// Height of its roof at the entrance, mm; negative, as it lies below the CEJ.
    pub height_mm: f64,
}

/// A lower tooth: which one, and its dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Tooth {
    /// FDI number as asked for.
    fdi: u8,
    size: Size,
    relief: f64,
    grid_mm: f64,
}

/// Overall dimensions, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    mesiodistal: f64,
    buccolingual: f64,
    crown: f64,
    root: f64,
}

/// How one tooth is drawn.
struct Form {
    /// Average size, which is what a tooth has when nothing else is asked for.
    usual: Size,
    /// Size of the drawing below, from its own extremes.
    drawn: Size,
    /// Edge of the grid, mm.
    grid: f64,
    walls: Walls,
    /// Rounding of the edge between walls and chewing surface, mm.
    edge: f64,
    /// Height of the chewing surface over a point, by relief.
    chewing: fn(x: f64, y: f64, relief: f64) -> f64,
    /// What is carved out of the walls (positive) or laid on (negative), mm.
    carving: fn(&Spot) -> f64,
    /// Roots of their own, where there are two.
    roots: Option<Roots>,
}

impl Tooth {
    /// The tooth of an FDI number, 31 to 37 or 41 to 47, in its average size; drawn as one of the left side.
    pub fn lower(fdi: u8) -> Option<Self> {
        form(fdi).map(|form| Self {
            fdi,
            size: form.usual,
            relief: 1.0,
            grid_mm: form.grid,
        })
    }

    /// The same tooth in other sizes; what is not given stays.
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
        // Where a groove is narrower than the grid, two walls may share an edge on one grid and not
        // on the next: the first grid that gives a manifold is taken.
        let on_grid = |k: u32| {
            let shift = Vec3::new(0.37, 0.61, 0.83) * (self.grid_mm * 0.25 * f64::from(k));
            polygonise(&inside, low - shift, high, self.grid_mm).placed(1e-3, Vec3::zeros())
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

    /// [`Tooth::mesh`] for the side that the FDI number is of: the right ones are mirrored.
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

    /// The mesial and the distal contact point, mm: where the crown reaches farthest.
    pub fn contacts(&self) -> [Vec3; 2] {
        [measure::contact(self, 1.0), measure::contact(self, -1.0)]
    }

    /// Height of the CEJ, mm, at an angle from mesial over buccal, radians.
    pub fn cej(&self, around: f64) -> f64 {
        // The drawing is stretched across too, and with it the directions.
        let (x, y) = (libm::cos(around), libm::sin(around));
        let form = self.form();
        let drawn_x = x * form.drawn.mesiodistal / self.size.mesiodistal;
        let drawn_y = y * form.drawn.buccolingual / self.size.buccolingual;
        self.raised(form.walls.cej(drawn_x, drawn_y))
    }

    /// The entrances between the roots; none where there is one root.
    pub fn furcations(&self) -> Vec<Furcation> {
        if self.form().roots.is_none() {
            return Vec::new();
        }
        [1.0, -1.0]
            .into_iter()
            .map(|side| measure::furcation(self, side))
            .collect()
    }

    fn form(&self) -> &'static Form {
        // A tooth is only made for a number that has a form.
        form(self.fdi).unwrap_or(&incisor::CENTRAL)
    }

    /// Roughly the signed distance to the surface, mm, at a point in mm; negative inside.
    pub fn distance(&self, p: &Vec3) -> f64 {
        let (form, size) = (self.form(), &self.size);
        let q = Vec3::new(
            p.x * form.drawn.mesiodistal / size.mesiodistal,
            p.y * form.drawn.buccolingual / size.buccolingual,
            self.lowered(p.z),
        );
        form.distance(&q, self.relief)
    }

    /// Crown and root are stretched each by its own factor; the change is spread over the neck.
    fn factor(&self, z: f64) -> f64 {
        let (drawn, size) = (&self.form().drawn, &self.size);
        let (up, down) = (size.crown / drawn.crown, size.root / drawn.root);
        down + (up - down) * ramp(z, -3.0, 3.0)
    }

    /// Drawn height of a height.
    fn lowered(&self, z: f64) -> f64 {
        z / self.factor(z)
    }

    /// Height of a drawn height, by a few rounds of its inverse.
    fn raised(&self, drawn: f64) -> f64 {
        let mut z = drawn;
        for _ in 0..40 {
            z = drawn * self.factor(z);
        }
        z
    }
}

impl Form {
    /// Roughly the signed distance at a drawn point, mm.
    fn distance(&self, p: &Vec3, relief: f64) -> f64 {
        let (walls, spot) = self.walls.at(p);
        let walls = walls + (self.carving)(&spot);
        // Above the neck only: the height field is not made for the root.
        let whole = if p.z > 0.0 {
            let top = (p.z - (self.chewing)(p.x, p.y, relief)) * 0.8;
            smooth_max(walls, top, self.edge)
        } else {
            walls
        };
        match &self.roots {
            None => whole,
            Some(roots) => {
                let trunk = smooth_max(whole, roots.roof(p) - p.z, roots.arch);
                let [a, b] = roots.tubes(p);
                // A fillet in the furcation; on the outer faces trunk and root are flush.
                let fillet = 0.15 + 0.65 * bell(p.x, 1.7);
                smooth_min(trunk, smooth_min(a, b, 0.4), fillet)
            }
        }
    }
}

/// The drawing of a tooth.
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
