//! Search for any contact of a tool with one object within a distance: a plain traversal with a limit on its work.

use super::posed::{Posed, PosedTool, reach_of};
use crate::tree::Node;

/// Result of [`any_within`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Near {
    /// No pair of contact spheres is within the distance.
    None,
    /// A pair of contact spheres is within the distance.
    Some,
    /// The limit of tests was reached first.
    Unknown,
}

/// Whether any pair of contact spheres of a tool and an object has a gap under `d` (metres).
///
/// `posed` must be at the tool's pose. `object` has the nodes in world axes and the level in contact. `stack` is
/// scratch with the capacity [`super::STACK`]. The number of tested pairs is taken from `tests`.
pub(super) fn any_within(
    tool: &PosedTool<'_>,
    posed: &mut Posed,
    (objects, object_level): (&[Node], u8),
    d: f64,
    stack: &mut Vec<(u32, u32)>,
    tests: &mut u32,
) -> Near {
    stack.clear();
    stack.push((0, 0));
    while let Some((t, o)) = stack.pop() {
        let (tool_node, object_node) = (&tool.nodes[t as usize], &objects[o as usize]);
        let (tool_is_shape, object_is_shape) = (
            tool_node.is_shape_at(tool.level),
            object_node.is_shape_at(object_level),
        );
        if *tests == 0 {
            return Near::Unknown;
        }
        *tests -= 1;
        let between = posed.centre_of(tool, t) - object_node.centre;
        let reach = reach_of(tool_node, tool_is_shape) + reach_of(object_node, object_is_shape) + d;
        // NaN is not beyond the distance.
        if between.dot(&between) >= reach * reach {
            continue;
        }
        if tool_is_shape && object_is_shape {
            return Near::Some;
        }
        let open_tool = !tool_is_shape
            && (object_is_shape || tool_node.bound_radius > object_node.bound_radius);
        if open_tool {
            let first = tool_node.first_child;
            stack.extend((first..first + u32::from(tool_node.children)).map(|t| (t, o)));
        } else {
            let first = object_node.first_child;
            stack.extend((first..first + u32::from(object_node.children)).map(|o| (t, o)));
        }
    }
    Near::None
}
