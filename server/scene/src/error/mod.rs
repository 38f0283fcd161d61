//! Errors of a sphere tree against its mesh, in both directions. The code shares nothing with the builder except the
//! distance query.
//!
//! Two distances are measured at each level.
//!
//! - *Mesh to spheres* is `|min_i(|p - c_i| - r_i)|` over points `p` of the mesh.
//! - *Spheres to mesh* is the distance to the mesh over the exposed surface of the union of spheres, walls of its
//!   inner cavities included.
//!
//! Means, percentiles and shares are weighted by area over dense points ([`Sampling`]).
//!
//! Maxima do not depend on the points: branch and bound finds them to a fifth of a percent, and
//! [`Spread::max_at_most`] is the proven upper bound.
//!
//! Volumes are cut exactly along parallel rays on a fine grid.
//!
//! Users: `sulcus-server tree` (table, JSON, viewer) has all fields of [`LevelError`]. `max_gap_mm` of a tool
//! is part of the tolerance of the invariant "no tool is inside an object" of the hard cases. The bench of other
//! engines compares with `max_gap_mm`, `max_bulge_mm` and the mean.

mod columns;
mod exposed;
mod largest;
mod patch;
mod spread;
mod surface;
#[cfg(test)]
mod tests;
mod union;

use serde::Serialize;
use sulcus_core::math::{fmax, fmin};
use sulcus_core::{Sphere, SphereTree, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::parallel;
use crate::tree::zone::Zone;
use columns::Columns;
use exposed::{Cells, ExposedPoint};
use patch::Place;
pub use patch::zone_patch;
pub use spread::Spread;
pub use surface::{SurfacePoint, surface_points};
use union::Union;

/// Errors of one level, over the whole surface or over its part in a zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LevelError {
    /// The level.
    pub level: u8,
    /// Number of spheres of the shape at this level.
    pub spheres: usize,
    /// `|min_i(|p - c_i| - r_i)|` over points `p` of the mesh, gaps and bulges.
    pub mesh_to_spheres_mm: Spread,
    /// Distance from the exposed surface of the union of spheres to the mesh, walls of inner cavities included.
    ///
    /// In a zone only the exposed surface counts whose nearest point of the mesh is in the zone, at any distance.
    pub spheres_to_mesh_mm: Spread,
    /// The same without the walls of inner cavities, which no tool can touch. Its maximum is that of the points.
    pub outer_to_mesh_mm: Spread,
    /// Largest height of the mesh over the spheres, over the points.
    pub max_gap_mm: f64,
    /// Largest depth of a point of the mesh inside a sphere.
    pub max_bulge_mm: f64,
    /// Share of the mesh's area outside of the union, percent, without tolerance.
    pub uncovered_area_percent: f64,
    /// The same beyond some distances.
    pub uncovered_beyond: [Uncovered; 4],
    /// Share of the union's exposed area that lines cavities closed off from the outside, percent.
    pub cavity_area_percent: f64,
    /// Volumes; `None` in a zone.
    #[serde(flatten)]
    pub volume: Option<VolumeError>,
    /// Resolution of the measurement.
    pub measured: Measured,
}

/// Volume of the union of spheres compared with that of the mesh, percent of the mesh's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VolumeError {
    /// Volume of the union minus that of the mesh.
    pub volume_error_percent: f64,
    /// Volume of the mesh outside of the spheres, cavities included.
    pub missing_volume_percent: f64,
    /// Volume of the union outside of the mesh.
    pub excess_volume_percent: f64,
    /// Sum of missing and excess volume.
    pub symmetric_difference_percent: f64,
    /// Volume of cavities that the spheres close off from the outside.
    pub cavity_volume_percent: f64,
}

/// Area farther outside of the union than a distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Uncovered {
    /// The distance.
    pub beyond_mm: f64,
    /// Share of the mesh's area, percent.
    pub percent: f64,
}

/// Resolution of the measurement of a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Points on the mesh.
    pub mesh_points: usize,
    /// Points on each sphere, before covered ones are left out.
    pub points_per_sphere: usize,
    /// Points on the exposed surface.
    pub exposed_points: usize,
    /// Distance between the rays that measure volumes and find cavities.
    pub ray_spacing_mm: f64,
}

/// Errors in one zone, level by level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ZoneError {
    /// Name of the zone.
    pub name: String,
    /// Area of the mesh in the zone.
    pub area_mm2: f64,
    /// Its levels.
    pub levels: Vec<LevelError>,
}

/// Errors of a tree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TreeReport {
    /// Levels, coarse to fine.
    pub levels: Vec<LevelError>,
    /// Zones, in the order of the request.
    pub zones: Vec<ZoneError>,
}

/// Resolution requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Least number of points on the mesh. Every triangle has at least one, every vertex is one.
    pub mesh_points: usize,
    /// Least number of points on the mesh for each sphere.
    pub mesh_points_per_sphere: usize,
    /// Least number of points on each sphere, before covered ones are left out. The number is 20 times a power of 4.
    ///
    /// The number is larger if the number of spheres allows, with at least 100,000 points on all spheres.
    pub points_per_sphere: usize,
    /// Number of rays.
    pub rays: usize,
    /// Largest number of cells that the search for a maximum examines; at least 400 for each sphere.
    pub budget: usize,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            mesh_points: 100_000,
            mesh_points_per_sphere: 12,
            points_per_sphere: 160,
            rays: 200_000,
            budget: 2_000_000,
        }
    }
}

impl Sampling {
    /// Returns the points on each sphere. Deep in a tree only a few percent of them are exposed.
    fn on_each_of(&self, spheres: usize) -> usize {
        let more = [
            100_000_usize.div_ceil(spheres),
            (2_000_000 / spheres).min(5_120),
        ];
        self.points_per_sphere.max(more[0]).max(more[1])
    }
}

/// Distances of [`LevelError::uncovered_beyond`].
const BEYOND_MM: [f64; 4] = [0.01, 0.05, 0.1, 0.5];

/// Measures one level.
pub fn level_error(tree: &SphereTree, level: u8, distance: &MeshDistance) -> LevelError {
    Level::new(tree, level, distance, &Sampling::default()).error()
}

/// Measures every level over the whole surface and in each zone. `progress` receives each level before its
/// measurement.
pub fn measure(
    tree: &SphereTree,
    distance: &MeshDistance,
    zones: &[Zone],
    sampling: &Sampling,
    progress: &dyn Fn(u8),
) -> TreeReport {
    let places: Vec<Place> = zones
        .iter()
        .map(|zone| Place::new(distance.mesh(), zone))
        .collect();
    let mut report = TreeReport {
        levels: Vec::new(),
        zones: places
            .iter()
            .map(|place| ZoneError {
                name: place.zone.name.clone(),
                area_mm2: 1e6 * place.area(),
                levels: Vec::new(),
            })
            .collect(),
    };
    for level in 0..=tree.depth() {
        progress(level);
        let measured = Level::new(tree, level, distance, sampling);
        report.levels.push(measured.error());
        for (place, error) in places.iter().zip(&mut report.zones) {
            error.levels.push(measured.over(Some(place)));
        }
    }
    report
}

/// Returns `min_i(|p - c_i| - r_i)` at each point, metres.
///
/// For points of the mesh, positive is a gap (the surface is outside of the spheres), negative a bulge (the surface
/// is inside).
pub fn surface_error(spheres: &[Sphere], points: &[Vec3]) -> Vec<f64> {
    let union = Union::new(spheres);
    parallel::map(points.len(), |k| union.signed(&points[k]))
}

/// One level, sampled.
struct Level<'a> {
    level: u8,
    spheres: usize,
    distance: &'a MeshDistance,
    sampling: &'a Sampling,
    union: Union,
    points_per_sphere: usize,
    /// Points of the mesh and `min_i(|p - c_i| - r_i)` there. Vertices have no weight: they only start the search for
    /// the maximum.
    points: Vec<(SurfacePoint, f64)>,
    /// Exposed points and whether they line a cavity.
    exposed: Vec<(ExposedPoint, bool)>,
    columns: Columns,
}

impl<'a> Level<'a> {
    fn new(
        tree: &SphereTree,
        level: u8,
        distance: &'a MeshDistance,
        sampling: &'a Sampling,
    ) -> Self {
        let spheres: Vec<Sphere> = tree
            .shape_at(level)
            .map(|(_, node)| node.sphere())
            .collect();
        let union = Union::new(&spheres);
        let mesh = distance.mesh();
        let wanted = sampling
            .mesh_points
            .max(sampling.mesh_points_per_sphere * spheres.len());
        let mut points = surface_points(mesh, wanted);
        let vertices = mesh.vertices.iter();
        points.extend(vertices.map(|&point| SurfacePoint { point, area: 0.0 }));
        let signed = parallel::map(points.len(), |k| union.signed(&points[k].point));
        let cells = Cells::new(sampling.on_each_of(spheres.len()));
        let columns = Columns::new(union.spheres(), mesh, sampling.rays);
        let exposed = cells.exposed(&union, distance);
        let inner = columns.lining(&exposed);
        let exposed = exposed.into_iter().zip(inner).collect();
        Self {
            level,
            spheres: spheres.len(),
            distance,
            sampling,
            points_per_sphere: cells.finest(),
            points: points.into_iter().zip(signed).collect(),
            exposed,
            columns,
            union,
        }
    }

    fn error(&self) -> LevelError {
        let percent = 100.0 / self.distance.mesh().signed_volume().abs();
        let (missing, excess) = (self.columns.missing, self.columns.excess);
        LevelError {
            volume: Some(VolumeError {
                volume_error_percent: percent * (excess - missing),
                missing_volume_percent: percent * missing,
                excess_volume_percent: percent * excess,
                symmetric_difference_percent: percent * (excess + missing),
                cavity_volume_percent: percent * self.columns.cavities,
            }),
            ..self.over(None)
        }
    }

    /// Returns all errors except the volumes, over the zone or everywhere.
    fn over(&self, place: Option<&Place>) -> LevelError {
        let zone = place.map(|place| place.zone);
        let within = |p: &Vec3| zone.is_none_or(|zone| zone.contains(p));
        let kept = parallel::map(self.points.len(), |k| within(&self.points[k].0.point));
        let points: Vec<(f64, f64)> = self
            .points
            .iter()
            .zip(kept)
            .filter(|(_, kept)| *kept)
            .map(|((point, signed), _)| (*signed, point.area))
            .collect();
        let kept = parallel::map(self.exposed.len(), |k| {
            let p = &self.exposed[k].0;
            place.is_none_or(|place| place.is_nearest(&p.point, p.distance))
        });
        let exposed: Vec<&(ExposedPoint, bool)> = self
            .exposed
            .iter()
            .zip(kept)
            .filter(|(_, kept)| *kept)
            .map(|(point, _)| point)
            .collect();

        let outward = Spread::new(points.iter().map(|p| (p.0.abs(), p.1)).collect());
        let inward = Spread::new(exposed.iter().map(|p| (p.0.distance, p.0.area)).collect());
        let outer = exposed.iter().filter(|p| !p.1);
        let outer = Spread::new(outer.map(|p| (p.0.distance, p.0.area)).collect());
        let mesh = self.distance.mesh();
        let budget = self.sampling.budget.max(400 * self.spheres);
        let floor = fmax(0.0, 1e-3 * outward.max);
        let outward_max = surface::largest_over(mesh, &self.union, zone, floor, budget);
        let floor = fmax(0.0, 1e-3 * inward.max);
        // Without a point nearest to the zone there is nothing to search.
        let inward = if inward.max.is_nan() {
            inward
        } else {
            let (union, distance) = (&self.union, self.distance);
            inward.with(exposed::largest_over(union, distance, place, floor, budget))
        };

        let share = |part: f64, whole: f64| match whole > 0.0 {
            true => fmin(100.0 * part / whole, 100.0),
            false => 0.0,
        };
        let area: f64 = points.iter().map(|p| p.1).sum();
        let uncovered = |beyond: f64| {
            let out = points.iter().filter(|p| p.0 > beyond);
            share(out.fold(0.0, |sum, p| sum + p.1), area)
        };
        let extreme = |sign: f64| points.iter().fold(0.0, |most, p| fmax(most, sign * p.0));
        let exposed_area: f64 = exposed.iter().map(|p| p.0.area).sum();
        let inner = exposed.iter().filter(|p| p.1);
        let inner = inner.fold(0.0, |sum, p| sum + p.0.area);
        LevelError {
            level: self.level,
            spheres: self.spheres,
            mesh_to_spheres_mm: outward.with(outward_max),
            spheres_to_mesh_mm: inward,
            outer_to_mesh_mm: outer,
            max_gap_mm: 1e3 * extreme(1.0),
            max_bulge_mm: 1e3 * extreme(-1.0),
            uncovered_area_percent: uncovered(0.0),
            uncovered_beyond: BEYOND_MM.map(|beyond_mm| Uncovered {
                beyond_mm,
                percent: uncovered(1e-3 * beyond_mm),
            }),
            cavity_area_percent: share(inner, exposed_area),
            volume: None,
            measured: Measured {
                mesh_points: points.len(),
                points_per_sphere: self.points_per_sphere,
                exposed_points: exposed.len(),
                ray_spacing_mm: 1e3 * self.columns.step,
            },
        }
    }
}
