//! The mesh against the spheres: samples for mean and percentile, a search for the maximum.
//!
//! Users: `mesh_to_spheres_mm` in the table and the JSON of `sulcus-server tree`; colours of its file for the viewer.

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, fmin, norm};

use super::largest::{Examined, Largest, largest};
use super::patch::{disc, quarters};
use super::union::Union;
use crate::mesh::TriMesh;
use crate::tree::zone::Zone;

/// A point of a surface with its share of the area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Place, metres.
    pub point: Vec3,
    /// Share of the area, square metres. The shares of all points of a mesh add up to its area.
    pub area: f64,
}

/// Returns at least `count` points on all triangles: one for each share of the area, at least one on every triangle.
///
/// Weights follow the areas of the triangles, so sums over the points are integrals over the surface for any
/// triangulation.
pub fn surface_points(mesh: &TriMesh, count: usize) -> Vec<SurfacePoint> {
    let share = mesh.area() / count as f64;
    let mut points = Vec::with_capacity(count + mesh.triangles.len());
    for triangle in 0..mesh.triangles.len() {
        let area = 0.5 * mesh.area_vector(triangle).norm();
        if area <= 0.0 {
            continue;
        }
        let [a, b, c] = mesh.corners(triangle);
        let here = (area / share).ceil().max(1.0) as usize;
        for k in 0..here {
            // The R2 sequence (Roberts), folded into the triangle. A single point is the centroid.
            let (u, v) = if here == 1 {
                (1.0 / 3.0, 1.0 / 3.0)
            } else {
                let u = (0.5 + k as f64 * 0.754_877_666_246_692_7).fract();
                let v = (0.5 + k as f64 * 0.569_840_290_998_053_2).fract();
                if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                }
            };
            points.push(SurfacePoint {
                point: a + (b - a) * u + (c - a) * v,
                area: area / here as f64,
            });
        }
    }
    points
}

/// Returns the largest `|min_i(|p - c_i| - r_i)|` over all points of the mesh in the zone.
pub(super) fn largest_over(
    mesh: &TriMesh,
    union: &Union,
    zone: Option<&Zone>,
    floor: f64,
    budget: usize,
) -> Largest {
    let roots: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
    largest(
        roots,
        floor,
        budget,
        |corners: &[Vec3; 3], _| {
            let (centre, radius) = disc(corners);
            let beyond = zone.map_or(f64::NEG_INFINITY, |zone| zone.beyond(&centre));
            if beyond > radius {
                return Examined {
                    attained: None,
                    bound: None,
                };
            }
            let (value, ball) = union.nearest(&centre);
            // A gap is at most the gap to this one ball, which is largest at a corner.
            let ball = &union.spheres()[ball];
            let gap = corners.iter().fold(f64::NEG_INFINITY, |most, corner| {
                fmax(most, norm(&(corner - ball.centre)) - ball.radius)
            });
            let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            let length = norm(&normal);
            let bulge = radius - value;
            let bulge = if bulge > floor && length > 0.0 {
                fmin(
                    bulge,
                    union.deepest_on_disc(&centre, &(normal / length), radius, floor),
                )
            } else {
                bulge
            };
            Examined {
                attained: (beyond <= 0.0).then_some(value.abs()),
                bound: Some(fmax(fmin(gap, value + radius), bulge)),
            }
        },
        |corners, _| quarters(corners),
    )
}
