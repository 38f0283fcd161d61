//! rapier3d as an engine: a dynamic capsule that an explicit, damped spring draws after the hand.
//!
//! Its numbers are single precision and its tolerances absolute: in metres its soft body lets the tool in by millimetres, so
//! that its world is in millimetres, kilograms and seconds (forces in millinewtons, moduli in kilopascals; N/m stay N/m).

use rapier3d::prelude::{
    CoefficientCombineRule, Collider, ColliderBuilder, MassProperties, PhysicsWorld, RigidBody,
    RigidBodyBuilder, RigidBodyHandle, SoftBody, SoftBodyHandle, Vector,
};
use sulcus_core::math::{log_rotation, normalised};
use sulcus_core::{Pose, Vec3};

use crate::TICK_S;
use crate::capsule::{Capsule, HALF, STIFFNESS};
use crate::engine::{Engine, Shown};

/// Mass of the capsule, kg: a handle's.
const MASS: f64 = 0.05;
/// Its moment of inertia about any axis, kg m2: that of a rod of this mass and length. (About its own axis a thin one has so
/// little that an explicit spring is unstable.)
const INERTIA: f64 = MASS * 4.0 * HALF * HALF / 12.0;
/// Millimetres in a metre.
const MM: f64 = 1e3;

/// A vector of metres or metres per second, in millimetres.
pub fn mm(v: &Vec3) -> Vector {
    let [x, y, z] = [v.x, v.y, v.z].map(|x| (x * MM) as f32);
    Vector::new(x, y, z)
}

/// And back.
fn metres(v: Vector) -> Vec3 {
    Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z)) / MM
}

/// A point of the surface of a soft body: three of its particles, and how much each counts.
pub type Carried = ([usize; 3], [f64; 3]);

/// A world with a capsule in it.
pub struct Rapier {
    /// The world, to put something into.
    pub world: PhysicsWorld,
    /// The soft body, and its surface points.
    pub soft: Option<(SoftBodyHandle, Vec<Carried>)>,
    tool: RigidBodyHandle,
    capsule: Capsule,
    hand: Pose,
}

/// A collider without friction or mass, as ours has none.
pub fn smooth(collider: ColliderBuilder) -> ColliderBuilder {
    collider
        .friction(0.0)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .density(0.0)
}

impl Rapier {
    /// A capsule at rest where the hand begins, so many iterations (4 unless asked otherwise), and what the engine is told is a
    /// unit of length, mm: its tolerances and distances of prediction are multiples of it.
    pub fn new(capsule: &Capsule, hand: &Pose, iterations: usize, length_unit: f32) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = TICK_S as f32;
        world.integration_parameters.min_ccd_dt = TICK_S as f32 / 100.0;
        world.integration_parameters.length_unit = length_unit;
        world.integration_parameters.num_solver_iterations = iterations;
        let turning = Vector::splat((INERTIA * MM * MM) as f32);
        let q = hand.orientation.coords.map(|x| x as f32);
        let body = RigidBodyBuilder::dynamic()
            .additional_mass_properties(MassProperties::new(Vector::ZERO, MASS as f32, turning))
            .translation(mm(&hand.position))
            .can_sleep(false);
        let mut body: RigidBody = body.build();
        let turned = rapier3d::math::Rotation::from_xyzw(q.x, q.y, q.z, q.w);
        body.set_rotation(turned, true);
        body.lock_rotations(capsule.turning.is_none(), true);
        let (half, radius) = ((HALF * MM) as f32, (capsule.radius * MM) as f32);
        let shape: Collider = smooth(ColliderBuilder::capsule_y(half, radius)).build();
        let (tool, _) = world.insert(body, shape);
        Self {
            world,
            soft: None,
            tool,
            capsule: *capsule,
            hand: *hand,
        }
    }

    fn pose(&self) -> Pose {
        let body = &self.world.bodies[self.tool];
        let q = body.rotation();
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        Pose::new(metres(body.translation()), normalised(w, x, y, z))
    }
}

impl Engine for Rapier {
    fn aim(&mut self, hand: &Pose) {
        let now = self.pose();
        let body = &mut self.world.bodies[self.tool];
        // Critically damped against the hand's own motion, or it rings.
        let damping = 2.0 * (STIFFNESS * MASS).sqrt();
        let velocity = (hand.position - self.hand.position) / TICK_S;
        let pull = (hand.position - now.position) * STIFFNESS
            + (velocity - metres(body.linvel())) * damping;
        body.reset_forces(true);
        body.add_force(mm(&pull), true);
        if let Some(stiffness) = self.capsule.turning {
            let damping = 2.0 * (stiffness * INERTIA).sqrt();
            let turn = |to: &Pose, from: &Pose| {
                log_rotation(&(to.orientation * from.orientation.inverse()))
            };
            let spin = turn(hand, &self.hand) / TICK_S;
            // (A spin is in radians per second, whatever the length.)
            let own = metres(body.angvel()) * MM;
            let torque = turn(hand, &now) * stiffness + (spin - own) * damping;
            body.reset_torques(true);
            body.add_torque(mm(&torque) * MM as f32, true);
        }
        self.hand = *hand;
    }

    fn step(&mut self) {
        self.world.step();
    }

    fn shown(&self) -> Shown {
        let pose = self.pose();
        Shown {
            pose,
            force: (pose.position - self.hand.position) * STIFFNESS,
        }
    }

    fn skin(&self) -> f64 {
        let skins = self.world.colliders.iter();
        skins
            .map(|(_, collider)| f64::from(collider.contact_skin()))
            .sum::<f64>()
            / MM
    }

    fn surface(&self, points: &mut Vec<Vec3>) {
        points.clear();
        if let Some((handle, carried)) = &self.soft {
            let body: &SoftBody = &self.world.soft_bodies[*handle];
            points.extend(carried.iter().map(|(particles, shares)| {
                let at = |k: usize| metres(body.particle_position(particles[k])) * shares[k];
                at(0) + at(1) + at(2)
            }));
        }
    }
}
