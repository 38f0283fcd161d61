//! A packed collar as a gingiva in the world: tree, tissue model and skin.

use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, Site, ToothFrame};
use sulcus_core::{Node, Sphere, SphereTree, TreeError};

use crate::anatomy::arch::{to_world, turned};
use crate::anatomy::collar::{Collar, Packed, pack, skin};
use crate::anatomy::patient::ToothChart;
use crate::mesh::TriMesh;

/// Number of angles of the margin.
const ANGLES: usize = 128;
/// Radius of spheres that replace several leaves, as a multiple of the leaves' radius.
///
/// Coarse spheres lie inside the tissue, so a coarse level never closes the pocket.
const COARSE: f64 = 1.3;

/// A gingiva in the world, metres.
pub(crate) struct PlacedGingiva {
    pub tree: SphereTree,
    pub model: Gingiva,
    pub mesh: TriMesh,
}

/// Lays out a collar and places it in the world.
pub(crate) fn placed_gingiva(
    collar: &Collar,
    chart: &ToothChart,
    params: GingivaParams,
    frame: &ToothFrame,
) -> Result<PlacedGingiva, TreeError> {
    let packed = pack(collar);
    let tree = tree(&packed)?;
    let level = tree.depth();
    let leaf_of = |sphere: &Sphere| packed.iter().find(|packed| packed.sphere == *sphere);
    let mut places = Vec::with_capacity(tree.nodes().len());
    for node in tree.nodes() {
        // A coarser node has the place of its nearest leaf; it does not yield.
        let leaf = leaf_of(&node.sphere()).unwrap_or_else(|| {
            let off = |p: &Packed| (p.sphere.centre - node.centre).norm();
            packed.iter().fold(
                &packed[0],
                |best, p| if off(p) < off(best) { p } else { best },
            )
        });
        places.push(Place {
            away: turned(frame, &leaf.away),
            on_surface: to_world(frame, &leaf.on_surface),
            spread: if leaf.floor {
                0.0
            } else {
                spread(&packed, leaf)
            },
            height: leaf.height,
            floor: leaf.floor,
        });
    }
    let nodes = tree.nodes().iter().map(|node| Node {
        centre: to_world(frame, &node.centre),
        ..*node
    });
    let sites = Site::ALL.map(|site| Prescribed {
        depth: chart.depth_mm.of(site) * 1e-3,
        recession: chart.recession_mm.of(site) * 1e-3,
        bleeds: chart.bleeding.of(site),
    });
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / ANGLES as f64;
    let model = Gingiva {
        params,
        tooth: *frame,
        margin: (0..ANGLES)
            .map(|k| collar.sulcus.margin(angle(k)) * 1e-3)
            .collect(),
        proximal: collar.sulcus.proximal(),
        sites,
        places,
        level,
    };
    Ok(PlacedGingiva {
        tree: SphereTree::with_bounds(nodes.collect())?,
        model,
        mesh: placed_mesh(&skin(collar), frame),
    })
}

/// Returns the length of wall of a sphere: the distance to the nearest other one on the pocket's surface.
fn spread(packed: &[Packed], leaf: &Packed) -> f64 {
    let others = packed.iter().filter(|other| !std::ptr::eq(*other, leaf));
    let nearest = others.fold(f64::INFINITY, |nearest, other| {
        nearest.min((other.on_surface - leaf.on_surface).norm())
    });
    if nearest.is_finite() {
        nearest.min(0.1)
    } else {
        0.0
    }
}

fn tree(packed: &[Packed]) -> Result<SphereTree, TreeError> {
    let leaves: Vec<Sphere> = packed.iter().map(|packed| packed.sphere).collect();
    let tree = SphereTree::over_leaves(&leaves)?;
    let mean = leaves.iter().map(|leaf| leaf.radius).sum::<f64>() / leaves.len() as f64;
    let nodes = tree.nodes().iter().map(|node| {
        let mut node = *node;
        if node.children > 0 {
            node.contact_radius = COARSE * mean;
        }
        node
    });
    SphereTree::with_bounds(nodes.collect())
}

/// Returns a mesh of a tooth's frame in the world. A frame of the right side turns the mesh inside out, so its
/// triangles are reversed.
pub(crate) fn placed_mesh(mesh: &TriMesh, frame: &ToothFrame) -> TriMesh {
    let mirrored = frame.mesial.cross(&frame.buccal).dot(&frame.axis) < 0.0;
    TriMesh {
        vertices: mesh.vertices.iter().map(|v| to_world(frame, v)).collect(),
        triangles: mesh
            .triangles
            .iter()
            .map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
            .collect(),
    }
}
