//! A tool of the scene at its present graphic pose, and the index of a group's substep.

use crate::Scene;
use crate::contact::PosedTool;
use crate::state::State;

/// Returns the tool in slot `t` at its present graphic pose.
pub(crate) fn posed<'a>(scene: &'a Scene, state: &'a State, t: usize) -> PosedTool<'a> {
    let tool = &scene.tools[t];
    PosedTool {
        nodes: tool.tree.nodes(),
        pose: &state.tools[t].graphic,
        level: tool.level,
        working_point: &tool.working_point,
        slot: t as u8,
    }
}

/// Returns the index in `Workspace::substeps` of the substep of a group: the slot of its first tool, 0 for an empty
/// group.
pub(crate) fn substep_of(group: &[usize]) -> usize {
    group.first().copied().unwrap_or(0)
}
