//! Data of a skeleton in a scene, and their validation.

use serde::{Deserialize, Serialize};

use crate::math::{Vec3, norm};
use crate::scene::params::within;
use crate::tissue::{TissueError, wrong};
use crate::tree::SphereTree;

/// Largest number of nodes of a skeleton. The inverse of its step matrix (mass, damping, stiffness) is stored dense and
/// grows with the square of this number.
pub const MAX_SKELETON_NODES: usize = 1024;
/// Number of skeleton nodes that carry a sphere.
pub const CARRIERS: usize = 4;
/// Smallest valid length of a spring, metres.
const SHORTEST_SPRING: f64 = 1e-6;

/// Organ that deforms as a whole, with a coarse skeleton and an optional fine skeleton (the paper's section 3.1). The
/// fine skeleton is for computers with enough time left in a tick. Both belong to one tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Skeleton {
    /// Skeleton at [`crate::TickInput::detail`] 0.
    pub coarse: SkeletonLevel,
    /// Skeleton at detail 1 and above; without it, the coarse skeleton at every detail.
    pub fine: Option<SkeletonLevel>,
}

/// Masses and springs on some nodes of a sphere tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkeletonLevel {
    /// Nodes of the tree that are skeleton nodes, 2 to 1024. Their rest centres are the rest of the skeleton.
    pub nodes: Vec<u32>,
    /// Whether each skeleton node is fixed.
    pub fixed: Vec<bool>,
    /// Springs between the skeleton nodes.
    pub springs: Vec<Spring>,
    /// Parameters common to all nodes.
    pub params: SkeletonParams,
    /// Carriers of each node of the tree, in the order of the tree's nodes.
    pub skin: Vec<Skin>,
}

/// Spring between two skeleton nodes. The spring resists the difference of their displacements with a symmetric 3x3
/// stiffness about the world's axes. This is the paper's Eq. 1 as a vector spring, with the sign corrected.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spring {
    /// First end: index in [`SkeletonLevel::nodes`].
    pub a: u16,
    /// Second end: index in [`SkeletonLevel::nodes`].
    pub b: u16,
    /// Stiffness along the world's x, y and z at small stretch, N/m, 1e-3 to 1e7.
    pub stiffness: [f64; 3],
    /// Stiffness between y and z, z and x, x and y, N/m: force along one axis for a change along the other. Zero for a
    /// spring with independent axes. The matrix of `stiffness` and `coupling` must be positive definite. Without
    /// coupling in any spring of a skeleton, a tick costs a third of the time.
    pub coupling: [f64; 3],
}

/// Parameters common to all nodes of a skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkeletonParams {
    /// Mass of a node, kg, 1e-7 to 10. A real tongue (1.04 g/cm3) has about 1.3 g for each of 64 nodes.
    pub mass: f64,
    /// Damping of a node's motion against the world, N s/m, 0 to 1e4: the paper's `b_c`. About 0.5 for 64 nodes keeps a
    /// soft tongue from ringing. Damping resists rigid motion too, but fixed nodes rule out rigid motion.
    pub damping: f64,
    /// Law of stiffness over stretch.
    pub law: StretchLaw,
}

/// Stiffness as a function of stretch.
///
/// The stretch `e` is the length of a spring's change in units of its rest length, with axes weighted by their
/// stiffness. Stiffness is `1 + (limit - 1) x / (1 + x)` times that at rest, with `x = (e / half)^2`.
///
/// The stretch counts the change in every direction, as Eq. 1 does. The force therefore has a potential, and no closed
/// path of a hand gains energy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StretchLaw {
    /// Ratio of the stiffness at very large stretch to that at rest, 1 (constant stiffness) to 100.
    pub limit: f64,
    /// Stretch at half of the growth of stiffness, in units of the rest length, 0.01 to 100.
    pub half: f64,
}

impl StretchLaw {
    /// Law of constant stiffness.
    pub const LINEAR: StretchLaw = StretchLaw {
        limit: 1.0,
        half: 1.0,
    };

    /// Returns the ratio of the stiffness to that at rest for `x`, the square of the stretch in units of `half`.
    #[inline]
    pub fn factor(&self, x: f64) -> f64 {
        1.0 + (self.limit - 1.0) * x / (1.0 + x)
    }

    /// Returns the steepest slope of force over displacement at any stretch, as ratio to the slope at rest. The ratio
    /// at a stretch is
    ///
    /// `1 + (limit - 1) (3 y - 2 y^2)` at `y = x / (1 + x)`. The maximum is at `y = 3/4`.
    pub fn steepest(&self) -> f64 {
        1.0 + 1.125 * (self.limit - 1.0)
    }
}

/// Carriers of a sphere of the tree. The sphere moves by the weighted mean of the displacements of its carriers. Loads
/// on the sphere go to the carriers by the same weights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Skin {
    /// Carriers, as indices in [`SkeletonLevel::nodes`].
    pub nodes: [u16; CARRIERS],
    /// Weights of the carriers, not negative, sum 1.
    pub weights: [f64; CARRIERS],
}

/// Smallest valid pivot of a spring's stiffness matrix, as a fraction of the diagonal entry.
const DEFINITE: f64 = 1e-9;

impl Spring {
    /// Returns whether the stiffness matrix is positive definite, from its pivots. A NaN in the coupling gives `false`.
    fn is_definite(&self) -> bool {
        let ([x, y, z], [yz, zx, xy]) = (self.stiffness, self.coupling);
        if self.coupling == [0.0; 3] {
            return true;
        }
        let second = y - xy * xy / x;
        let left = yz - zx * xy / x;
        let third = z - zx * zx / x - left * left / second;
        x > 0.0 && second > DEFINITE * y && third > DEFINITE * z
    }
}

impl Skeleton {
    /// Returns whether any spring couples the axes.
    pub fn couples(&self) -> bool {
        let levels = [Some(&self.coarse), self.fine.as_ref()];
        let mut springs = levels
            .into_iter()
            .flatten()
            .flat_map(|level| &level.springs);
        springs.any(|spring| spring.coupling != [0.0; 3])
    }

    /// Checks both levels against the tree.
    ///
    /// # Errors
    /// A field is invalid: the error names the field, the value found and the value expected.
    pub fn validate(&self, rest: &SphereTree) -> Result<(), TissueError> {
        self.coarse.validate(rest)?;
        self.fine
            .as_ref()
            .map_or(Ok(()), |fine| fine.validate(rest))
    }

    /// Returns the count of numbers in the state: displacements (m) and velocities (m/s) of all free nodes. With two
    /// levels the state also has the share of the fine level, 0 to 1.
    pub fn state_len(&self) -> usize {
        let fine = self.fine.as_ref().map_or(0, |fine| 6 * fine.free() + 1);
        6 * self.coarse.free() + fine
    }
}

impl SkeletonParams {
    fn validate(&self) -> Result<(), TissueError> {
        if !within(self.mass, 1e-7, 10.0) {
            return wrong("mass of a skeleton node", self.mass, "1e-7 to 10 kg");
        }
        if !within(self.damping, 0.0, 1e4) {
            return wrong("damping of a skeleton node", self.damping, "0 to 1e4 N s/m");
        }
        if !within(self.law.limit, 1.0, 100.0) {
            return wrong("limit of the stretch law", self.law.limit, "1 to 100");
        }
        if !within(self.law.half, 0.01, 100.0) {
            return wrong("half of the stretch law", self.law.half, "0.01 to 100");
        }
        Ok(())
    }
}

impl SkeletonLevel {
    /// Returns the number of free nodes.
    pub fn free(&self) -> usize {
        self.fixed.iter().filter(|fixed| !**fixed).count()
    }

    /// Checks the level against the tree.
    ///
    /// # Errors
    /// A field is invalid: the error names the field, the value found and the value expected. A free node that no
    /// springs join to a fixed node is invalid, too: the error names the node.
    pub fn validate(&self, rest: &SphereTree) -> Result<(), TissueError> {
        self.params.validate()?;
        let (n, tree) = (self.nodes.len(), rest.nodes());
        if !(2..=MAX_SKELETON_NODES).contains(&n) {
            return wrong("number of skeleton nodes", n, "2 to 1024");
        }
        if self.fixed.len() != n {
            return wrong("fixed flags of the skeleton", self.fixed.len(), n);
        }
        if self.free() == 0 || self.free() == n {
            return wrong(
                "number of free skeleton nodes",
                self.free(),
                "at least 1, and at least 1 that is fixed",
            );
        }
        if let Some(node) = self.nodes.iter().find(|&&node| node as usize >= tree.len()) {
            return wrong(
                "skeleton node",
                format!("tree node {node}"),
                format!("one of {}", tree.len()),
            );
        }
        for spring in &self.springs {
            let (a, b) = (usize::from(spring.a), usize::from(spring.b));
            if a >= n || b >= n || a == b {
                return wrong(
                    "spring of the skeleton",
                    format!("between {a} and {b}"),
                    format!("two different nodes under {n}"),
                );
            }
            let length = norm(&self.reach(spring, rest));
            if !within(length, SHORTEST_SPRING, f64::INFINITY) {
                return wrong(
                    "length of a spring",
                    format!("{length} m between {a} and {b}"),
                    "at least a micrometre",
                );
            }
            if !spring.is_definite() {
                return wrong(
                    "coupling of a spring",
                    format!("{:?} N/m between {a} and {b}", spring.coupling),
                    "so little that the stiffness is positive definite",
                );
            }
            if let Some(k) = spring.stiffness.iter().find(|k| !within(**k, 1e-3, 1e7)) {
                return wrong(
                    "stiffness of a spring",
                    format!("{k} N/m between {a} and {b}"),
                    "1e-3 to 1e7 N/m",
                );
            }
        }
        if let Some(lost) = self.lost() {
            let at: Vec3 = tree[self.nodes[lost] as usize].centre * 1e3;
            return wrong(
                "skeleton node",
                format!(
                    "{lost} at ({:.1}, {:.1}, {:.1}) mm without a way to a fixed node",
                    at.x, at.y, at.z
                ),
                "springs that lead to a fixed node",
            );
        }
        if self.skin.len() != tree.len() {
            return wrong("skin of the skeleton", self.skin.len(), tree.len());
        }
        for (k, skin) in self.skin.iter().enumerate() {
            let sum: f64 = skin.weights.iter().sum();
            if skin.weights.iter().any(|w| !within(*w, 0.0, 1.0))
                || !within(sum, 1.0 - 1e-9, 1.0 + 1e-9)
            {
                return wrong(
                    "skin weights",
                    format!("{:?} of tree node {k}", skin.weights),
                    "none negative, sum 1",
                );
            }
            if let Some(node) = skin.nodes.iter().find(|&&node| usize::from(node) >= n) {
                return wrong(
                    "skin",
                    format!("skeleton node {node} for tree node {k}"),
                    format!("one under {n}"),
                );
            }
        }
        Ok(())
    }

    /// Returns the vector from end `a` to end `b` of a spring at rest, world axes, metres.
    pub(super) fn reach(&self, spring: &Spring, rest: &SphereTree) -> Vec3 {
        let centre = |k: u16| rest.nodes()[self.nodes[usize::from(k)] as usize].centre;
        centre(spring.b) - centre(spring.a)
    }

    /// Returns a free node that springs do not join to any fixed node, as index in [`SkeletonLevel::nodes`]; `None` if
    /// there is no such node. Such a node would drift for ever.
    pub fn lost(&self) -> Option<usize> {
        let mut held = self.fixed.clone();
        loop {
            let mut more = false;
            for spring in &self.springs {
                let (a, b) = (usize::from(spring.a), usize::from(spring.b));
                if held[a] != held[b] {
                    (held[a], held[b]) = (true, true);
                    more = true;
                }
            }
            if !more {
                return held.iter().position(|held| !held);
            }
        }
    }
}
