//! Pairs of close spheres of a tool and a deformed tissue.
//!
//! Contact prediction uses a fixed distance, as in section 3.2 of the paper.

use crate::contact::{STACK, reach_of};
use crate::math::{Pose, Vec3};
use crate::scene::tool::Tool;
use crate::tree::Node;

/// Calls `visit(tissue node, tool node)` for every pair of overlapping contact spheres, until a call returns false.
///
/// Contact spheres of `tool` at `pose` are grown by `d` (metres). Contact spheres of the tissue are those of `nodes`
/// (world axes, refitted bounds) at `level`. The order of the pairs is deterministic.
///
/// Returns true if no call returned false.
pub(super) fn for_each_pair(
    (tool, pose, d): (&Tool, &Pose, f64),
    (nodes, level): (&[Node], u8),
    mut visit: impl FnMut(u32, u32) -> bool,
) -> bool {
    let rotation = pose.orientation.to_rotation_matrix().into_inner();
    let at = |node: &Node| -> Vec3 { pose.position + rotation * node.centre };
    let close = |(t, t_shape): (&Node, bool), (o, o_shape): (&Node, bool)| {
        let between = at(t) - o.centre;
        let reach = reach_of(t, t_shape) + reach_of(o, o_shape) + d;
        between.dot(&between) < reach * reach
    };
    let tool_nodes = tool.tree.nodes();
    let mut stack = [(0u32, 0u32); STACK];
    let mut depth = 1;
    while depth > 0 {
        depth -= 1;
        let (t, o) = stack[depth];
        let (tool_node, node) = (&tool_nodes[t as usize], &nodes[o as usize]);
        let (tool_is_shape, is_shape) =
            (tool_node.is_shape_at(tool.level), node.is_shape_at(level));
        // Pairs are tested when popped, because children are pushed untested.
        if !close((tool_node, tool_is_shape), (node, is_shape)) {
            continue;
        }
        if tool_is_shape && is_shape {
            if !visit(o, t) {
                return false;
            }
            continue;
        }
        let open_tool = !tool_is_shape && (is_shape || tool_node.bound_radius > node.bound_radius);
        let opened = if open_tool { tool_node } else { node };
        for child in opened.first_child..opened.first_child + u32::from(opened.children) {
            stack[depth] = if open_tool { (child, o) } else { (t, child) };
            depth += 1;
        }
    }
    true
}
