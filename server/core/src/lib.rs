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
//! # Scope
//! No friction, no gravity, no collision between tools.

pub mod blend;
pub mod contact;
pub mod exactly;
pub mod input;
pub mod math;
pub mod optimise;
pub mod output;
mod rows;
pub mod scene;
pub mod state;
pub mod tick;
pub mod tissue;
pub mod tree;

pub use exactly::exactly;
pub use input::{RawPose, TickInput, ToolInput};
pub use math::{Pose, Quat, Vec3, Wrench};
pub use output::{TickOutput, ToolOutput};
pub use scene::params::Params;
pub use scene::skin::DisplaySkin;
pub use scene::{DisplayMesh, Object, Scene, SceneError, Tool};
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
