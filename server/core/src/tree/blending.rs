//! How a tree's spheres are blended: lengths by level, insets by node, and what they must be.

use serde::{Deserialize, Serialize};

use super::{SphereTree, TreeError};
use crate::math::fmin;

/// Largest blend length, metres.
const MAX_BLEND: f64 = 0.01;
/// Shortest blend length that is not none, metres: shorter ones are lost in rounding.
pub const MIN_BLEND: f64 = 1e-7;

/// How the spheres of a level are blended into one smooth surface ([`crate::blend`]); empty where
/// they are touched as they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Blending {
    /// Blend length of each level, root first, metres; 0 where the level's spheres are hard.
    pub lengths: Vec<f64>,
    /// Inset of each node, metres: its core, which is never penetrated, has the contact radius less
    /// the inset. It belongs to the node's own level; a childless node that stands for itself at a
    /// finer level has its inset shrunk there as the blend length is.
    pub insets: Vec<f64>,
}

impl SphereTree {
    /// The same nodes, blended like that.
    ///
    /// # Errors
    /// If there is not one length for each level (or none at all) and one inset for each node, a
    /// length is not 0 to 10 mm, or an inset does not leave a core.
    pub fn with_blending(mut self, blending: Blending) -> Result<Self, TreeError> {
        blending.validate(&self)?;
        self.blending = blending;
        Ok(self)
    }

    /// How the spheres are blended.
    pub fn blending(&self) -> &Blending {
        &self.blending
    }

    /// Blend length at `level`, metres; 0 where the spheres are touched as they are.
    #[inline]
    pub fn blend_at(&self, level: u8) -> f64 {
        let lengths = &self.blending.lengths;
        match lengths.get(usize::from(level)) {
            Some(length) => *length,
            // Below the finest level there is nothing but it.
            None => lengths.last().copied().unwrap_or(0.0),
        }
    }

    /// Radius of the core of node `index` when the tree is in contact at `level`, metres.
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
