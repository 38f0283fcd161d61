//! Check that every part of a mesh is held against all six rigid motions.
//!
//! The factorisation cannot detect a loose part: rounding makes its pivots small, not negative.

use sulcus_core::Vec3;

use crate::error::FemError;
use crate::mesh::TetMesh;

/// A translation and a rotation; the rotation is in units of the part's size.
type Motion = [f64; 6];

/// Share of a support's direction that must be new for the support to count.
const NEW: f64 = 1e-6;

fn dot(a: &Motion, b: &Motion) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the part of each node: the smallest index of a node that is connected to it.
fn parts(mesh: &TetMesh) -> Vec<u32> {
    let mut part: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    let root = |part: &mut Vec<u32>, mut node: u32| {
        while part[node as usize] != node {
            part[node as usize] = part[part[node as usize] as usize];
            node = part[node as usize];
        }
        node
    };
    for tet in &mesh.tets {
        let first = root(&mut part, tet[0]);
        for &node in &tet[1..] {
            let (a, b) = (root(&mut part, first), root(&mut part, node));
            part[a.max(b) as usize] = a.min(b);
        }
    }
    (0..part.len() as u32)
        .map(|node| root(&mut part, node))
        .collect()
}

/// Checks that no part of a mesh can move or rotate freely.
///
/// # Errors
/// [`FemError::Field`] with a node of a loose part.
pub fn check(mesh: &TetMesh) -> Result<(), FemError> {
    let parts = parts(mesh);
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); mesh.nodes.len()];
    for (node, part) in parts.iter().enumerate() {
        members[*part as usize].push(node);
    }
    for (first, members) in members
        .iter()
        .enumerate()
        .filter(|(_, all)| !all.is_empty())
    {
        let n = members.len() as f64;
        let centre = members.iter().map(|&k| mesh.nodes[k]).sum::<Vec3>() / n;
        let size = members
            .iter()
            .map(|&k| (mesh.nodes[k] - centre).norm())
            .fold(0.0, f64::max);
        let supports = members.iter().flat_map(|&k| {
            let arm = (mesh.nodes[k] - centre) / size;
            (0..3).filter(move |&i| mesh.held[k][i]).map(move |i| {
                let mut along = Vec3::zeros();
                along[i] = 1.0;
                let turn = arm.cross(&along);
                [along.x, along.y, along.z, turn.x, turn.y, turn.z]
            })
        });
        let mut taken: Vec<Motion> = Vec::with_capacity(6);
        for support in supports {
            let mut new = support;
            // The second pass removes rounding.
            for known in taken.iter().chain(&taken) {
                let share = dot(&new, known);
                new.iter_mut().zip(known).for_each(|(x, k)| *x -= share * k);
            }
            let length = dot(&new, &new).sqrt();
            if length > NEW {
                taken.push(new.map(|x| x / length));
            }
            if taken.len() == 6 {
                break;
            }
        }
        if taken.len() < 6 {
            let found = format!(
                "{} of 6 rigid motions of the part with node {first}",
                taken.len()
            );
            return Err(FemError::field(
                "supports that hold",
                found,
                "all six, for every part",
            ));
        }
    }
    Ok(())
}
