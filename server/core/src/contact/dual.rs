//! Plain traversal: two trees at once, the larger node opened first.

use super::posed::{Lever, Posed, PosedTool, reach_of};
use super::{ContactList, ContactsFull, Distance};
use crate::tree::Node;

/// Capacity of the stack of a traversal, pairs of nodes. A pop pushes at most eight pairs, so seven remain for each
/// level of either tree.
pub(crate) const STACK: usize = 7 * 2 * (crate::tree::MAX_LEVEL as usize + 1) + 8;

/// Appends every pair of contact spheres of a tool and an object with a gap under `d` to `out`.
///
/// `object` is the index in the scene, the nodes in world axes and the level in contact. `levers` are those of the
/// predictor, by tool node. `tested` counts the tested pairs of nodes.
///
/// # Errors
/// `out` is full and its policy is [`super::Overflow::Stop`].
pub(super) fn traverse(
    tool: &PosedTool<'_>,
    posed: &mut Posed,
    object: (u16, &[Node], u8),
    (d, levers): (Distance, &[Lever]),
    (stack, tested): (&mut Vec<(u32, u32)>, &mut u64),
    out: &mut ContactList,
) -> Result<(), ContactsFull> {
    let (object_index, objects, object_level) = object;
    stack.clear();
    stack.push((0, 0));
    while let Some((t, o)) = stack.pop() {
        let (tool_node, object_node) = (&tool.nodes[t as usize], &objects[o as usize]);
        let at = posed.centre_of(tool, t);
        let (tool_is_shape, object_is_shape) = (
            tool_node.is_shape_at(tool.level),
            object_node.is_shape_at(object_level),
        );
        if tool_is_shape && object_is_shape {
            *tested += 1;
            let sphere = object_node.sphere();
            if let Some(contact) = posed.contact(
                tool,
                (object_index, o, &sphere),
                (t, &at),
                d.at(levers[t as usize].own),
            ) {
                out.push(contact)?;
            }
            continue;
        }
        let open_tool = !tool_is_shape
            && (object_is_shape || tool_node.bound_radius > object_node.bound_radius);
        if open_tool {
            let radius = reach_of(object_node, object_is_shape);
            *tested += u64::from(tool_node.children);
            for child in
                tool_node.first_child..tool_node.first_child + u32::from(tool_node.children)
            {
                let node = &tool.nodes[child as usize];
                let between = posed.centre_of(tool, child) - object_node.centre;
                let is_shape = node.is_shape_at(tool.level);
                let d = d.at(levers[child as usize].of(is_shape));
                let reach = reach_of(node, is_shape) + radius + d;
                if between.dot(&between) < reach * reach {
                    stack.push((child, o));
                }
            }
        } else {
            let d = d.at(levers[t as usize].of(tool_is_shape));
            let radius = reach_of(tool_node, tool_is_shape) + d;
            *tested += u64::from(object_node.children);
            for child in
                object_node.first_child..object_node.first_child + u32::from(object_node.children)
            {
                let node = &objects[child as usize];
                let between = at - node.centre;
                let reach = reach_of(node, node.is_shape_at(object_level)) + radius;
                if between.dot(&between) < reach * reach {
                    stack.push((t, child));
                }
            }
        }
    }
    Ok(())
}
