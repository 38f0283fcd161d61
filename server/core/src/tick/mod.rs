//! Haptic tick: takes the input, returns the wrench, advances the state.
//!
//! Boxes of the flowchart in the paper's Fig. 2, and the functions that implement them:
//!
//! | Fig. 2 | equations | here |
//! |---|---|---|
//! | configuration of the haptic tool | | `haptic::sanitise` |
//! | deformation without contact (addition) | 1, 4, 5 | `begin_tissues`, `Yielding::evaluate`, `Tissue::free_step` |
//! | collision detection, contact prediction | section 3.2 | `predict_contacts`, `collide`, `Predictor::predict` |
//! | optimisation, with the compliance of the tissue | 18 to 20 | `solve_and_step`, `optimise`, `ActiveSet::solve` |
//! | spring-sphere skeleton | 1 to 10 | `aim_tissues`, `Tissue::apply` of `tissue::skeleton` and `tissue::surface` |
//! | local deformation of the gingiva | 11 to 16 | `aim_tissues`, `Tissue::apply` of `tissue::gingiva` |
//! | update of the sphere tree | 17 | `Yielding::refit`, `tissue::refit` |
//! | force and torque | 18 | `finish_tool`, `wrench_at_device`, `wrench::limited` |
//!
//! A tick repeats collision detection, optimisation, deformation and tree update in *substeps* until the step has
//! reached its goal. `groups` decides which tools share one problem, `group_solve` runs the substeps of one group,
//! `commit_tissues` stores the final shapes in the state. `tissue::printed` implements the equations as printed, for
//! comparison.

mod collide;
mod gaps;
mod group_solve;
mod groups;
pub(crate) mod haptic;
mod posed;
pub(crate) mod request;
mod settle;
pub mod stage;
mod step;
pub(crate) mod substep;
mod tissue_rows;
pub(crate) mod workspace;
mod wrench;
mod yielding;

use xxhash_rust::xxh3::xxh3_64;

use crate::MAX_TOOLS;
use crate::input::TickInput;
use crate::math::{Pose, Vec3, Wrench, fclamp, fmax, log_rotation, norm};
use crate::output::{PocketReading, TickOutput, ToolOutput, status};
use crate::scene::{Scene, Tool};
use crate::state::{Arrival, State, ToolState};
use crate::tick::groups::advance;
use crate::tick::haptic::{kept_axis, sanitise, twist, wrench_at_device};
use crate::tick::request::{Held, TickRequest, ToolGoal, ToolOutcome, hands, held};
use crate::tick::stage::{Stage, StageProbe};
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;
use crate::tick::wrench::{Conditions, limited};
use crate::tissue::SiteLoad;
use crate::work::Counts;

/// Time without a valid pose after which a tool is stale, seconds. Equal to the server's timeout for missing poses.
const BAD_STALE_S: f64 = 0.05;
/// Largest distance of the working points, metres, and largest twist, radians, at which graphic and haptic tool meet.
///
/// Chosen: at the shipped coupling of 0.5 N/mm the force is then at most 0.5 N, the threshold of trauma.
const MEETING: (f64, f64) = (1e-3, 0.2);

/// Runs one tick and advances `state` by it. The work is bounded, no input panics, and nothing is allocated with
/// [`crate::optimise::SolverKind::ActiveSet`].
///
/// `state` and `ws` must belong to `scene`.
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
    ws.counts = Counts {
        ticks: 1,
        ..Counts::default()
    };

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
        // A tool stays absent until its first valid pose.
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
        if !last.entered && scene.params.max_arrival_step > 0.0 {
            state.tools[t].arrival = Arrival::Travelling;
        }
    }

    let held = held(&present[..n_present], &goals);
    begin_tissues(scene, state, ws, &held, input.detail);
    let request = TickRequest {
        scene,
        goals: &goals,
        held: &held,
        detail: input.detail,
    };
    let outcomes = advance(&request, state, ws, &present[..n_present], probe);

    probe.begin(Stage::Apply);
    let (readings, fault) = commit_tissues(scene, state, ws, &held, input.detail);
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
        work: u32::try_from(ws.counts.work()).unwrap_or(u32::MAX),
    }
}

/// Evaluates two shapes of every tissue: the present shape, and the shape at the end of the tick without contact.
/// Tissues that stay at rest are skipped. `detail` is the level of detail, 0 for the coarsest.
fn begin_tissues(scene: &Scene, state: &State, ws: &mut Workspace, held: &Held, detail: u8) {
    let hands = hands(scene, state, held, detail);
    ws.awake.clear();
    for (slot, yielding) in ws.yielding.iter_mut().enumerate() {
        if yielding.may_sleep(state, slot) {
            continue;
        }
        let moved = yielding.begin(state, slot, &hands);
        ws.broad.object_moved(yielding.object, moved);
        if yielding.is_evaluated() {
            ws.counts.tissue += yielding.effort().step;
            ws.awake.push(slot);
        }
    }
}

/// Stores the final shapes of the tissues in the state and reads the pockets. Returns the pocket reading of each tool
/// slot, `None` outside pockets. The flag is true if a state was not finite: such a tissue is reset to rest.
fn commit_tissues(
    scene: &Scene,
    state: &mut State,
    ws: &mut Workspace,
    held: &Held,
    detail: u8,
) -> ([Option<PocketReading>; MAX_TOOLS], bool) {
    let mut fault = false;
    // Moved out of the state, because `hands` borrows the rest of the state.
    let mut all = std::mem::take(&mut state.tissue);
    let hands = hands(scene, state, held, detail);
    for &slot in &ws.awake {
        let yielding = &mut ws.yielding[slot];
        if yielding.still {
            continue;
        }
        ws.tick_loads.clear();
        // A tissue without an owner has no contacts and no loads.
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
        // Of overlapping pockets, the pocket with the nearer wall sphere gives the reading.
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

/// Returns the fraction, per tool, of the last substep's loads on `object` that the tissue bears, in [0, 1].
///
/// The fraction is 1 when the whole step was applied. Otherwise the load `f` on the object is a blend of the last
/// tick's load and the target `g` of the substep. The fraction is then the projection `f . g / g . g`.
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
        // At most the load of the substep, for which the shape was computed.
        fclamp(borne / squared, 0.0, 1.0)
    })
}

/// Returns the progress of a present tool to its hand after a tick with the result `outcome`.
fn arrived(kept: &ToolState, tool: &Tool, outcome: &ToolOutcome) -> Arrival {
    let rests = outcome.converged && outcome.status & status::SETTLING == 0;
    if kept.arrival == Arrival::Met || !rests {
        return kept.arrival;
    }
    let at = |pose: &Pose| pose.transform(&tool.working_point);
    let apart = norm(&(at(&kept.graphic) - at(&kept.haptic)));
    let turned = norm(&log_rotation(
        &(kept.haptic.orientation * kept.graphic.orientation.inverse()),
    ));
    if apart <= MEETING.0 && turned <= MEETING.1 {
        Arrival::Met
    } else {
        Arrival::Apart
    }
}

/// Computes the wrench of tool `t` after ramp, clamp and slew, stores the tool's values in the state and returns its
/// output. `bits` are the status bits found so far.
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
        kept.arrival = arrived(kept, tool, outcome);
        if kept.arrival != Arrival::Met {
            bits |= status::NOT_MET;
        }
    } else {
        // An absent tool loads no object; its last wrench ramps to zero.
        loads.fill(Wrench::ZERO);
        kept.arrival = Arrival::Met;
    }
    kept.bad_ticks = if bits & status::BAD_INPUT != 0 {
        kept.bad_ticks.saturating_add(1)
    } else {
        0
    };
    // Invalid poses count as silence of the device.
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
        // Without a solution the tool stands still, and its last force must not remain in the hand.
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
        // A value that is not finite must not return in the next tick.
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
