//! Groups of tools that share one problem, and relaxation of tissues without a tool nearby.
//!
//! Tools without a common yielding tissue are independent: each has its own substeps, with six unknowns. Tools near one
//! tissue share one problem with twelve unknowns, because the tissue has one target shape under all loads.
//!
//! A tissue belongs to the group whose tools are near it in this tick:
//! - A tissue out of its rest shape is claimed at the start of the tick. The claiming tool is within the prediction
//!   distance of a first substep, or within the distance that the tissue can return by itself in the tick. A tissue
//!   without a claim relaxes at once, before any tool moves.
//! - A tissue at rest is claimed by the first substep whose contact list contains it.
//!
//! When both tools claim one tissue, even in a late substep, the tick restarts from its initial poses, loads and shapes
//! with both tools in one problem. All claims come first, then the first contact lists of all groups, then the first
//! solve: a late conflict is rare. Claims depend on distances of spheres alone, never on cached values.

use crate::MAX_TOOLS;
use crate::state::State;
use crate::tick::group_solve::GroupSolve;
use crate::tick::request::{TickRequest, TissueConflict, ToolOutcome, hands};
use crate::tick::stage::{Stage, StageProbe};
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;

/// Advances the tools in the slots `present` (ascending) and all tissues by one tick. Returns the outcome of each slot.
pub(crate) fn advance<P: StageProbe>(
    request: &TickRequest<'_>,
    state: &mut State,
    ws: &mut Workspace,
    present: &[usize],
    probe: &mut P,
) -> [ToolOutcome; MAX_TOOLS] {
    if present.len() > 1 && !ws.together {
        remember(state, ws);
        let mut groups = [&present[..0]; MAX_TOOLS];
        for (group, one) in groups.iter_mut().zip(present.chunks(1)) {
            *group = one;
        }
        match solve(request, state, ws, &groups[..present.len()], probe) {
            Ok(outcomes) => return outcomes,
            Err(TissueConflict) => begin_anew(request, state, ws),
        }
    }
    // A single group has no rival for a tissue: a conflict here is a fault of the program.
    solve(request, state, ws, &[present], probe).unwrap_or([ToolOutcome::IMPOSSIBLE; MAX_TOOLS])
}

/// Runs the substeps of every group and returns the outcome of each tool slot. A group is a list of tool slots.
///
/// # Errors
/// Two groups claim one tissue.
fn solve<P: StageProbe>(
    request: &TickRequest<'_>,
    state: &mut State,
    ws: &mut Workspace,
    groups: &[&[usize]],
    probe: &mut P,
) -> Result<[ToolOutcome; MAX_TOOLS], TissueConflict> {
    probe.begin(Stage::Collide);
    ws.owners.fill(None);
    let group = |k: usize| groups.get(k).filter(|group| !group.is_empty());
    let mut solves: [Option<GroupSolve<'_>>; MAX_TOOLS] =
        std::array::from_fn(|k| group(k).map(|group| GroupSolve::new(request, state, ws, group)));
    for group_solve in solves.iter_mut().flatten() {
        group_solve.claim_tissues(request, state, ws)?;
    }
    relax(ws);
    for group_solve in solves.iter_mut().flatten() {
        group_solve.predict_contacts(request, state, ws, probe)?;
    }
    // Substeps take turns, so that no group uses up the work of the tick alone.
    let mut goes_on = solves.each_ref().map(Option::is_some);
    while goes_on.contains(&true) {
        for (group_solve, goes_on) in solves.iter_mut().zip(&mut goes_on) {
            let Some(group_solve) = group_solve.as_mut().filter(|_| *goes_on) else {
                continue;
            };
            *goes_on = group_solve.solve_and_step(request, state, ws, probe)
                && group_solve.predict_contacts(request, state, ws, probe)?;
        }
    }
    let mut outcomes = [ToolOutcome::FREE; MAX_TOOLS];
    for group_solve in solves.into_iter().flatten() {
        group_solve.finish(ws, &mut outcomes);
    }
    Ok(outcomes)
}

/// Moves every tissue that no group has claimed to its shape at the end of the tick without contact.
fn relax(ws: &mut Workspace) {
    for &slot in &ws.awake {
        let yielding = &mut ws.yielding[slot];
        if ws.owners[slot].is_none() && !yielding.still {
            yielding.relax();
            ws.broad.object_moved(yielding.object, yielding.relaxing);
        }
    }
}

/// Saves graphic poses and loads, which a restart of the tick restores.
fn remember(state: &State, ws: &mut Workspace) {
    let (poses, loads) = &mut ws.before;
    for (pose, tool) in poses.iter_mut().zip(&state.tools) {
        *pose = tool.graphic;
    }
    loads.copy_from_slice(&state.loads);
}

/// Restores poses, loads and shapes of the start of the tick.
fn begin_anew(request: &TickRequest<'_>, state: &mut State, ws: &mut Workspace) {
    let (poses, loads) = &ws.before;
    for (pose, tool) in poses.iter().zip(&mut state.tools) {
        tool.graphic = *pose;
    }
    state.loads.copy_from_slice(loads);
    ws.substeps.iter_mut().for_each(Substep::clear);
    let hands = hands(request.scene, state, request.held, request.detail);
    for &slot in &ws.awake {
        let yielding = &mut ws.yielding[slot];
        let moved = yielding.evaluate(state, slot, &hands);
        ws.broad.object_moved(yielding.object, moved);
    }
}
