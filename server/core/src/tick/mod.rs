//! The tick itself: input in, wrench out, state forward.

mod collide;
mod gaps;
mod group_solve;
mod groups;
pub(crate) mod haptic;
mod posed;
pub(crate) mod request;
mod settle;
pub mod stage;
pub(crate) mod substep;
pub(crate) mod workspace;
mod wrench;
mod yielding;

use xxhash_rust::xxh3::xxh3_64;

use crate::MAX_TOOLS;
use crate::input::TickInput;
use crate::math::{Vec3, Wrench, fclamp, fmax, log_rotation, norm};
use crate::output::{PocketReading, TickOutput, ToolOutput, status};
use crate::scene::Scene;
use crate::state::State;
use crate::tick::groups::advance;
use crate::tick::haptic::{kept_axis, sanitise, twist, wrench_at_device};
use crate::tick::request::{Held, TickRequest, ToolGoal, ToolOutcome, hands, held};
use crate::tick::stage::{Stage, StageProbe};
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;
use crate::tick::wrench::{Conditions, limited};
use crate::tissue::SiteLoad;

/// Time without a usable pose after which the tool counts as stale, seconds: the watchdog's.
const BAD_STALE_S: f64 = 0.05;

/// Runs one tick: `state` becomes the state after it. Never panics on any input, allocates nothing
/// (with [`crate::optimise::SolverKind::ActiveSet`]), takes bounded work.
///
/// `state` and `ws` must have been made for `scene`.
pub fn tick<P: StageProbe>(
    scene: &Scene,
    state: &mut State,
    ws: &mut Workspace,
    input: &TickInput,
    probe: &mut P,
) -> TickOutput {
    probe.begin(Stage::Prepare);
    let ticks = 1 + u64::from(input.skipped);
    state.tick = state.tick.saturating_add(ticks);
    ws.substeps.iter_mut().for_each(Substep::clear);

    let tools = scene.tools.len();
    let mut bits = [0u16; MAX_TOOLS];
    let mut goals = [ToolGoal {
        haptic: state.tools[0].haptic,
        moved: 0.0,
        turned: 0.0,
    }; MAX_TOOLS];
    let mut present = [0; MAX_TOOLS];
    let mut n_present = 0;
    for t in 0..tools {
        let last = &state.tools[t];
        let slot = &input.tools[t];
        let (haptic, found) = sanitise(&slot.pose, &scene.params, last, ticks);
        bits[t] |= found;
        // A tool whose very first pose is unusable has not come in yet.
        if !slot.present || (found & status::BAD_INPUT != 0 && !last.entered) {
            bits[t] |= status::ABSENT;
            continue;
        }
        let tool = &scene.tools[t];
        let moved =
            haptic.transform(&tool.working_point) - last.haptic.transform(&tool.working_point);
        let turned = log_rotation(&(haptic.orientation * last.haptic.orientation.inverse()));
        goals[t] = ToolGoal {
            haptic,
            moved: norm(&moved),
            turned: norm(&turned),
        };
        present[n_present] = t;
        n_present += 1;
    }

    let held = held(&present[..n_present], &goals);
    begin(scene, state, ws, &held, input.detail);
    let request = TickRequest {
        scene,
        goals: &goals,
        held: &held,
        detail: input.detail,
    };
    let outcomes = advance(&request, state, ws, &present[..n_present], probe);

    probe.begin(Stage::Apply);
    let (readings, fault) = commit(scene, state, ws, &held, input.detail);
    let mut outputs = state.tools.map(|tool| ToolOutput::absent(tool.graphic));
    for t in 0..tools {
        if fault {
            bits[t] |= status::FAULT;
        }
        outputs[t] = finish_tool(scene, state, input, t, bits[t], &goals[t], &outcomes[t]);
        outputs[t].pocket = readings[t];
    }

    probe.begin(Stage::Hash);
    ws.bytes.clear();
    ws.bytes.extend_from_slice(&input.to_bytes());
    state.write_bytes(&mut ws.bytes);
    state.hash = xxh3_64(&ws.bytes);
    probe.end();
    TickOutput {
        tick: state.tick,
        hash: state.hash,
        tools: outputs,
    }
}

/// Where each yielding thing is and would be without contact. What was at rest and stays there is not looked at.
fn begin(scene: &Scene, state: &State, ws: &mut Workspace, held: &Held, detail: u8) {
    let hands = hands(scene, state, held, detail);
    ws.awake.clear();
    for (slot, yielding) in ws.yielding.iter_mut().enumerate() {
        if yielding.may_sleep(state, slot) {
            continue;
        }
        let moved = yielding.begin(state, slot, &hands);
        ws.broad.object_moved(yielding.object, moved);
        if yielding.is_evaluated() {
            ws.awake.push(slot);
        }
    }
}

/// Takes the shapes that the tick ended with into the state, and the readings of pockets out of it. What is
/// not finite goes back to rest, and is said.
fn commit(
    scene: &Scene,
    state: &mut State,
    ws: &mut Workspace,
    held: &Held,
    detail: u8,
) -> ([Option<PocketReading>; MAX_TOOLS], bool) {
    let mut fault = false;
    // The state's tissue is written while the rest of it is looked at.
    let mut all = std::mem::take(&mut state.tissue);
    let hands = hands(scene, state, held, detail);
    for &slot in &ws.awake {
        let yielding = &mut ws.yielding[slot];
        if yielding.still {
            continue;
        }
        ws.tick_loads.clear();
        // What no tool came near bears nothing.
        let substep = ws.owners[slot].map(|owner| &ws.substeps[owner]);
        let answered = substep.is_none_or(|substep| substep.applied.is_some());
        if let Some(substep) = substep {
            let part = applied(
                substep,
                (&state.loads, scene.objects.len()),
                yielding.object,
            );
            let ours = substep.loaded().filter(|(contact, load)| {
                usize::from(contact.object) == yielding.object && *load > 0.0
            });
            ws.tick_loads.extend(ours.map(|(contact, load)| SiteLoad {
                sphere: contact.object_sphere,
                tool: contact.tool,
                force: contact.normal * (-load * part[usize::from(contact.tool)]),
            }));
        }
        yielding.model.commit(
            &yielding.shape,
            answered.then_some(ws.tick_loads.as_slice()),
            &hands,
            all.of_mut(slot),
        );
        if !all.settle(slot) {
            fault = true;
            yielding.forget();
            ws.broad.forget();
        }
    }
    let mut readings = [None; MAX_TOOLS];
    for (t, reading) in readings.iter_mut().enumerate() {
        let Some(hand) = &hands.tools[t] else {
            continue;
        };
        let tip = hand.graphic.transform(&hand.tool.tip);
        // Of two pockets that claim it the one with the nearer wall sphere has it: the other's can end far above.
        let mut nearest = f64::INFINITY;
        for (slot, ball) in &ws.pockets {
            let from = tip - ball.centre;
            if from.dot(&from) > ball.radius * ball.radius {
                continue;
            }
            let yielding = &ws.yielding[*slot];
            let found = yielding.model.reading(t, &hands, all.of(*slot));
            if let Some((from_wall, new)) = found.filter(|(from_wall, _)| *from_wall < nearest) {
                nearest = from_wall;
                *reading = Some(PocketReading {
                    object: yielding.object as u16,
                    ..new
                });
            }
        }
    }
    state.tissue = all;
    (readings, fault)
}

/// Share of the last pass's loads on an object that each tool puts on it: all, unless the pass went a share of its step only. Then
/// the load is between that of the tick before and the pass's, and what of it lies along the pass's is on the tissue.
fn applied(
    substep: &Substep,
    (loads, objects): (&[Wrench], usize),
    object: usize,
) -> [f64; MAX_TOOLS] {
    let share = substep.applied.unwrap_or(0.0);
    if share == 1.0 {
        return [1.0; MAX_TOOLS];
    }
    let mut request = [Vec3::zeros(); MAX_TOOLS];
    for (contact, load) in substep.loaded() {
        if usize::from(contact.object) == object {
            request[usize::from(contact.tool)] -= contact.normal * fmax(load, 0.0);
        }
    }
    std::array::from_fn(|t| {
        let squared = request[t].dot(&request[t]);
        if squared == 0.0 {
            return share;
        }
        let borne = loads
            .get(t * objects + object)
            .map_or(0.0, |load| load.force.dot(&request[t]));
        // Never more than the pass request for: its shape is made for that.
        fclamp(borne / squared, 0.0, 1.0)
    })
}

/// Wrench, ramps and what is kept of one tool.
fn finish_tool(
    scene: &Scene,
    state: &mut State,
    input: &TickInput,
    t: usize,
    mut bits: u16,
    goal: &ToolGoal,
    outcome: &ToolOutcome,
) -> ToolOutput {
    let (tool, slot, objects) = (&scene.tools[t], &input.tools[t], scene.objects.len());
    let loads = &mut state.loads[t * objects..(t + 1) * objects];
    let kept = &mut state.tools[t];
    let present = bits & status::ABSENT == 0;
    bits |= outcome.status;
    if present {
        let mut sum = Wrench::ZERO;
        for load in loads.iter() {
            sum.force += load.force;
            sum.torque += load.torque;
        }
        kept.raw = wrench_at_device(&sum, tool, &kept.graphic, &goal.haptic);
        if twist(
            &goal.haptic.orientation,
            &kept.graphic.orientation,
            &kept.twist_axis,
        )
        .1
        {
            bits |= status::TWIST_SATURATED;
        }
        kept.twist_axis = kept_axis(
            &goal.haptic.orientation,
            &kept.graphic.orientation,
            &kept.twist_axis,
        );
        kept.haptic = goal.haptic;
    } else {
        // Nobody holds it: it loads nothing, while the last wrench ramps out.
        loads.fill(Wrench::ZERO);
    }
    kept.bad_ticks = if bits & status::BAD_INPUT != 0 {
        kept.bad_ticks.saturating_add(1)
    } else {
        0
    };
    // A device that sends nothing usable is as silent as one that sends nothing.
    let stale = slot.stale || u64::from(kept.bad_ticks) >= scene.params.ticks_in(BAD_STALE_S);
    if stale {
        bits |= status::STALE;
    }
    if input.paused {
        bits |= status::PAUSED;
    }
    let limit = f64::from(input.force_limit_n);
    let most = scene.params.max_force;
    let now = Conditions {
        // While no answer can be had the tool stands still: its last force must not stay in the hand.
        wanted: present && !stale && !input.paused && bits & status::SOLVER_FAILED == 0,
        force_limit: if limit > 0.0 && limit < most {
            limit
        } else {
            most
        },
    };
    let (wrench, gain, limits) = limited(&kept.raw, &kept.sent, kept.gain, &now, &scene.params);
    bits |= limits;
    if limits & status::FAULT != 0 {
        // Whatever was not finite must not come back next tick.
        loads.fill(Wrench::ZERO);
        kept.raw = Wrench::ZERO;
    }
    kept.sent = wrench;
    kept.gain = gain;
    kept.entered = present;
    ToolOutput {
        wrench,
        raw_wrench: if present { kept.raw } else { Wrench::ZERO },
        graphic: kept.graphic,
        haptic: kept.haptic,
        status: bits,
        substeps: outcome.substeps,
        rows: outcome.rows,
        active: outcome.active,
        min_gap: outcome.min_gap,
        converged: outcome.converged,
        pocket: None,
    }
}

#[cfg(test)]
pub(crate) mod tests;
