//! The two coarsest levels of an object that deforms as a whole.
//!
//! Balls fitted to a surface have their centres near its medial sheet, for an ellipsoid on its middle plane. A
//! skeleton of springs needs nodes through the depth and a bottom layer to be fixed.
//!
//! Levels 1 and 2 therefore divide the *volume*. The finer levels are fitted to the surface below them.

use sulcus_core::{Sphere, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::Sample;
use crate::parallel;
use crate::random::Random;
use crate::tree::cluster::{Feature, split};
use crate::tree::nearest_sphere::NearestSphere;

/// Approximate number of points of the grid that fills the solid.
const POINTS: f64 = 24_000.0;
/// Largest number of tested points of the box. A solid that fills less of it is too thin for layers.
const MOST_POINTS: f64 = 4e6;
/// Number of attempts at dividing a cell.
const TRIES: u64 = 6;
/// Share of the mean number of samples below which a cell is inner. Inner cells have no children.
const INNER: f64 = 0.25;

/// A cell: a ball of the cell's volume at its middle, inside the solid.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    pub sphere: Sphere,
    /// Whether it hardly reaches the surface.
    pub inner: bool,
    points: Vec<u32>,
}

/// A cell of level 1 with its cells of level 2.
#[derive(Clone, Debug)]
pub(crate) struct Family {
    pub sphere: Sphere,
    pub cells: Vec<Cell>,
}

/// Returns the points of a regular grid inside the solid, metres.
pub(crate) fn inner_points(distance: &MeshDistance) -> Vec<Vec3> {
    let (low, high) = distance.mesh().bounds();
    let size: Vec3 = high - low;
    let step = libm::cbrt(distance.mesh().signed_volume() / POINTS);
    let counts = size.map(|x| x / step + 1.0);
    if counts.x * counts.y * counts.z > MOST_POINTS {
        return Vec::new();
    }
    let counts = counts.map(|count| count as usize);
    let total = counts.x * counts.y * counts.z;
    let at = |k: usize| {
        let (x, y, z) = (
            k % counts.x,
            k / counts.x % counts.y,
            k / (counts.x * counts.y),
        );
        low + Vec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5) * step
    };
    let inside = parallel::map(total, |k| distance.signed(&at(k)) < 0.0);
    (0..total).filter(|&k| inside[k]).map(at).collect()
}

/// Returns the cells of level 1, each with its cells of level 2; none if the solid is too thin for a grid.
pub(crate) fn cells(distance: &MeshDistance, samples: &[Sample]) -> Vec<Family> {
    let points = inner_points(distance);
    if points.len() < 64 {
        return Vec::new();
    }
    let one = distance.mesh().signed_volume() / points.len() as f64;
    let all: Vec<u32> = (0..points.len() as u32).collect();
    let mut families: Vec<Family> = shared_out(distance, &points, &all, one, 1)
        .into_iter()
        .enumerate()
        .map(|(k, cell)| Family {
            sphere: cell.sphere,
            cells: shared_out(distance, &points, &cell.points, one, 2 + k as u64),
        })
        .collect();
    let spheres: Vec<Sphere> = families
        .iter()
        .flat_map(|family| family.cells.iter().map(|cell| cell.sphere))
        .collect();
    let index = NearestSphere::new(&spheres);
    let nearest = parallel::map(samples.len(), |s| index.nearest(&samples[s].point, None).1);
    let mut counts = vec![0_usize; spheres.len()];
    for k in nearest {
        counts[k as usize] += 1;
    }
    let few = INNER * samples.len() as f64 / spheres.len() as f64;
    let cells = families.iter_mut().flat_map(|family| &mut family.cells);
    for (cell, count) in cells.zip(counts) {
        cell.inner = (count as f64) < few;
    }
    families
}

/// Returns up to eight cells of about the same volume.
fn shared_out(
    distance: &MeshDistance,
    points: &[Vec3],
    members: &[u32],
    volume: f64,
    seed: u64,
) -> Vec<Cell> {
    let features: Vec<Feature> = members
        .iter()
        .map(|&m| {
            let p = points[m as usize];
            [p.x, p.y, p.z, 0.0, 0.0, 0.0]
        })
        .collect();
    let weights = vec![1.0; members.len()];
    let mut best = (f64::INFINITY, Vec::new());
    for attempt in 0..TRIES {
        let mut random = Random::new(seed * 1000 + attempt);
        let cells: Vec<Cell> = split(&features, &weights, 8, &mut random)
            .into_iter()
            .map(|part| {
                let own: Vec<u32> = part.iter().map(|&k| members[k as usize]).collect();
                ball_of(distance, points, own, volume)
            })
            .collect();
        let spread: f64 = cells
            .iter()
            .flat_map(|cell| {
                cell.points
                    .iter()
                    .map(|&p| (points[p as usize] - cell.sphere.centre).norm_squared())
            })
            .sum();
        if spread < best.0 {
            best = (spread, cells);
        }
    }
    best.1
}

fn ball_of(distance: &MeshDistance, points: &[Vec3], own: Vec<u32>, volume: f64) -> Cell {
    let mean = own.iter().map(|&k| points[k as usize]).sum::<Vec3>() / own.len() as f64;
    // The middle of a bent cell may lie outside. Then the nearest of its points is taken.
    let mut centre = points[own[0] as usize];
    if distance.signed(&mean) < 0.0 {
        centre = mean;
    } else {
        for &k in &own {
            let p = points[k as usize];
            if (p - mean).norm_squared() < (centre - mean).norm_squared() {
                centre = p;
            }
        }
    }
    let depth = -distance.signed(&centre);
    let whole = libm::cbrt(0.75 * volume * own.len() as f64 / std::f64::consts::PI);
    Cell {
        sphere: Sphere {
            centre,
            radius: whole.min(depth).max(1e-2 * whole),
        },
        points: own,
        inner: false,
    }
}
