//! An organ as its finite elements give it: surface, what is held, the sphere tree and the skin over it.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, bail};

use sulcus_core::math::Mat3;
use sulcus_core::tissue::skeleton::Skeleton;
use sulcus_core::{DisplaySkin, SphereTree, Vec3};
use sulcus_fem::TetMesh;
use sulcus_fem::files::read_mesh;
use sulcus_program::PathText;
use sulcus_scene::cache::kept_or_built;
use sulcus_scene::default_cache_dir;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::check;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::organ::skeleton::{SkeletonOptions, skeleton_held};
use sulcus_scene::tree::build::TreeOptions;

/// Finest level of the tree, the one in contact.
pub(crate) const LEVEL: u8 = 3;

/// Where held tissue is looked for about a node.
const DIRECTIONS: [[f64; 3]; 7] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

/// A face of the surface, by nodes of the finite elements: three corners and the middles between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) corners: [u32; 3],
    pub(crate) middles: [u32; 3],
}

/// An organ. Lengths in metres, the frame that of its files.
pub(crate) struct Organ {
    /// Its finite elements.
    pub(crate) elements: TetMesh,
    /// The faces of its surface.
    pub(crate) faces: Vec<Face>,
    /// The surface as triangles of corner nodes.
    pub(crate) surface: TriMesh,
    /// For each vertex of the surface its node in the finite elements.
    pub(crate) nodes: Vec<u32>,
    /// For each node of the finite elements its vertex of the surface.
    pub(crate) vertex_of: BTreeMap<u32, usize>,
    /// Vertices of the surface that are not held: where models are judged.
    pub(crate) free: Vec<usize>,
    /// Sphere tree of the surface.
    pub(crate) tree: SphereTree,
    /// The surface over the tree's spheres.
    pub(crate) skin: DisplaySkin,
}

impl Organ {
    /// Reads the mesh of a folder and builds its tree, or takes that from the cache.
    ///
    /// # Errors
    /// If a file cannot be read or its surface is no solid.
    pub(crate) fn read(folder: &Path, progress: &dyn Fn(&str, f64)) -> anyhow::Result<Self> {
        progress("reading the mesh", 0.0);
        let part = folder.shown().to_string();
        Self::of(read_mesh(folder)?, &part, |surface| {
            let options = TreeOptions {
                levels: LEVEL,
                volumetric: true,
                ..TreeOptions::default()
            };
            kept_or_built(surface, &options, default_cache_dir().as_deref(), progress)
                .with_context(|| format!("{part}: cannot build the sphere tree"))
        })
    }

    /// The organ of these elements, which errors call `part`; `tree` gives the tree for their surface.
    ///
    /// # Errors
    /// If their surface is no solid, all of it is held, or there is no tree.
    pub(crate) fn of(
        elements: TetMesh,
        part: &str,
        tree: impl FnOnce(&TriMesh) -> anyhow::Result<SphereTree>,
    ) -> anyhow::Result<Self> {
        let faces = elements.boundary_faces().into_iter();
        let faces: Vec<Face> = faces
            .map(|[a, b, c, middles @ ..]| Face {
                corners: [a, b, c],
                middles,
            })
            .collect();
        // In the order in which the triangles name them: so a scene numbers the vertices of a file, and its tree is the same.
        let (mut vertex_of, mut nodes) = (BTreeMap::new(), Vec::new());
        for node in faces.iter().flat_map(|face| face.corners) {
            vertex_of.entry(node).or_insert_with(|| {
                nodes.push(node);
                nodes.len() - 1
            });
        }
        let surface = TriMesh {
            vertices: nodes
                .iter()
                .map(|&node| elements.nodes[node as usize])
                .collect(),
            triangles: faces
                .iter()
                .map(|face| face.corners.map(|node| vertex_of[&node] as u32))
                .collect(),
        };
        check(&surface, part)?;
        let free: Vec<usize> = (0..nodes.len())
            .filter(|&v| elements.held[nodes[v] as usize] != [true; 3])
            .collect();
        if free.is_empty() {
            bail!(
                "{part}: all {} vertices of the surface are held, expected some that can move",
                nodes.len()
            );
        }
        let tree = tree(&surface)?;
        let centres: Vec<(u32, Vec3)> = tree
            .shape_at(LEVEL)
            .map(|(id, node)| (id, node.centre))
            .collect();
        let skin = DisplaySkin::new(&centres, &surface.vertices);
        Ok(Self {
            elements,
            faces,
            surface,
            nodes,
            vertex_of,
            free,
            tree,
            skin,
        })
    }

    /// The surface with its vertices displaced by `by`, metres; at rest without displacements.
    pub(crate) fn moved(&self, by: &[Vec3]) -> MeshDistance {
        let mut mesh = self.surface.clone();
        mesh.vertices.iter_mut().zip(by).for_each(|(v, u)| *v += u);
        MeshDistance::new(mesh)
    }

    /// The skeleton of the tree. Fixed are the nodes whose sphere reaches held tissue, along any axis: the nodes are coarse,
    /// and one beside what is held would give way with its neighbours.
    ///
    /// # Errors
    /// If nothing is fixed or free, or a node hangs on nothing.
    pub(crate) fn skeleton(&self, options: &SkeletonOptions) -> anyhow::Result<Skeleton> {
        let held = |place: &Vec3| {
            let own = self
                .tree
                .nodes()
                .iter()
                .filter(|node| node.centre == *place);
            let radius = own.map(|node| node.contact_radius).fold(0.0, f64::max);
            let towards = DIRECTIONS.iter().map(|d| place + Vec3::from(*d) * radius);
            towards.into_iter().any(|at| self.held_at(&at) > 0.5)
        };
        Ok(skeleton_held(
            &self.tree,
            &self.surface,
            options,
            &|place, _| held(place),
        )?)
    }

    /// How much of the tissue about a place is held, 0 to 1; beside the organ as at its nearest corner.
    fn held_at(&self, place: &Vec3) -> f64 {
        let all = &self.elements;
        let held = |node: u32| f64::from(u8::from(all.held[node as usize] == [true; 3]));
        for tet in &all.tets {
            let c: [Vec3; 4] = std::array::from_fn(|k| all.nodes[tet[k] as usize]);
            let edges = Mat3::from_columns(&[c[1] - c[0], c[2] - c[0], c[3] - c[0]]);
            let Some(l) = edges
                .try_inverse()
                .map(|back| -> Vec3 { back * (place - c[0]) })
            else {
                continue;
            };
            let first = 1.0 - l.sum();
            if first >= -1e-9 && l.iter().all(|l| *l >= -1e-9) {
                return first * held(tet[0]) + (0..3).map(|k| l[k] * held(tet[k + 1])).sum::<f64>();
            }
        }
        let away = |node: &&u32| (all.nodes[**node as usize] - place).norm_squared();
        let nearest = self.nodes.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.map_or(0.0, |node| held(*node))
    }
}
