//! Sphere trees: the geometry of tools and objects for contact.
//!
//! A node has two radii. The *contact* radius is the shape at the node's level. The *bound* radius encloses the contact
//! spheres of the node and of all its descendants: culling is safe even where a parent's shape is tight. Trees are
//! ragged, with at most eight children per node. A childless node above the level in use is the shape at every finer
//! level.

mod blending;

pub use blending::{Blending, MIN_BLEND};
use serde::{Deserialize, Serialize};

use crate::math::{Vec3, fmax, norm};

/// Largest number of children of a node.
pub const MAX_CHILDREN: usize = 8;
/// Number of the deepest level that a tree may have; the root is level 0.
pub const MAX_LEVEL: u8 = 7;
/// Ball: centre and radius, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sphere {
    /// Centre, metres.
    pub centre: Vec3,
    /// Radius, metres.
    pub radius: f64,
}

/// Node of a tree. Nodes are stored level by level, with the children of a node side by side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Centre in the object's frame, metres.
    pub centre: Vec3,
    /// Radius of the shape at this level, metres.
    pub contact_radius: f64,
    /// Radius about `centre` that encloses the contact spheres of this node and of all its descendants, metres.
    pub bound_radius: f64,
    /// Index of the first child in the tree's list of nodes; meaningless without children.
    pub first_child: u32,
    /// Number of children, 0 to 8.
    pub children: u8,
    /// Level; 0 for the root.
    pub level: u8,
}

/// Tree of spheres in its object's frame. Immutable and always valid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct SphereTree {
    nodes: Vec<Node>,
    blending: Blending,
}

/// Stored form of a sphere tree.
#[derive(Serialize, Deserialize)]
struct Parts {
    nodes: Vec<Node>,
    blending: Blending,
}

/// Error of nodes that do not form a sphere tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TreeError {
    /// The list of nodes is empty.
    #[error("a sphere tree needs at least one node, found none")]
    Empty,
    /// A number is not finite or a radius not positive.
    #[error("node {node}: {field} is {found}, expected a finite{} number", if *.positive { " positive" } else { "" })]
    BadNumber {
        /// Index of the node.
        node: usize,
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: f64,
        /// Whether the number must be positive.
        positive: bool,
    },
    /// Children or levels do not form a tree stored level by level.
    #[error("node {node}: {what}")]
    BadStructure {
        /// Index of the node.
        node: usize,
        /// Description of the error.
        what: &'static str,
    },
    /// The bound of a node does not enclose a child's bound.
    #[error(
        "node {node}: bound radius {bound:e} m does not enclose node {inner} (needs {needed:e} m)"
    )]
    Unbounded {
        /// Index of the node.
        node: usize,
        /// Bound radius of the node, metres.
        bound: f64,
        /// Index of the child that sticks out.
        inner: usize,
        /// Bound radius required, metres.
        needed: f64,
    },
    /// Blend lengths or insets do not fit the nodes.
    #[error("{field} {index}: found {found}, expected {expected}")]
    BadBlending {
        /// Name of the list's entry, or of the list's length.
        field: &'static str,
        /// Index in the list, or the length of a list with a wrong length.
        index: usize,
        /// Value found, metres, or the length of a list with a wrong length.
        found: f64,
        /// Value expected.
        expected: &'static str,
    },
}

impl TryFrom<Parts> for SphereTree {
    type Error = TreeError;
    fn try_from(parts: Parts) -> Result<Self, TreeError> {
        SphereTree::from_nodes(parts.nodes)?.with_blending(parts.blending)
    }
}

impl From<SphereTree> for Parts {
    fn from(tree: SphereTree) -> Self {
        Parts {
            nodes: tree.nodes,
            blending: tree.blending,
        }
    }
}

impl SphereTree {
    /// Creates a tree from nodes with bounds, stored level by level, root first, siblings adjacent.
    ///
    /// # Errors
    /// A node breaks a rule; the error has the node and the rule.
    pub fn from_nodes(nodes: Vec<Node>) -> Result<Self, TreeError> {
        validate(&nodes)?;
        Ok(Self {
            nodes,
            blending: Blending::default(),
        })
    }

    /// Creates a tree like [`SphereTree::from_nodes`], but computes every bound radius and ignores the given ones.
    ///
    /// # Errors
    /// A node breaks a rule; the error has the node and the rule.
    pub fn with_bounds(mut nodes: Vec<Node>) -> Result<Self, TreeError> {
        refit_bounds(&mut nodes);
        Self::from_nodes(nodes)
    }

    /// Creates a tree with `leaves` as its finest spheres, grouped in eights along the longest axis.
    ///
    /// Inner nodes are bounding spheres, with the contact radius equal to the bound. Such a tree suits analytic shapes
    /// whose leaves are the whole shape.
    ///
    /// # Errors
    /// There is no leaf, a leaf is not finite and positive, or there are more leaves than seven levels hold.
    pub fn over_leaves(leaves: &[Sphere]) -> Result<Self, TreeError> {
        if leaves.is_empty() {
            return Err(TreeError::Empty);
        }
        // Each node owns a group of leaves. A group of several leaves is cut into up to eight parts: three halvings at
        // the median of the longest axis.
        let mut nodes = vec![bounding_node(leaves, 0)];
        let mut groups = vec![leaves.to_vec()];
        let mut next = 0;
        while next < nodes.len() {
            let group = std::mem::take(&mut groups[next]);
            if group.len() > 1 {
                let level = nodes[next].level + 1;
                if level > MAX_LEVEL {
                    return Err(TreeError::BadStructure {
                        node: next,
                        what: "more leaves than seven levels hold",
                    });
                }
                nodes[next].first_child = nodes.len() as u32;
                for part in cut(group) {
                    nodes.push(bounding_node(&part, level));
                    nodes[next].children += 1;
                    groups.push(part);
                }
            }
            next += 1;
        }
        // Leaves at different depths are valid (ragged). Breadth-first order keeps each level together.
        Self::with_bounds(nodes)
    }

    /// Returns all nodes, level by level; the root is the first.
    #[inline]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns the finest level.
    pub fn depth(&self) -> u8 {
        self.nodes.last().map_or(0, |node| node.level)
    }

    /// Returns index and node of all nodes that form the shape at `level`: nodes of that level and childless nodes
    /// above.
    pub fn shape_at(&self, level: u8) -> impl Iterator<Item = (u32, &Node)> {
        self.nodes
            .iter()
            .enumerate()
            .filter(move |(_, node)| node.is_shape_at(level))
            .map(|(index, node)| (index as u32, node))
    }

    /// Returns the largest distance from `point` (object's frame) to the centre of any node, metres.
    pub fn lever_from(&self, point: &Vec3) -> f64 {
        self.nodes
            .iter()
            .fold(0.0, |lever, node| fmax(lever, norm(&(node.centre - point))))
    }
}

impl Node {
    /// Whether this node belongs to the shape at `level`.
    #[inline]
    pub fn is_shape_at(&self, level: u8) -> bool {
        self.level == level || (self.children == 0 && self.level < level)
    }

    /// Returns the contact sphere, in the frame of the node's centre.
    pub fn sphere(&self) -> Sphere {
        Sphere {
            centre: self.centre,
            radius: self.contact_radius,
        }
    }

    fn child_range(&self) -> std::ops::Range<usize> {
        let first = self.first_child as usize;
        first..first + usize::from(self.children)
    }
}

/// Relative margin of bound radii against rounding.
const BOUND_SLACK: f64 = 1e-12;

/// Computes the bound radii from the contact radii, children before parents.
pub(crate) fn refit_bounds(nodes: &mut [Node]) {
    for index in (0..nodes.len()).rev() {
        let node = nodes[index];
        let mut bound = node.contact_radius;
        if node.children > 0
            && node.child_range().end <= nodes.len()
            && node.child_range().start > index
        {
            // The children's bounds enclose all deeper descendants: no need to visit these.
            for child in &nodes[node.child_range()] {
                bound = fmax(
                    bound,
                    (norm(&(child.centre - node.centre)) + child.bound_radius)
                        * (1.0 + BOUND_SLACK),
                );
            }
        }
        nodes[index].bound_radius = bound;
    }
}

fn validate(nodes: &[Node]) -> Result<(), TreeError> {
    if nodes.is_empty() {
        return Err(TreeError::Empty);
    }
    let mut next_child = 1;
    for (index, node) in nodes.iter().enumerate() {
        for (field, found) in [
            ("centre x", node.centre.x),
            ("centre y", node.centre.y),
            ("centre z", node.centre.z),
        ] {
            if !found.is_finite() {
                return Err(TreeError::BadNumber {
                    node: index,
                    field,
                    found,
                    positive: false,
                });
            }
        }
        for (field, found) in [
            ("contact radius", node.contact_radius),
            ("bound radius", node.bound_radius),
        ] {
            if !(found.is_finite() && found > 0.0) {
                return Err(TreeError::BadNumber {
                    node: index,
                    field,
                    found,
                    positive: true,
                });
            }
        }
        let bad = |what| Err(TreeError::BadStructure { node: index, what });
        if node.level > MAX_LEVEL {
            return bad("level is deeper than seven");
        }
        if usize::from(node.children) > MAX_CHILDREN {
            return bad("more than eight children");
        }
        if node.bound_radius < node.contact_radius {
            return bad("bound radius is smaller than contact radius");
        }
        if index == 0 && node.level != 0 {
            return bad("the root is not at level 0");
        }
        if node.children == 0 {
            continue;
        }
        // In breadth-first storage the children of each node follow those of the previous one. The check also rules out
        // cycles, shared nodes and orphans.
        if node.first_child as usize != next_child {
            return bad("children are not stored level by level");
        }
        next_child += usize::from(node.children);
        if next_child > nodes.len() {
            return bad("children lie past the end");
        }
        for inner in node.child_range() {
            let child = &nodes[inner];
            if child.level != node.level + 1 {
                return bad("a child is not one level below");
            }
            let needed = norm(&(child.centre - node.centre)) + child.bound_radius;
            if needed > node.bound_radius * (1.0 + 4.0 * BOUND_SLACK) {
                return Err(TreeError::Unbounded {
                    node: index,
                    bound: node.bound_radius,
                    inner,
                    needed,
                });
            }
        }
    }
    if next_child != nodes.len() {
        return Err(TreeError::BadStructure {
            node: next_child,
            what: "is nobody's child",
        });
    }
    Ok(())
}

fn bounding_node(leaves: &[Sphere], level: u8) -> Node {
    let (centre, radius) = match leaves {
        [only] => (only.centre, only.radius),
        _ => {
            let (mut low, mut high) = (leaves[0].centre, leaves[0].centre);
            for leaf in leaves {
                low = low.zip_map(&leaf.centre, crate::math::fmin);
                high = high.zip_map(&leaf.centre, fmax);
            }
            let centre = (low + high) * 0.5;
            let radius = leaves.iter().fold(0.0, |r, leaf| {
                fmax(r, norm(&(leaf.centre - centre)) + leaf.radius)
            });
            (centre, radius)
        }
    };
    Node {
        centre,
        contact_radius: radius,
        bound_radius: radius,
        first_child: 0,
        children: 0,
        level,
    }
}

/// Cuts a group of spheres into at most eight parts by three halvings. Each halving is at the median along the longest
/// axis of the part.
fn cut(group: Vec<Sphere>) -> Vec<Vec<Sphere>> {
    let mut parts = vec![group];
    for _ in 0..3 {
        let mut halves = Vec::with_capacity(parts.len() * 2);
        for mut part in parts {
            if part.len() < 2 {
                halves.push(part);
                continue;
            }
            let node = bounding_node(&part, 0);
            let mut spread = Vec3::zeros();
            for sphere in &part {
                spread = spread.zip_map(&(sphere.centre - node.centre).abs(), fmax);
            }
            let axis = spread.imax();
            part.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
            let upper = part.split_off(part.len() / 2);
            halves.push(part);
            halves.push(upper);
        }
        parts = halves;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(super) fn leaves(n: usize) -> Vec<Sphere> {
        (0..n)
            .map(|k| {
                let t = k as f64;
                Sphere {
                    centre: Vec3::new(libm::sin(t), libm::cos(1.7 * t), libm::sin(0.3 * t)) * 0.01,
                    radius: 1e-3 + 1e-5 * t,
                }
            })
            .collect()
    }

    #[test]
    fn over_leaves_keeps_every_leaf_once() {
        for n in [1, 2, 7, 8, 9, 64, 100, 513] {
            let given = leaves(n);
            let tree = SphereTree::over_leaves(&given).expect("valid");
            let mut kept: Vec<_> = tree
                .shape_at(MAX_LEVEL)
                .map(|(_, node)| node.sphere())
                .collect();
            let mut wanted = given.clone();
            let key = |s: &Sphere| (s.radius.to_bits(), s.centre.x.to_bits());
            kept.sort_by_key(key);
            wanted.sort_by_key(key);
            assert_eq!(kept, wanted, "{n} leaves");
        }
    }

    #[test]
    fn every_bound_encloses_every_descendant() {
        let tree = SphereTree::over_leaves(&leaves(300)).expect("valid");
        for (index, node) in tree.nodes().iter().enumerate() {
            let mut stack = vec![index];
            while let Some(top) = stack.pop() {
                let inner = &tree.nodes()[top];
                assert!(
                    norm(&(inner.centre - node.centre)) + inner.contact_radius
                        <= node.bound_radius * (1.0 + 1e-9)
                );
                stack.extend(inner.child_range().filter(|_| inner.children > 0));
            }
        }
    }

    #[test]
    fn a_broken_tree_is_named() {
        let good = SphereTree::over_leaves(&leaves(20))
            .expect("valid")
            .nodes()
            .to_vec();
        let mut nan = good.clone();
        nan[3].centre.y = f64::NAN;
        assert!(matches!(
            SphereTree::from_nodes(nan),
            Err(TreeError::BadNumber {
                node: 3,
                field: "centre y",
                ..
            })
        ));
        let mut tight = good.clone();
        tight[0].bound_radius *= 0.5;
        tight[0].contact_radius *= 0.5;
        assert!(matches!(
            SphereTree::from_nodes(tight),
            Err(TreeError::Unbounded { node: 0, .. })
        ));
        let mut cyclic = good;
        cyclic[1].first_child = 0;
        assert!(matches!(
            SphereTree::from_nodes(cyclic),
            Err(TreeError::BadStructure { node: 1, .. })
        ));
        assert_eq!(SphereTree::from_nodes(vec![]), Err(TreeError::Empty));
    }

    proptest! {
        #[test]
        fn any_nodes_give_a_tree_or_an_error(raw in proptest::collection::vec(
            (any::<f64>(), any::<f64>(), any::<u32>(), any::<u8>(), any::<u8>()), 0..20)) {
            let nodes = raw.iter().map(|&(c, r, first_child, children, level)| Node {
                centre: Vec3::new(c, 0.0, c), contact_radius: r, bound_radius: r, first_child, children, level,
            }).collect();
            let _ = SphereTree::from_nodes(nodes);
        }
    }
}
