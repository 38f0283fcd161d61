//! How far a sphere tree is from the mesh it stands for, measured both ways by code that shares
//! nothing with the builder but the distance query.
//!
//! What is measured, level by level, is fixed: *mesh to spheres* is `|min_i(|p - c_i| - r_i)|` over
//! points `p` of the mesh, *spheres to mesh* the distance to the mesh over the exposed surface of
//! the union of spheres, walls of its inner cavities included.
//!
//! Means, percentiles and shares are weighted by area over dense points (see [`Sampling`]). Maxima
//! are not left to the points: both distances change by no more than the way gone, so branch and bound
//! finds the largest value with certainty, to a fifth of a percent; [`Spread::max_at_most`] is the proven
//! upper bound. Volumes are cut exactly along parallel rays on a fine grid.

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
pub(crate) use columns::union_volume;
use exposed::{Cells, ExposedPoint};
use patch::Place;
pub use patch::zone_patch;
pub use spread::Spread;
pub use surface::{SurfacePoint, surface_points};
use union::Union;

/// Errors of one level, over the whole surface or over the part of it that is in a zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LevelError {
    /// The level.
    pub level: u8,
    /// Spheres that are the shape at this level.
    pub spheres: usize,
    /// `|min_i(|p - c_i| - r_i)|` over points `p` of the mesh: gaps and bulges alike.
    pub mesh_to_spheres_mm: Spread,
    /// Distance from the exposed surface of the union of spheres to the mesh, walls of inner
    /// cavities included. In a zone: from the exposed surface whose nearest point of the mesh is in the
    /// zone, however far that is.
    pub spheres_to_mesh_mm: Spread,
    /// The same without the walls of inner cavities, which nothing can touch. Its maximum is that of
    /// the points.
    pub outer_to_mesh_mm: Spread,
    /// How far the mesh sticks out of the spheres at most, over the points.
    pub max_gap_mm: f64,
    /// How deep a point of the mesh is inside a sphere at most.
    pub max_bulge_mm: f64,
    /// Share of the mesh's area outside of the union, percent; nothing is forgiven.
    pub uncovered_area_percent: f64,
    /// The same for what is farther out than some distances.
    pub uncovered_beyond: [Uncovered; 4],
    /// Share of the union's exposed area that lines cavities closed off from the outside, percent.
    pub cavity_area_percent: f64,
    /// Volumes; none in a zone.
    #[serde(flatten)]
    pub volume: Option<VolumeError>,
    /// How finely all this was measured.
    pub measured: Measured,
}

/// Volume of the union of spheres against that of the mesh, percent of the mesh's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VolumeError {
    /// Volume of the union minus that of the mesh.
    pub volume_error_percent: f64,
    /// Volume of the mesh that no sphere fills; cavities in it are part of it.
    pub missing_volume_percent: f64,
    /// Volume of the union outside of the mesh.
    pub excess_volume_percent: f64,
    /// Missing and excess volume together.
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

/// How finely a level was measured.
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
    /// Zones, in the order asked for.
    pub zones: Vec<ZoneError>,
}

/// How finely to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Least number of points on the mesh. Every triangle has at least one, every vertex is one.
    pub mesh_points: usize,
    /// Least number of points on the mesh for each sphere.
    pub mesh_points_per_sphere: usize,
    /// Least number of points on each sphere, before covered ones are left out; where the number of
    /// spheres allows, it is more (at least 100,000 on all together). It is 20 times a power of 4.
    pub points_per_sphere: usize,
    /// Number of rays.
    pub rays: usize,
    /// Most cells that the search for a maximum examines; at least 400 for each sphere.
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
    /// Points on each of so many spheres. Deep in a tree all but a few percent of them are covered.
    fn on_each_of(&self, spheres: usize) -> usize {
        let more = [
            100_000_usize.div_ceil(spheres),
            (2_000_000 / spheres).min(5_120),
        ];
        self.points_per_sphere.max(more[0]).max(more[1])
    }
}

/// Distances for which [`LevelError::uncovered_beyond`] is told.
const BEYOND_MM: [f64; 4] = [0.01, 0.05, 0.1, 0.5];

/// Measures every level of `tree` against the mesh in `distance` (same frame).
pub fn tree_errors(tree: &SphereTree, distance: &MeshDistance) -> Vec<LevelError> {
    measure(tree, distance, &[], &Sampling::default(), &|_| {}).levels
}

/// Measures one level.
pub fn level_error(tree: &SphereTree, level: u8, distance: &MeshDistance) -> LevelError {
    Level::new(tree, level, distance, &Sampling::default()).error()
}

/// Measures every level over the whole surface and in each zone. `progress` gets the level that
/// comes next.
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

/// `min_i(|p - c_i| - r_i)` at each point, metres. Points of the mesh: positive is a gap (the surface
/// sticks out of the spheres), negative a bulge (the spheres stick out of the surface).
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
    /// Points of the mesh and `min_i(|p - c_i| - r_i)` there. Vertices weigh nothing: they only
    /// start the search for the maximum.
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

    /// All but the volumes, over the zone or everywhere.
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
        // Where none of all these points is nearest to the zone there is nothing to search for.
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
