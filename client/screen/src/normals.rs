//! Normals of vertices: sums of the area vectors of their triangles.
//!
//! Meshes of neighbouring objects meet in vertices at the same place. Such vertices share a normal, so that no seam
//! shows.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use crate::material::Material;
use crate::stage::{Moving, Part};

/// Largest distance of vertices with a common normal, mm. The grids of two meshes differ by less than 1 um.
const SAME_MM: f32 = 5e-3;

/// Sums of area vectors, and groups of vertices with a common normal.
#[derive(Default)]
pub(crate) struct Normals {
    sums: Vec<Vector3<f32>>,
    /// Differences of the sums from those of the whole mesh; empty for a whole mesh.
    missing: Vec<Vector3<f32>>,
    groups: Vec<Vec<u32>>,
    /// For each part all parts that share a normal with it, itself first.
    sharing: Vec<Vec<usize>>,
}

impl Normals {
    /// Groups of parts at rest. Flesh shares normals across parts, a tooth and a tool within the part alone.
    pub fn new(parts: &[Part], moving: &[Moving]) -> Self {
        let mut classes: Vec<Vec<u32>> = vec![Vec::new()];
        for part in parts {
            let own = part.vertices.clone().map(|v| v as u32);
            if part.material == Material::Flesh {
                classes[0].extend(own);
            } else {
                classes.push(own.collect());
            }
        }
        let groups: Vec<Vec<u32>> = classes
            .into_iter()
            .flat_map(|class| groups(class, moving))
            .collect();
        Self {
            sums: vec![Vector3::zeros(); moving.len()],
            missing: Vec::new(),
            sharing: sharing(parts, &groups),
            groups,
        }
    }

    /// Groups of vertices in one place.
    pub fn groups(&self) -> &[Vec<u32>] {
        &self.groups
    }

    /// Keeps the normals that `moving` has now, those of a whole mesh, for the mesh at rest. `corners` are those of the
    /// thinned mesh.
    pub fn keep(&mut self, parts: &[Part], corners: &[u32], moving: &mut [Moving]) {
        let whole: Vec<Vector3<f32>> = moving.iter().map(|v| v.normal.into()).collect();
        let all: Vec<usize> = (0..parts.len()).collect();
        self.update(&all, parts, corners, moving);
        let sums = self.sums.iter().zip(&whole);
        let missing = sums.map(|(sum, normal)| normal * sum.norm() - sum);
        self.missing = missing.collect();
        // A mesh that returns to rest has the same bits as now.
        self.update(&all, parts, corners, moving);
    }

    /// Writes the normals of changed parts, given by their numbers, and of vertices that share a normal with them.
    /// Returns the numbers of all parts with such vertices, in ascending order.
    pub fn update(
        &mut self,
        changed: &[usize],
        parts: &[Part],
        corners: &[u32],
        moving: &mut [Moving],
    ) -> Vec<usize> {
        for part in changed.iter().map(|k| &parts[*k]) {
            let own = part.vertices.clone();
            match self.missing.get(own.clone()) {
                Some(missing) => self.sums[own].copy_from_slice(missing),
                None => self.sums[own].fill(Vector3::zeros()),
            }
            for triangle in corners[part.corners.clone()].chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| Vector3::from(moving[triangle[k] as usize].at));
                let area = (b - a).cross(&(c - a));
                for v in triangle {
                    self.sums[*v as usize] += area;
                }
            }
            for v in part.vertices.clone() {
                moving[v].normal = unit(&self.sums[v]);
            }
        }
        for group in &self.groups {
            let sum: Vector3<f32> = group.iter().map(|v| self.sums[*v as usize]).sum();
            for v in group {
                moving[*v as usize].normal = unit(&sum);
            }
        }
        let touched: BTreeSet<usize> = changed
            .iter()
            .flat_map(|k| self.sharing[*k].iter().copied())
            .collect();
        touched.into_iter().collect()
    }
}

fn unit(v: &Vector3<f32>) -> [f32; 3] {
    v.try_normalize(0.0).unwrap_or_else(Vector3::z).into()
}

/// For each part all parts that share a group with it, itself first.
fn sharing(parts: &[Part], groups: &[Vec<u32>]) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = (0..parts.len()).map(|k| vec![k]).collect();
    let owner = |v: &u32| {
        let v = *v as usize;
        parts.iter().position(|part| part.vertices.contains(&v))
    };
    for group in groups {
        let owners: BTreeSet<usize> = group.iter().filter_map(owner).collect();
        for (a, b) in owners
            .iter()
            .flat_map(|a| owners.iter().map(move |b| (*a, *b)))
        {
            if !found[a].contains(&b) {
                found[a].push(b);
            }
        }
    }
    found
}

/// Groups of at least two vertices at one place. The search sorts along x.
fn groups(mut class: Vec<u32>, moving: &[Moving]) -> Vec<Vec<u32>> {
    let at = |v: u32| moving[v as usize].at;
    class.sort_unstable_by(|a, b| at(*a)[0].total_cmp(&at(*b)[0]).then(a.cmp(b)));
    let mut is_taken = vec![false; class.len()];
    let mut found = Vec::new();
    for k in 0..class.len() {
        if is_taken[k] {
            continue;
        }
        let own = at(class[k]);
        let mut group = vec![class[k]];
        for j in k + 1..class.len() {
            let other = at(class[j]);
            if other[0] - own[0] > SAME_MM {
                break;
            }
            let is_near =
                (other[1] - own[1]).abs() <= SAME_MM && (other[2] - own[2]).abs() <= SAME_MM;
            if is_near && !is_taken[j] {
                is_taken[j] = true;
                group.push(class[j]);
            }
        }
        if group.len() > 1 {
            found.push(group);
        }
    }
    found
}
