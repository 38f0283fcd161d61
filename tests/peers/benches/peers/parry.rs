//! parry3d as far as it goes: the contacts of the hand's capsule with the mesh. A query, not an engine: nothing answers it, so
//! that the tool is shown where the hand is.

use std::rc::Rc;

use rapier3d::math::{Pose as Placed, Rotation, Vector};
use rapier3d::parry::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
};
use rapier3d::parry::shape::{Capsule as Shape, TriMesh};
use sulcus_core::{Pose, Vec3};
use sulcus_scene::mesh::TriMesh as Mesh;

use crate::capsule::{Capsule, HALF};
use crate::engine::{Engine, Shown};
use crate::rapier::mm;

/// How far ahead it looks, mm: as the engine above it does.
const AHEAD: f32 = 0.02;

/// A capsule before a mesh, in millimetres.
pub struct Parry {
    mesh: Rc<TriMesh>,
    capsule: Shape,
    manifolds: Vec<ContactManifold<(), ()>>,
    workspace: Option<ContactManifoldsWorkspace>,
    hand: Pose,
    placed: Placed,
}

/// The mesh as parry has it.
pub fn mesh(mesh: &Mesh) -> TriMesh {
    let vertices = mesh.vertices.iter().map(mm).collect();
    TriMesh::new(vertices, mesh.triangles.clone()).expect("a closed mesh")
}

impl Parry {
    /// Before the first query.
    pub fn new(capsule: &Capsule, mesh: &Rc<TriMesh>, hand: &Pose) -> Self {
        Self {
            mesh: Rc::clone(mesh),
            capsule: Shape::new_y((HALF * 1e3) as f32, (capsule.radius * 1e3) as f32),
            manifolds: Vec::new(),
            workspace: None,
            hand: *hand,
            placed: Placed::IDENTITY,
        }
    }
}

impl Engine for Parry {
    fn aim(&mut self, hand: &Pose) {
        let q = hand.orientation.coords.map(|x| x as f32);
        let turned = Rotation::from_xyzw(q.x, q.y, q.z, q.w);
        let place: Vector = mm(&hand.position);
        self.placed = Placed::from_parts(place, turned);
        self.hand = *hand;
    }

    fn step(&mut self) {
        let dispatcher = DefaultQueryDispatcher;
        let (mesh, capsule) = (self.mesh.as_ref(), &self.capsule);
        let (manifolds, workspace) = (&mut self.manifolds, &mut self.workspace);
        dispatcher
            .contact_manifolds(&self.placed, mesh, capsule, AHEAD, manifolds, workspace)
            .expect("a mesh and a capsule are supported");
    }

    fn shown(&self) -> Shown {
        Shown {
            pose: self.hand,
            force: Vec3::zeros(),
        }
    }
}
