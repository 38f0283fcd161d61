//! The tick itself: input in, wrench out, state forward.

use xxhash_rust::xxh3::xxh3_64;

use crate::MAX_TOOLS;
use crate::blend::{Blender, Groups, Line, MAX_SEEDS, Member};
use crate::contact::broad::Broad;
use crate::contact::{Contact, ContactList, Overflow, Predictor, Work};
use crate::groups::advance;
use crate::haptic::{kept_axis, sanitise, twist, wrench_at_device};
use crate::input::TickInput;
use crate::math::{Pose, Vec3, Wrench, log_rotation, norm};
use crate::optimise::{Problem, ProblemRow, Solution, active_set::ActiveSet};
use crate::output::{PocketReading, TickOutput, ToolOutput, status};
use crate::scene::Scene;
use crate::stage::{Stage, StageProbe};
use crate::state::State;
use crate::substep::{Asked, Reached, Wanted};
use crate::tissue::{Hand, Hands, Site, SiteLoad, TissueModel};
use crate::tree::Sphere;
use crate::wrench::{Conditions, limited};
use crate::yielding::Yielding;

/// Unusable poses in a row after which the tool counts as stale: the watchdog's time.
const BAD_TICKS_STALE: u16 = 50;
/// Gap under which a row is taken to have borne load at the end of the last tick, metres: what touched then has none,
/// and the tick begins where that one ended.
const TOUCHING: f64 = 1e-6;

/// Scratch of a tick, sized when the scene loads. What outlives a tick in it saves work and never
/// shows in a result: a fresh one gives the same bits.
#[derive(Debug)]
pub struct Workspace {
    pub(crate) predictor: Predictor,
    /// What each tool can come near at all.
    pub(crate) broad: Broad,
    /// Per tool, or in the first tool's place where both share one problem.
    pub(crate) passes: [Pass; MAX_TOOLS],
    pub(crate) active_set: ActiveSet,
    pub(crate) blender: Blender,
    /// Gaps of the rows, to choose among them.
    pub(crate) gaps: Vec<f64>,
    pub(crate) sites: Vec<Site>,
    pub(crate) site_loads: Vec<f64>,
    pub(crate) loads: Vec<Wrench>,
    /// What can yield, in the order of the scene's objects.
    pub(crate) yielding: Vec<Yielding>,
    /// For each object its place in `yielding`.
    pub(crate) slots: Vec<Option<usize>>,
    /// Places in `yielding` of what was asked in this tick: all that is not at rest, or has a tool near.
    pub(crate) awake: Vec<usize>,
    /// Whose pass each of `yielding` belongs to in this tick.
    pub(crate) owners: Vec<Option<usize>>,
    /// What ends a query at the first pair.
    pub(crate) any: ContactList,
    /// As many zeros as the longest configuration has numbers.
    pub(crate) zeros: Vec<f64>,
    /// Graphic poses and loads as the tick began.
    pub(crate) before: ([Pose; MAX_TOOLS], Vec<Wrench>),
    /// Whether both tools always share one problem: for tests.
    pub(crate) together: bool,
    /// Places in `yielding` of the pockets, and the balls outside of which no tip reads them.
    pockets: Vec<(usize, Sphere)>,
    tick_loads: Vec<SiteLoad>,
    /// Largest distance of a sphere from the working point, per tool, metres.
    pub(crate) levers: [f64; MAX_TOOLS],
    bytes: Vec<u8>,
}

/// Contacts, problem and answer of the last pass of one group of tools.
#[derive(Debug)]
pub(crate) struct Pass {
    pub contacts: ContactList,
    /// What each row is about.
    pub lines: Vec<Line>,
    /// Contacts of blended objects by tool sphere.
    pub groups: Groups,
    /// Members of the blended rows, row by row.
    pub members: Vec<Member>,
    pub rows: Vec<ProblemRow>,
    /// What each contact bears, newtons: its row's multiplier, or its shares of those of blended rows.
    pub shares: Vec<f64>,
    pub solution: Solution,
    /// Keys of the contacts whose rows bore load in the tick's last pass, sorted.
    pub bearing: Vec<(u16, u32, u8, u32)>,
    /// Rows of these contacts in this pass; in a tick's first pass, which knows of no other, those that touch.
    pub first: Vec<u32>,
    /// Compliance of the tissue in the rows' directions, row by row; none in a scene where nothing yields.
    pub gram: Vec<f64>,
    /// Whether it belongs to this pass.
    pub tissue: bool,
    /// Places in [`Workspace::yielding`] of the tissues that this group's tools came near in this tick.
    pub tissues: Vec<usize>,
    /// Share of its answer that was applied; none where the solver had no usable one.
    pub applied: Option<f64>,
}

impl Pass {
    fn with_capacity(
        (rows, dense): (usize, usize),
        blended: bool,
        tool_nodes: usize,
        tissues: usize,
    ) -> Self {
        Self {
            contacts: ContactList::with_capacity(rows),
            lines: Vec::with_capacity(rows),
            groups: Groups::with_capacity(if blended { rows } else { 0 }, tool_nodes),
            members: Vec::with_capacity(if blended { rows * MAX_SEEDS } else { 0 }),
            shares: Vec::with_capacity(rows),
            rows: Vec::with_capacity(rows),
            solution: Solution::with_capacity(rows),
            bearing: Vec::with_capacity(rows),
            first: Vec::with_capacity(rows),
            gram: vec![0.0; dense * dense],
            tissue: false,
            tissues: Vec::with_capacity(tissues),
            applied: Some(1.0),
        }
    }

    pub fn clear(&mut self) {
        self.applied = Some(1.0);
        self.contacts.begin(0, Overflow::Stop);
        self.lines.clear();
        self.groups.clear();
        self.members.clear();
        self.rows.clear();
        self.shares.clear();
        self.solution.lambda.clear();
        self.bearing.clear();
        self.tissue = false;
        self.tissues.clear();
    }

    /// Remembers which contacts' rows bear load.
    pub fn note_bearing(&mut self) {
        self.bearing.clear();
        let contacts = self.contacts.as_slice();
        let loads = self.lines.iter().zip(&self.solution.lambda);
        let bearing = loads.filter(|(_, load)| **load > 0.0);
        self.bearing
            .extend(bearing.map(|(line, _)| contacts[line.contact as usize].key()));
        self.bearing.sort_unstable();
    }

    /// Finds the rows with which the solver begins: of the contacts that bore load in the last pass, or in a tick's first
    /// that touch already.
    pub fn find_bearing(&mut self) {
        self.first.clear();
        if self.bearing.is_empty() {
            let lines = self.lines.iter().enumerate();
            let touching = lines.filter(|(_, line)| line.gap < TOUCHING);
            self.first.extend(touching.map(|(i, _)| i as u32));
            return;
        }
        let contacts = self.contacts.as_slice();
        for (i, line) in self.lines.iter().enumerate() {
            let key = contacts[line.contact as usize].key();
            if self.bearing.binary_search(&key).is_ok() {
                self.first.push(i as u32);
            }
        }
    }

    /// Each contact with its load.
    pub fn loaded(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.contacts
            .as_slice()
            .iter()
            .zip(self.shares.iter().copied())
    }

    /// Shares the multipliers out among the contacts.
    pub fn share_out(&mut self) {
        self.shares.clear();
        self.shares.resize(self.contacts.as_slice().len(), 0.0);
        for (line, lambda) in self.lines.iter().zip(&self.solution.lambda) {
            if line.members == 0 {
                self.shares[line.contact as usize] = *lambda;
            } else if *lambda > 0.0 {
                let first = line.first as usize;
                for member in &self.members[first..first + line.members as usize] {
                    self.shares[member.contact as usize] += member.weight * lambda;
                }
            }
        }
    }
}

impl Workspace {
    /// Scratch for `scene`.
    pub fn new(scene: &Scene) -> Self {
        let yielding = Yielding::all(scene);
        let blended = (0..scene.objects.len()).any(|k| scene.blend_of(k) > 0.0);
        let rows = scene.most_contacts() * scene.tools.len();
        let dense = scene.most_rows();
        let tool_nodes = scene
            .tools
            .iter()
            .map(|tool| tool.tree.nodes().len())
            .max()
            .unwrap_or(0);
        let lever = |t: usize| {
            scene
                .tools
                .get(t)
                .map_or(0.0, |tool| tool.tree.lever_from(&tool.working_point))
        };
        let tissues = yielding.len();
        // Only tissue needs the dense matrix.
        let sizes = (rows, if tissues == 0 { 0 } else { dense });
        let pockets = yielding.iter().enumerate();
        let pockets = pockets.filter_map(|(slot, of)| Some((slot, of.model.pocket()?)));
        let longest = yielding.iter().map(|yielding| yielding.shape.len()).max();
        Self {
            predictor: Predictor::new(scene),
            broad: Broad::new(scene),
            passes: std::array::from_fn(|_| {
                Pass::with_capacity(sizes, blended, tool_nodes, tissues)
            }),
            blender: Blender::with_capacity(if blended { rows } else { 0 }),
            pockets: pockets.collect(),
            awake: Vec::with_capacity(tissues),
            owners: vec![None; tissues],
            any: ContactList::with_capacity(1),
            zeros: vec![0.0; longest.unwrap_or(0)],
            before: (
                [Pose::identity(); MAX_TOOLS],
                vec![Wrench::ZERO; scene.tools.len() * scene.objects.len()],
            ),
            together: false,
            active_set: if yielding.is_empty() {
                ActiveSet::rigid_only(rows)
            } else {
                ActiveSet::with_capacity(dense)
            },
            gaps: Vec::with_capacity(rows),
            sites: Vec::with_capacity(rows),
            site_loads: Vec::with_capacity(rows),
            loads: vec![Wrench::ZERO; scene.tools.len() * scene.objects.len()],
            slots: (0..scene.objects.len())
                .map(|k| yielding.iter().position(|yielding| yielding.object == k))
                .collect(),
            tick_loads: Vec::with_capacity(if yielding.is_empty() { 0 } else { rows }),
            yielding,
            levers: std::array::from_fn(lever),
            bytes: Vec::with_capacity(TickInput::BYTES + State::most_bytes(scene)),
        }
    }

    /// Contacts of each tool's last problem, sorted, with their loads (newtons): what a test, a view or
    /// an audit wants to know. A load is the multiplier of the contact's row; on a blended surface
    /// the sum of its shares in the rows' multipliers. Normals times loads add up to the wrench.
    pub fn contacts(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.passes.iter().flat_map(Pass::loaded)
    }

    /// The last problem of each tool (or of both together) and its answer, for an independent solver to
    /// judge.
    pub fn last_problems(&self, scene: &Scene) -> impl Iterator<Item = (Problem<'_>, &Solution)> {
        let contact_compliance = scene.params.contact_compliance;
        let max_iterations = usize::from(scene.params.max_iterations);
        let solved =
            |pass: &&Pass| !pass.rows.is_empty() && pass.solution.lambda.len() == pass.rows.len();
        self.passes.iter().filter(solved).map(move |pass| {
            let m = pass.rows.len();
            let problem = Problem {
                rows: &pass.rows,
                tissue: pass.tissue.then(|| &pass.gram[..m * m]),
                contact_compliance,
                first: &[],
                max_iterations,
            };
            (problem, &pass.solution)
        })
    }

    /// The same, except that contact prediction traverses the trees anew in every pass: slower, the same
    /// bits. For tests and measurements.
    pub fn plain(scene: &Scene) -> Self {
        Self {
            predictor: Predictor::plain(scene),
            ..Self::new(scene)
        }
    }

    /// The same, except that both tools always share one problem: slower, and the same to rounding. For tests.
    pub fn together(scene: &Scene) -> Self {
        Self {
            together: true,
            ..Self::new(scene)
        }
    }

    /// What contact prediction did since this workspace was made.
    pub fn work(&self) -> Work {
        self.predictor.work()
    }

    /// Present configuration of object `k` at the end of the last tick (displacements), empty for
    /// a rigid one.
    pub fn shape_of(&self, k: usize) -> &[f64] {
        self.slots[k].map_or(&[], |slot| &self.yielding[slot].shape)
    }

    /// How far the carriers of object `k`'s [`crate::DisplaySkin`] had gone at the end of the last tick, by index, world axes,
    /// metres.
    pub fn carriers_moved(&self, scene: &Scene, k: usize) -> Vec<Vec3> {
        let (object, shape) = (&scene.objects[k], self.shape_of(k));
        if let TissueModel::Surface(_) = object.tissue {
            return shape.chunks_exact(3).map(Vec3::from_column_slice).collect();
        }
        let nodes = object.tree.nodes();
        let ids: Vec<u32> = (0..nodes.len() as u32).collect();
        let mut moved = vec![Vec3::zeros(); nodes.len()];
        if self.centres_of(k, &ids, &mut moved) {
            for (moved, node) in moved.iter_mut().zip(nodes) {
                *moved -= node.centre;
            }
        }
        moved
    }

    /// Centres of the nodes `ids` of object `k` at the end of the last tick, world axes, metres; false
    /// for a rigid object, whose centres are the tree's.
    pub fn centres_of(&self, k: usize, ids: &[u32], out: &mut [Vec3]) -> bool {
        let Some(slot) = self.slots[k] else {
            return false;
        };
        let yielding = &self.yielding[slot];
        yielding.model.centres(&yielding.shape, ids, out);
        true
    }
}

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
    ws.passes.iter_mut().for_each(Pass::clear);

    let tools = scene.tools.len();
    let mut bits = [0u16; MAX_TOOLS];
    let mut wanted = [Wanted {
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
        wanted[t] = Wanted {
            haptic,
            moved: norm(&moved),
            turned: norm(&turned),
        };
        present[n_present] = t;
        n_present += 1;
    }

    let held = held(&present[..n_present], &wanted);
    begin(scene, state, ws, &held, input.detail);
    let asked = Asked {
        scene,
        wanted: &wanted,
        held: &held,
        detail: input.detail,
    };
    let reached = advance(&asked, state, ws, &present[..n_present], probe);

    probe.begin(Stage::Apply);
    let (readings, fault) = commit(scene, state, ws, &held, input.detail);
    let mut outputs = [idle_output(state, 0), idle_output(state, 1)];
    for t in 0..tools {
        if fault {
            bits[t] |= status::FAULT;
        }
        outputs[t] = finish_tool(scene, state, input, t, bits[t], &wanted[t], &reached[t]);
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

fn idle_output(state: &State, t: usize) -> ToolOutput {
    ToolOutput {
        wrench: Wrench::ZERO,
        raw_wrench: Wrench::ZERO,
        graphic: state.tools[t].graphic,
        haptic: state.tools[t].haptic,
        status: status::ABSENT,
        substeps: 0,
        rows: 0,
        active: 0,
        min_gap: f64::INFINITY,
        converged: true,
        pocket: None,
    }
}

/// Haptic poses of the hands that hold something, by slot.
pub(crate) type Held = [Option<Pose>; MAX_TOOLS];

fn held(present: &[usize], wanted: &[Wanted; MAX_TOOLS]) -> Held {
    std::array::from_fn(|t| present.contains(&t).then(|| wanted[t].haptic))
}

pub(crate) fn hands<'a>(scene: &'a Scene, state: &'a State, held: &Held, detail: u8) -> Hands<'a> {
    let objects = scene.objects.len();
    Hands {
        tools: std::array::from_fn(|t| {
            held[t].map(|haptic| Hand {
                tool: &scene.tools[t],
                haptic,
                graphic: state.tools[t].graphic,
                loads: &state.loads[t * objects..(t + 1) * objects],
            })
        }),
        detail,
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
        if yielding.was_asked() {
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
        let pass = ws.owners[slot].map(|owner| &ws.passes[owner]);
        let answered = pass.is_none_or(|pass| pass.applied.is_some());
        if let Some(pass) = pass {
            let applied = pass.applied.unwrap_or(0.0);
            let ours = pass.loaded().filter(|(contact, load)| {
                usize::from(contact.object) == yielding.object && *load > 0.0
            });
            ws.tick_loads.extend(ours.map(|(contact, load)| SiteLoad {
                sphere: contact.object_sphere,
                tool: contact.tool,
                force: contact.normal * (-load * applied),
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
        for (slot, ball) in &ws.pockets {
            let from = tip - ball.centre;
            if from.dot(&from) > ball.radius * ball.radius {
                continue;
            }
            let yielding = &ws.yielding[*slot];
            let found = yielding.model.reading(t, &hands, all.of(*slot));
            let deeper = |new: &PocketReading| {
                reading.is_none_or(|old: PocketReading| new.depth > old.depth)
            };
            if let Some(new) = found.filter(deeper) {
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

/// Wrench, ramps and what is kept of one tool.
fn finish_tool(
    scene: &Scene,
    state: &mut State,
    input: &TickInput,
    t: usize,
    mut bits: u16,
    wanted: &Wanted,
    reached: &Reached,
) -> ToolOutput {
    let (tool, slot, objects) = (&scene.tools[t], &input.tools[t], scene.objects.len());
    let loads = &mut state.loads[t * objects..(t + 1) * objects];
    let kept = &mut state.tools[t];
    let present = bits & status::ABSENT == 0;
    bits |= reached.status;
    if present {
        let mut sum = Wrench::ZERO;
        for load in loads.iter() {
            sum.force += load.force;
            sum.torque += load.torque;
        }
        kept.raw = wrench_at_device(&sum, tool, &kept.graphic, &wanted.haptic);
        if twist(
            &wanted.haptic.orientation,
            &kept.graphic.orientation,
            &kept.twist_axis,
        )
        .1
        {
            bits |= status::TWIST_SATURATED;
        }
        kept.twist_axis = kept_axis(
            &wanted.haptic.orientation,
            &kept.graphic.orientation,
            &kept.twist_axis,
        );
        kept.haptic = wanted.haptic;
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
    let stale = slot.stale || kept.bad_ticks >= BAD_TICKS_STALE;
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
        substeps: reached.substeps,
        rows: reached.rows,
        active: reached.active,
        min_gap: reached.min_gap,
        converged: reached.converged,
        pocket: None,
    }
}

#[cfg(test)]
pub(crate) mod tests;
