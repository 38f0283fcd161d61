//! Carriers of the skin: the leaf with which each vertex moves.

use sulcus_core::{Sphere, SphereTree, Vec3};

use crate::parallel;
use crate::tree::nearest_sphere::NearestSphere;

/// Returns the finest sphere of `tree` whose surface is nearest to each of `vertices` (metres, the tree's frame), as
/// the index of its node.
pub fn carriers(tree: &SphereTree, vertices: &[Vec3]) -> Vec<u32> {
    let (ids, spheres): (Vec<u32>, Vec<Sphere>) = tree
        .shape_at(tree.depth())
        .map(|(id, node)| (id, node.sphere()))
        .unzip();
    let index = NearestSphere::new(&spheres);
    parallel::map(vertices.len(), |v| {
        // The nearest surface decides, also inside: the deepest sphere does not always make the surface there.
        ids[index.nearest(&vertices[v], None).1 as usize]
    })
}

/// Returns the vertices of each node, from the carrier of each vertex: `vertices[first[node]..first[node + 1]]`,
/// ascending.
pub fn carried(carriers: &[u32], nodes: usize) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0_u32; nodes + 1];
    for &node in carriers {
        first[node as usize + 1] += 1;
    }
    for node in 0..nodes {
        first[node + 1] += first[node];
    }
    let (mut next, mut vertices) = (first.clone(), vec![0; carriers.len()]);
    for (vertex, &node) in carriers.iter().enumerate() {
        vertices[next[node as usize] as usize] = vertex as u32;
        next[node as usize] += 1;
    }
    (first, vertices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::ellipsoid;
    use crate::tree::build::{TreeOptions, build_tree};

    #[test]
    fn every_vertex_is_carried_once_by_a_leaf_that_touches_it() {
        let mesh = ellipsoid(Vec3::new(6e-3, 4e-3, 2.5e-3), 3);
        let options = TreeOptions {
            levels: 2,
            samples: 5000,
            ..TreeOptions::default()
        };
        let tree = build_tree(&mesh, &options, &|_, _| ()).expect("a tree");
        let carriers = carriers(&tree, &mesh.vertices);
        let nodes = tree.nodes();
        for (vertex, &node) in mesh.vertices.iter().zip(&carriers) {
            let node = &nodes[node as usize];
            assert_eq!(node.children, 0);
            assert!(((vertex - node.centre).norm() - node.contact_radius).abs() < 0.3e-3);
        }
        let (first, vertices) = carried(&carriers, nodes.len());
        assert_eq!(vertices.len(), mesh.vertices.len());
        for node in 0..nodes.len() {
            for &vertex in &vertices[first[node] as usize..first[node + 1] as usize] {
                assert_eq!(carriers[vertex as usize] as usize, node);
            }
        }
        // Every leaf lies at the surface of this solid and carries a part of it.
        let leaves = tree.shape_at(2).count();
        let with = (0..nodes.len())
            .filter(|&n| first[n + 1] > first[n])
            .count();
        assert_eq!(with, leaves);
    }
}
