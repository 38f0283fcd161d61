//! Blending of a tree's spheres: lengths by level, insets by node, and their validation.

use serde::{Deserialize, Serialize};

use super::{SphereTree, TreeError};
use crate::math::fmin;

/// Largest blend length, metres.
const MAX_BLEND: f64 = 0.01;
/// Smallest blend length other than 0, metres. Shorter lengths are lost in rounding.
pub const MIN_BLEND: f64 = 1e-7;

/// Parameters that blend the spheres of a level into one smooth surface ([`crate::blend`]). Empty for a tree without
/// blending.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Blending {
    /// Blend length of each level, root first, metres, 1e-7 to 0.01; 0 for a level without blending.
    pub lengths: Vec<f64>,
    /// Inset of each node, metres, from 0 to less than the contact radius.
    ///
    /// The radius of a node's core, which is never penetrated, is the contact radius minus the inset. The inset belongs
    /// to the node's own level. For a childless node at a finer level the inset shrinks in proportion to the blend
    /// length.
    pub insets: Vec<f64>,
}

impl SphereTree {
    /// Returns the same nodes with this blending.
    ///
    /// # Errors
    /// The number of lengths is not that of the levels, or the number of insets is not that of the nodes. Two empty
    /// lists are valid. A length is neither 0 nor 1e-7 to 0.01 m. An inset is negative, or not under the contact
    /// radius.
    pub fn with_blending(mut self, blending: Blending) -> Result<Self, TreeError> {
        blending.validate(&self)?;
        self.blending = blending;
        Ok(self)
    }

    /// Returns the blending of the spheres.
    pub fn blending(&self) -> &Blending {
        &self.blending
    }

    /// Returns the blend length at `level`, metres; 0 without blending. A level below the finest has the length of the
    /// finest.
    #[inline]
    pub fn blend_at(&self, level: u8) -> f64 {
        let lengths = &self.blending.lengths;
        match lengths.get(usize::from(level)) {
            Some(length) => *length,
            // Levels below the finest one have its shape.
            None => lengths.last().copied().unwrap_or(0.0),
        }
    }

    /// Returns the core radius of node `index` for a tree in contact at `level`, metres: the contact radius minus the
    /// inset. The inset of a node above `level` shrinks with the blend length.
    #[inline]
    pub fn core_radius(&self, index: u32, level: u8) -> f64 {
        let node = &self.nodes[index as usize];
        match self.blending.insets.get(index as usize) {
            Some(inset) if node.level == level => node.contact_radius - inset,
            Some(inset) => {
                let own = self.blend_at(node.level);
                let share = if own > 0.0 {
                    fmin(1.0, self.blend_at(level) / own)
                } else {
                    0.0
                };
                node.contact_radius - inset * share
            }
            None => node.contact_radius,
        }
    }
}

impl Blending {
    fn validate(&self, tree: &SphereTree) -> Result<(), TreeError> {
        let bad = |field, index, found, expected| {
            Err(TreeError::BadBlending {
                field,
                index,
                found,
                expected,
            })
        };
        let (lengths, insets) = (self.lengths.len(), self.insets.len());
        if lengths == 0 && insets == 0 {
            return Ok(());
        }
        if lengths != usize::from(tree.depth()) + 1 {
            return bad(
                "number of blend lengths",
                lengths,
                lengths as f64,
                "one for each level",
            );
        }
        if insets != tree.nodes.len() {
            return bad(
                "number of insets",
                insets,
                insets as f64,
                "one for each node",
            );
        }
        for (index, &length) in self.lengths.iter().enumerate() {
            if length != 0.0 && !(MIN_BLEND..=MAX_BLEND).contains(&length) {
                return bad(
                    "blend length of level",
                    index,
                    length,
                    "0, or 1e-7 to 0.01 m",
                );
            }
        }
        for (index, (&inset, node)) in self.insets.iter().zip(&tree.nodes).enumerate() {
            if !(inset >= 0.0 && inset < node.contact_radius) {
                return bad(
                    "inset of node",
                    index,
                    inset,
                    "at least 0 and under the contact radius",
                );
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::MAX_LEVEL;
    use crate::tree::tests::leaves;

    #[test]
    fn a_broken_blending_is_named() {
        let tree = SphereTree::over_leaves(&leaves(20)).expect("valid");
        let good = Blending {
            lengths: vec![1e-5; usize::from(tree.depth()) + 1],
            insets: vec![1e-5; tree.nodes().len()],
        };
        let blended = tree.clone().with_blending(good.clone()).expect("valid");
        let (leaf, node) = blended.shape_at(MAX_LEVEL).next().expect("a leaf");
        assert_eq!(
            blended.core_radius(leaf, node.level),
            node.contact_radius - 1e-5
        );
        assert_eq!(tree.core_radius(leaf, node.level), node.contact_radius);
        assert_eq!((blended.blend_at(MAX_LEVEL), tree.blend_at(2)), (1e-5, 0.0));
        let refused = |change: fn(&mut Blending)| {
            let mut bad = good.clone();
            change(&mut bad);
            tree.clone()
                .with_blending(bad)
                .expect_err("broken")
                .to_string()
        };
        assert!(refused(|b| b.lengths.clear()).contains("number of blend lengths 0"));
        assert!(refused(|b| b.insets.truncate(3)).contains("number of insets 3"));
        assert!(refused(|b| b.lengths[1] = f64::NAN).contains("blend length of level 1"));
        assert!(refused(|b| b.insets[2] = 1.0).contains("inset of node 2"));
        assert!(refused(|b| b.insets[0] = -1e-9).contains("inset of node 0"));
    }
}
