//! The spheres against the mesh: the exposed surface of a union of balls, cell by cell.
//!
//! The surface of every ball is cut into the triangles of an icosahedron, each into four, and so on.
//!
//! A cell inside another ball is dropped with all its parts. Exposure of a point is decided against every ball that
//! reaches it.
//!
//! Users: `spheres_to_mesh_mm` with its proven maximum, in the table and the JSON of `sulcus-server tree`.

use sulcus_core::math::{fmax, fmin, norm};
use sulcus_core::{Sphere, Vec3};

use super::largest::{Examined, Largest, largest};
use super::patch::{Place, SAME};
use super::union::{Cover, Union};
use crate::mesh::distance::MeshDistance;
use crate::mesh::shapes::icosphere;
use crate::parallel;

/// A point of the exposed surface.
pub(super) struct ExposedPoint {
    /// Number of its ball in the union.
    pub(super) ball: u32,
    pub(super) point: Vec3,
    /// Outward unit normal of its ball.
    pub(super) normal: Vec3,
    /// Its area, square metres.
    pub(super) area: f64,
    /// Distance to the mesh, metres.
    pub(super) distance: f64,
}

/// A cell of the unit sphere.
struct Cell {
    /// Its middle.
    direction: Vec3,
    /// Largest straight distance of its points from the middle.
    radius: f64,
    /// Solid angle.
    angle: f64,
}

/// The cells of the unit sphere, coarse to fine. The children of cell `k` are `4 k` to `4 k + 3`.
pub(super) struct Cells(Vec<Vec<Cell>>);

/// A spherical triangle by its corners.
type Corners = [Vec3; 3];

fn roots() -> Vec<Corners> {
    let mesh = icosphere(1.0, 0);
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect()
}

fn quarters([a, b, c]: &Corners) -> [Corners; 4] {
    let middle = |a: &Vec3, b: &Vec3| (a + b).normalize();
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [bc, ca, ab]]
}

/// Returns the middle of the corners, and the distance from it to the farthest corner.
fn disc(corners: &Corners) -> (Vec3, f64) {
    let direction = (corners[0] + corners[1] + corners[2]).normalize();
    let radius = corners
        .iter()
        .fold(0.0, |r, corner| fmax(r, norm(&(corner - direction))));
    (direction, radius)
}

impl Cells {
    /// Makes cells, at least `wanted` in the finest layer.
    pub(super) fn new(wanted: usize) -> Self {
        let mut corners = roots();
        let mut layers = Vec::new();
        loop {
            layers.push(corners.iter().map(cell).collect());
            if corners.len() >= wanted {
                return Self(layers);
            }
            corners = corners.iter().flat_map(quarters).collect();
        }
    }

    /// Returns the number of cells of the finest layer.
    pub(super) fn finest(&self) -> usize {
        self.0.last().map_or(0, Vec::len)
    }

    /// Returns the middles of the finest cells that no other ball covers.
    pub(super) fn exposed(&self, union: &Union, distance: &MeshDistance) -> Vec<ExposedPoint> {
        parallel::map(union.spheres().len(), |own| {
            let mut points = Vec::new();
            for root in 0..self.0[0].len() {
                self.descend(0, root, own, union, distance, &mut points);
            }
            points
        })
        .into_iter()
        .flatten()
        .collect()
    }

    fn descend(
        &self,
        layer: usize,
        index: usize,
        own: usize,
        union: &Union,
        distance: &MeshDistance,
        points: &mut Vec<ExposedPoint>,
    ) {
        let sphere = &union.spheres()[own];
        let cell = &self.0[layer][index];
        let point = sphere.centre + cell.direction * sphere.radius;
        let radius = cell.radius * sphere.radius;
        let cover = union.cover(&point, own, |s| {
            norm(&(point - s.centre)) + radius < s.radius
        });
        if layer + 1 < self.0.len() {
            if cover != Cover::Whole {
                for child in 4 * index..4 * index + 4 {
                    self.descend(layer + 1, child, own, union, distance, points);
                }
            }
        } else if cover == Cover::Nothing {
            points.push(ExposedPoint {
                ball: own as u32,
                point,
                normal: cell.direction,
                area: cell.angle * sphere.radius * sphere.radius,
                distance: distance.signed(&point).abs(),
            });
        }
    }
}

fn cell(corners: &Corners) -> Cell {
    let (direction, radius) = disc(corners);
    let [a, b, c] = corners;
    // Van Oosterom and Strackee 1983, doi:10.1109/TBME.1983.325207.
    let below = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    let angle = 2.0 * libm::atan2(a.dot(&b.cross(c)).abs(), below);
    Cell {
        direction,
        radius,
        angle,
    }
}

/// Returns the largest distance to the mesh over the exposed surface whose nearest point of the mesh is in the zone.
pub(super) fn largest_over(
    union: &Union,
    distance: &MeshDistance,
    place: Option<&Place>,
    floor: f64,
    budget: usize,
) -> Largest {
    let icosahedron = roots();
    let cells = (0..union.spheres().len())
        .flat_map(|own| {
            icosahedron.iter().map(move |corners| Piece {
                own,
                corners: *corners,
                bound: f64::INFINITY,
                slack: 0.0,
            })
        })
        .collect();
    largest(
        cells,
        floor,
        budget,
        |piece: &Piece, matters| {
            let sphere = &union.spheres()[piece.own];
            let (direction, chord) = disc(&piece.corners);
            let point = sphere.centre + direction * sphere.radius;
            let radius = chord * sphere.radius;
            let cover = union.cover(&point, piece.own, |s| {
                farthest(sphere, &piece.corners, chord, &s.centre) < s.radius
            });
            let nothing = Examined {
                attained: None,
                bound: None,
            };
            if cover == Cover::Whole {
                return nothing;
            }
            // Deep inside only the cover is needed, so the distance is not computed.
            if cover == Cover::Point
                && piece.bound.is_finite()
                && piece.bound - piece.slack > matters
            {
                return Examined {
                    attained: None,
                    bound: Some(piece.bound),
                };
            }
            let nearest = distance.nearest(&point);
            let value = nearest.signed.abs();
            let detour = place.map_or(0.0, |place| place.detour(&point, value));
            if detour > 2.0 * radius + SAME {
                return nothing;
            }
            Examined {
                attained: (cover == Cover::Nothing && detour < SAME).then_some(value),
                bound: Some(fmin(
                    value + radius,
                    farthest(sphere, &piece.corners, chord, &nearest.point),
                )),
            }
        },
        |piece, bound| {
            let radius = disc(&piece.corners).1 * union.spheres()[piece.own].radius;
            quarters(&piece.corners).map(|corners| Piece {
                own: piece.own,
                corners,
                bound,
                slack: 2.0 * radius,
            })
        },
    )
}

/// A part of a ball's surface.
struct Piece {
    own: usize,
    corners: Corners,
    /// Upper bound of the distances.
    bound: f64,
    /// Largest difference between a distance and `bound`.
    slack: f64,
}

/// Returns an upper bound of the distance of the cell's points from `point`.
fn farthest(sphere: &Sphere, corners: &Corners, chord: f64, point: &Vec3) -> f64 {
    let off = sphere.centre - point;
    let along = corners.iter().fold(f64::NEG_INFINITY, |most, corner| {
        fmax(most, corner.dot(&off))
    });
    // Directions of the cell are mixtures of the corners, scaled to unit length.
    let along = if along > 0.0 {
        along / (1.0 - 0.5 * chord * chord)
    } else {
        along
    };
    let square = off.norm_squared() + sphere.radius * (sphere.radius + 2.0 * along);
    fmax(square, 0.0).sqrt()
}
