//! External force of section 4.2: Eq. 2, 3, and zero force for a haptic tool out of contact.

use super::pairs::for_each_pair;
use crate::math::Vec3;
use crate::tissue::Hand;
use crate::tree::Node;

/// Calls `press(tissue node, tool node, dp)` for every pair of contact prediction and returns the number of pairs.
///
/// Contact prediction compares the graphic tool of the last tick, grown by `d` (metres), with the tissue's shape after
/// the last tick. `tissue` holds nodes at that shape and the contact level. `dp = C_h - C_g` of Eq. 3 leads from the
/// graphic to the haptic centre of the tool's sphere, metres, world axes. `dp` is zero if no sphere of the haptic tool
/// overlaps that shape.
pub(super) fn for_each_press(
    hand: &Hand<'_>,
    d: f64,
    tissue: (&[Node], u8),
    mut press: impl FnMut(u32, u32, Vec3),
) -> u32 {
    let mut pairs = 0;
    let mut in_contact = None;
    for_each_pair((hand.tool, &hand.graphic, d), tissue, |node, tool_node| {
        pairs += 1;
        // Evaluated at the first pair only: the test traverses both trees.
        let pressing = *in_contact.get_or_insert_with(|| {
            !for_each_pair((hand.tool, &hand.haptic, 0.0), tissue, |_, _| false)
        });
        let dp = if pressing {
            let centre = &hand.tool.tree.nodes()[tool_node as usize].centre;
            hand.haptic.transform(centre) - hand.graphic.transform(centre)
        } else {
            Vec3::zeros()
        };
        press(node, tool_node, dp);
        true
    });
    pairs
}
