//! Core of the simulation: one haptic tick.
//!
//! Every object is a set of spheres with a compliance. A small problem per tick, with six unknowns per tool, gives the
//! pose of the tool; the multipliers of the problem are the contact forces. Unlike the paper, the optimisation includes
//! the compliance of the tissue.
//!
//! Paper: Wang, Shi, Liu, Zhang and Xiao, *Haptic Simulation of Organ Deformation and Hybrid Contacts in Dental
//! Operations*, IEEE Transactions on Haptics 2014, doi:10.1109/TOH.2014.2304734.
//!
//! # Invariants
//! - The core has no clock, no I/O, no randomness and no hash-map iteration. A tick allocates nothing. Exception: the
//!   `clarabel` solver allocates, and reads a clock for its own statistics, which never affects a result.
//! - Same [`Scene`], same [`State`], same [`TickInput`]: same bits out, in debug and release.
//! - All solvers are bounded by iterations, never by time.
//!
//! # Units and frames
//! SI throughout: metres, newtons, newton-metres, radians, seconds. World frame: x anterior, y to the patient's left, z
//! up. A transform is named `a_from_b`.
//!
//! # Terms
//! - *Node*: sphere of a tree. *Family*: the children of one node. *Leaf*: node of the finest level.
//! - *Haptic pose*: pose of the hand. *Graphic pose*: pose of the displayed tool, which never penetrates.
//! - *Coupling*: spring between both poses. *Twist*: rotation from the graphic to the haptic pose. *Turn*: angle of a
//!   rotation of a tool, radians.
//! - *Working point*: origin of a tool's six unknowns. *Arm*: vector from the working point to a contact, metres.
//!   *Lever*: length of an arm. *Scaled* unknowns: unknowns times the square roots of the metric, in sqrt(J).
//! - *Gap* of two spheres: distance of the surfaces, metres, negative in penetration.
//! - *Prediction distance*: gap up to which a pair of spheres is in the contact list. A pair with a longer lever has a
//!   longer distance, because a turn moves the pair farther; see [`contact::Distance`].
//! - *Row*: one inequality of the optimisation, `gap >= 0` after the step. *Multiplier* of a row: its force, newtons.
//! - *Substep*: one contact list, one optimisation and one step. *Group*: tools that share a substep. *Exhausted*: a
//!   tick that reached the limit of substeps.
//! - *Seed*: pair of spheres whose row stands for the smooth surface around the pair. *Members*: pairs that contribute
//!   to the row. *Blended gap*: gap of a seed to the smooth surface. *Blend length* (`blend`, `kappa`): radius of the
//!   smoothing, metres. *Compatibility*: 1 for pairs on one smooth surface, 0 for pairs on opposite walls; see
//!   [`blend`].
//! - *Core* of a sphere: the sphere less its *inset*, metres. Blended gaps are gaps of cores.
//! - *Shape* or *configuration* of a tissue: displacements from rest. *Still*: at rest and untouched.
//!
//! # Example
//! A ball of 1 mm, pressed 1 mm into a rigid ball of the same size. `examples/press.rs` prints a whole second of it.
//! ```
//! use sulcus_core::{tissue::TissueModel, *};
//!
//! let ball = SphereTree::over_leaves(&[Sphere { centre: Vec3::zeros(), radius: 1e-3 }])?;
//! let tool = Tool {
//!     name: "ball".into(),
//!     tree: ball.clone(),
//!     level: 3,
//!     working_point: Vec3::zeros(),
//!     tip: Vec3::new(0.0, 0.0, -1e-3),
//!     tip_axis: -Vec3::z(),
//!     stiffness_n_per_m: 500.0,
//!     stiffness_nm_per_rad: 0.5,
//!     park: Pose::new(Vec3::new(0.0, 0.0, 0.02), Quat::identity()),
//!     bands: vec![],
//!     mesh: DisplayMesh::default(),
//! };
//! let object = Object {
//!     name: "ball".into(),
//!     fdi: 0,
//!     tree: ball,
//!     level: 3,
//!     tissue: TissueModel::Rigid,
//!     mesh: DisplayMesh::default(),
//!     carriers: vec![],
//! };
//! let scene = Scene {
//!     name: "two balls".into(),
//!     source_hash: "none".into(),
//!     params: Params::default(),
//!     tools: vec![tool],
//!     objects: vec![object],
//! };
//! let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
//! let mut input = TickInput::IDLE;
//! let mut force = 0.0;
//! // After the entry of a tool the force grows for half a second.
//! for _ in 0..600 {
//!     input.tools[0] = ToolInput::at(&Pose::new(Vec3::new(0.0, 0.0, 1e-3), Quat::identity()));
//!     force = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe).tools[0].wrench.force.z;
//! }
//! assert!((force - 0.5).abs() < 1e-3, "500 N/m times 1 mm, {force} N");
//! # Ok::<(), TreeError>(())
//! ```
//!
//! # Scope
//! No friction, no gravity, no collision between tools.

pub mod blend;
pub mod clearance;
pub mod contact;
pub mod exactly;
pub mod input;
pub mod math;
pub mod optimise;
pub mod output;
mod rows;
pub mod scene;
mod self_test;
pub mod state;
pub mod tick;
pub mod tissue;
pub mod tree;
pub mod work;

pub use exactly::exactly;
pub use input::{RawPose, TickInput, ToolInput};
pub use math::{Pose, Quat, Vec3, Wrench};
pub use output::{TickOutput, ToolOutput};
pub use scene::params::Params;
pub use scene::skin::DisplaySkin;
pub use scene::{Coupling, DisplayMesh, Object, Scene, SceneError, Tool};
pub use self_test::self_test;
pub use state::State;
pub use tick::stage::{NoProbe, Stage, StageProbe};
pub use tick::tick;
pub use tick::workspace::Workspace;
pub use tree::{Blending, Node, Sphere, SphereTree, TreeError};

/// Largest number of tools in a scene: one for each hand.
pub const MAX_TOOLS: usize = 2;

/// Length of a tick in tests that do not set another, seconds.
#[cfg(test)]
pub(crate) const TICK_S: f64 = 1e-3;
