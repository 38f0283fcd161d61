//! A tool of the scene at its present pose, and the pass that a group of tools uses.

use crate::Scene;
use crate::contact::PosedTool;
use crate::state::State;

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

/// Which of the workspace's passes a group uses: its first tool's.
pub(crate) fn substep_of(group: &[usize]) -> usize {
    group.first().copied().unwrap_or(0)
}
