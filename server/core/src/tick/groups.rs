//! Which tools share a problem, and what becomes of a tissue that no tool is near.
//!
//! Tools that touch nothing in common that yields know nothing of each other: each has a problem of its own, with its own
//! substeps, in six unknowns. Where both come near one tissue they share one problem in twelve, for the tissue goes to one target, the
//! answer to all loads.
//!
//! A tissue belongs to the group whose tools it is near in this tick:
//! - Out of its rest, when the tick begins: to the tool that comes closer to it than a first pass on tissue looks, or than it
//!   could come back by itself within the tick. One that no tool is so near relaxes at once, all the way, before the
//!   tools move: it cannot meet one.
//! - Else, from the first pass on whose list of contacts has one with it.
//!
//! Where both tools claim one, be it in a late pass, the tick is begun anew with both in one problem: poses, loads and shapes as
//! they were. All of this goes by distances of spheres, so it does not depend on what a workspace remembers. First
//! all claims are made, then all first lists, and only then the first problem is solved: a common tissue hardly ever
//! shows later.

use crate::MAX_TOOLS;
use crate::state::State;
use crate::tick::group_solve::GroupSolve;
use crate::tick::request::{TickRequest, TissueConflict, ToolOutcome, hands};
use crate::tick::stage::{Stage, StageProbe};
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;

/// Moves the tools in the slots `present` (ascending), and all that yields, as far as this tick allows.
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
    // One group has all it needs.
    solve(request, state, ws, &[present], probe).unwrap_or([ToolOutcome::NOTHING; MAX_TOOLS])
}

/// Solves each group's problem.
///
/// # Errors
/// When two groups need one tissue.
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
    let mut outcomes = [ToolOutcome::NOTHING; MAX_TOOLS];
    for mut group_solve in solves.into_iter().flatten() {
        while group_solve.solve_and_step(request, state, ws, probe) {
            group_solve.predict_contacts(request, state, ws, probe)?;
        }
        group_solve.finish(ws, &mut outcomes);
    }
    Ok(outcomes)
}

/// What no tool is near goes to where it would be without contact.
fn relax(ws: &mut Workspace) {
    for &slot in &ws.awake {
        let yielding = &mut ws.yielding[slot];
        if ws.owners[slot].is_none() && !yielding.still {
            yielding.relax();
            ws.broad.object_moved(yielding.object, yielding.relaxing);
        }
    }
}

/// Keeps what a tick changes before it is known to be right.
fn remember(state: &State, ws: &mut Workspace) {
    let (poses, loads) = &mut ws.before;
    for (pose, tool) in poses.iter_mut().zip(&state.tools) {
        *pose = tool.graphic;
    }
    loads.copy_from_slice(&state.loads);
}

/// Everything as it was when the tick began.
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
