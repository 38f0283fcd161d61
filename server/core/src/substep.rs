//! One tool, or both tools on one tissue, brought to where they can go: predict, optimise, move,
//! look again, until the step is small and every true gap is closed to rounding.
//!
//! The trust region holds the motion of the graphic tool plus that of the tissue under the
//! prediction distance, so nothing is passed through between two passes at any speed: the
//! continuous collision detection that the paper left open.

use std::ops::Range;

use crate::blend::{Group, Groups, Line, Pair, hollowness, reach};
use crate::contact::{Contact, Distance, Overflow, PosedTool, centre};
use crate::haptic::{renormalised, twist};
use crate::math::{Mat3, Pose, Vec3, Wrench, exp_rotation, fclamp, fmax, fmin, norm};
use crate::metric::Metric;
use crate::optimise::{
    ContactSolver, Problem, ProblemRow, SolveStatus, SolverKind, UNKNOWNS, clarabel::Clarabel,
};
use crate::output::status;
use crate::stage::{Stage, StageProbe};
use crate::state::State;
use crate::tick::{Pass, Workspace};
use crate::tissue::{Gram, Site, refit};
use crate::{MAX_TOOLS, Scene};

/// Prediction distance at which a full contact list keeps the smallest gaps, metres.
const SMALLEST_PREDICTION: f64 = 1e-6;

/// How much farther each pass of a tick looks at least than the one before, and how far at most for that
/// reason alone, metres: farther than its own motion a pass only lists more rows.
const WIDENING: f64 = 4.0;
const WIDEST: f64 = 5e-5;
/// Blended gap up to which a surface is taken to be touched, metres.
const TOUCHING: f64 = 2e-6;
/// Share of the coupling's stiffness under which the bend of a surface is too little to matter.
const LEAST_BEND: f64 = 0.1;

/// What the group asks for, per tool slot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Haptic pose.
    pub haptic: Pose,
    /// How far the hand moved the working point in this tick, metres.
    pub moved: f64,
    /// How far it turned, radians.
    pub turned: f64,
}

/// How it went, per tool slot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached {
    pub status: u16,
    pub substeps: u8,
    pub rows: u16,
    pub active: u16,
    pub min_gap: f64,
    pub converged: bool,
}

impl Reached {
    pub(crate) const NOTHING: Reached = Reached {
        status: 0,
        substeps: 0,
        rows: 0,
        active: 0,
        min_gap: f64::INFINITY,
        converged: true,
    };
}

/// Moves the tools of `group` (slots, ascending) as far as this tick allows.
pub(crate) fn advance<P: StageProbe>(
    scene: &Scene,
    state: &mut State,
    ws: &mut Workspace,
    group: &[usize],
    wanted: &[Wanted; MAX_TOOLS],
    probe: &mut P,
) -> [Reached; MAX_TOOLS] {
    let params = &scene.params;
    let mut reached = [Reached::NOTHING; MAX_TOOLS];
    let mut status_bits = 0;
    let first = place(group);
    let mut converged = false;
    let (moved, turned) = group.iter().fold((0.0, 0.0), |(moved, turned), &t| {
        (fmax(moved, wanted[t].moved), fmax(turned, wanted[t].turned))
    });
    let longest = group.iter().fold(0.0, |most, &t| fmax(most, ws.levers[t]));
    // A turn moves spheres by their levers: what is near the tip need not look as far as the shaft.
    let distance_for = |moved: f64, turned: f64, floor: f64| {
        let base = fclamp(
            params.predict_gain * moved + params.predict_bias,
            floor,
            params.predict_max,
        );
        let most = (params.predict_max - base) / fmax(longest, 1e-9);
        Distance {
            base,
            turn: fmin(params.predict_gain * turned, most),
        }
    };
    let mut floor = params.predict_min;
    let mut d = distance_for(moved, turned, floor);
    let mut passes = 0;
    while passes < params.max_substeps {
        passes += 1;
        probe.begin(Stage::Collide);
        let (used, cut) = collide(scene, state, ws, group, d);
        if cut {
            status_bits |= status::CONTACTS_FULL;
        }
        d = used;
        probe.begin(Stage::Optimise);
        write_lines(scene, ws, first, d);
        let target = optimise(scene, state, ws, group, wanted);
        let Some(Answer {
            steps: step,
            settled,
        }) = target
        else {
            // An unusable answer is never applied: pose and load stay as they are.
            status_bits |= status::SOLVER_FAILED;
            break;
        };
        let tissue_motion = yield_target(scene, ws, first);
        let (mut motion, mut moved, mut turned, mut share) = (tissue_motion, 0.0, 0.0, 1.0);
        for &t in group {
            let (v, w) = (norm(&step[t].0) + tissue_motion, norm(&step[t].1));
            (moved, turned) = (fmax(moved, v), fmax(turned, w));
            motion = fmax(motion, v + w * ws.levers[t]);
            // Motion and allowance both grow linearly with the lever: what holds at both ends holds between.
            for lever in [0.0, ws.levers[t]] {
                let (motion, allowed) = (v + w * lever, params.trust * d.at(lever));
                if motion > allowed {
                    share = fmin(share, allowed / motion);
                }
            }
        }
        apply(scene, state, ws, group, &step, share);
        // What turns about the working point moves a little farther than its lever says.
        let gone = Distance {
            base: 1.01 * share * moved,
            turn: 1.01 * share * turned,
        };
        for tool in &mut reached {
            tool.min_gap = f64::INFINITY;
        }
        let deepest = true_gaps(scene, state, ws, first, (d, gone), &mut reached);
        let free = ws.passes[first].contacts.as_slice().is_empty();
        let small = motion <= params.converged_step || free;
        if share == 1.0 && small && settled && deepest >= -params.converged_gap {
            converged = true;
            break;
        }
        // A tick that needs many passes must not be held by how little each of them sees.
        floor = fmin(WIDENING * floor, fmax(params.predict_min, WIDEST));
        d = distance_for(moved * (1.0 - share), turned * (1.0 - share), floor);
    }
    if !converged && status_bits & status::SOLVER_FAILED == 0 {
        status_bits |= status::EXHAUSTED;
    }
    let failed = status_bits & status::SOLVER_FAILED != 0;
    for &t in group {
        let pass = &ws.passes[first];
        let ours = || {
            let loads = pass.rows.iter().zip(&pass.solution.lambda);
            loads.filter(|(row, _)| usize::from(row.tool) == t)
        };
        reached[t].rows = ours().count() as u16;
        // Multipliers that were not applied load nothing.
        reached[t].active = if failed {
            0
        } else {
            ours().filter(|(_, load)| **load > 0.0).count() as u16
        };
        reached[t].status = status_bits;
        reached[t].substeps = passes;
        reached[t].converged = converged;
    }
    reached
}

/// Which of the workspace's passes a group uses: its first tool's. Where nobody holds a tool, tissue
/// alone moves, in the first.
fn place(group: &[usize]) -> usize {
    group.first().copied().unwrap_or(0)
}

/// Lists the contacts at the present poses and shapes, within `d` or as far as the list reaches: while it
/// is full it halves `d`, which costs passes only, then the reach of blended surfaces, which are then made
/// of fewer spheres. Returns what it used and whether anything was cut. Where even the smallest distance
/// finds more than the list holds (a flat tool on a flat face), the smallest gaps are kept: what is left
/// out lies within that smallest distance, no pass moves farther, and the next one ranks anew.
fn collide(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    group: &[usize],
    mut d: Distance,
) -> (Distance, bool) {
    for &k in &ws.yielding {
        let object = &scene.objects[k];
        let shape = &ws.shape[ws.shape_at[k]..ws.shape_at[k + 1]];
        refit(
            object.tissue.model(),
            &object.tree,
            shape,
            &ws.ids,
            &mut ws.centres,
            &mut ws.nodes[k],
        );
    }
    let limit = scene.most_contacts() * group.len();
    let longest = group.iter().fold(0.0, |most, &t| fmax(most, ws.levers[t]));
    let mut cut = false;
    // Blended surfaces are made of spheres from farther away; where there is no room for them, of fewer.
    let mut share = 1.0;
    let contacts = &mut ws.passes[place(group)].contacts;
    'again: loop {
        let overflow = if d.base > SMALLEST_PREDICTION || d.turn > 0.0 {
            Overflow::Stop
        } else {
            Overflow::KeepSmallestGaps
        };
        contacts.begin(limit, overflow);
        let mut blended = false;
        for &t in group {
            let tool = &scene.tools[t];
            let posed = PosedTool {
                nodes: tool.tree.nodes(),
                pose: &state.tools[t].graphic,
                level: tool.level,
                working_point: &tool.working_point,
                slot: t as u8,
            };
            ws.predictor.begin(&posed);
            for (k, object) in scene.objects.iter().enumerate() {
                let nodes = if object.tissue.is_rigid() {
                    object.tree.nodes()
                } else {
                    &ws.nodes[k]
                };
                let blend = scene.blend_of(k);
                blended |= blend > 0.0;
                let mut within = d;
                if blend > 0.0 {
                    within.base += share * reach(blend) * blend;
                }
                if ws
                    .predictor
                    .predict(&posed, (k as u16, nodes, object.level), within, contacts)
                    .is_err()
                {
                    cut = true;
                    let most = d.at(longest);
                    if blended && share > 0.0 && most <= 2.0 * scene.params.predict_min {
                        share = if share > 0.1 { 0.5 * share } else { 0.0 };
                    } else {
                        d = Distance {
                            base: fmax(0.5 * d.base, SMALLEST_PREDICTION),
                            turn: if most > 2.0 * SMALLEST_PREDICTION {
                                0.5 * d.turn
                            } else {
                                0.0
                            },
                        };
                    }
                    continue 'again;
                }
            }
        }
        contacts.sort();
        // In the last resort a full list has left out the largest gaps.
        let full = overflow == Overflow::KeepSmallestGaps && contacts.as_slice().len() == limit;
        return (d, cut || full);
    }
}

/// Steps per tool: translation of the working point (metres) and rotation vector (radians).
type Steps = [(Vec3, Vec3); MAX_TOOLS];

/// Builds and solves the problem of this pass; `None` when the answer is unusable.
fn optimise(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    group: &[usize],
    wanted: &[Wanted; MAX_TOOLS],
) -> Option<Answer> {
    let first = place(group);
    let mut free_step = [0.0; UNKNOWNS];
    let mut metrics = [Metric::UNIT; MAX_TOOLS];
    for &t in group {
        let (tool, now) = (&scene.tools[t], &state.tools[t]);
        let v = wanted[t].haptic.transform(&tool.working_point)
            - now.graphic.transform(&tool.working_point);
        let (w, _) = twist(
            &wanted[t].haptic.orientation,
            &now.graphic.orientation,
            &now.twist_axis,
        );
        let mut metric = Metric::of(tool);
        bend(scene, &ws.passes[first], t, &v, &mut metric);
        let free = metric.scaled_free_step(&v, &w);
        free_step[6 * t..6 * t + 6].copy_from_slice(&free);
        metrics[t] = metric;
    }
    let pass = &mut ws.passes[first];
    pass.rows.clear();
    for line in &pass.lines {
        let contact = &pass.contacts.as_slice()[line.contact as usize];
        let t = usize::from(contact.tool);
        let a = metrics[t].scaled_row(&line.normal, &contact.arm.cross(&line.normal));
        let bias = line.gap + crate::optimise::dot6(&a, &free_step[6 * t..6 * t + 6]);
        pass.rows.push(ProblemRow {
            a,
            tool: contact.tool,
            bias,
        });
    }
    let tissue = fill_tissue(scene, ws, first);
    let Pass { rows, solution, .. } = &mut ws.passes[first];
    let problem = Problem {
        rows,
        tissue: tissue.then(|| &ws.gram[..rows.len() * rows.len()]),
        contact_compliance: scene.params.contact_compliance,
        max_iterations: usize::from(scene.params.max_iterations),
    };
    match scene.params.solver {
        SolverKind::ActiveSet => ws.active_set.solve(&problem, solution),
        SolverKind::Clarabel => Clarabel.solve(&problem, solution),
    }
    let solved = solution.status == SolveStatus::Solved;
    let y = solution.y;
    ws.passes[first].share_out();
    if !solved {
        return None;
    }
    let mut answer = Answer {
        steps: [(Vec3::zeros(), Vec3::zeros()); MAX_TOOLS],
        settled: true,
    };
    for &t in group {
        let y: [f64; 6] = std::array::from_fn(|k| free_step[6 * t + k] + y[6 * t + k]);
        let (v, w) = metrics[t].step(&y);
        answer.steps[t] = (v, w);
        answer.settled &= metrics[t].settled(&v, &w);
    }
    let finite = answer
        .steps
        .iter()
        .all(|(v, w)| v.iter().chain(w.iter()).all(|x| x.is_finite()));
    finite.then_some(answer)
}

/// What a pass found.
struct Answer {
    steps: Steps,
    /// Whether the forces are those of the coupling, not of the bent metric.
    settled: bool,
}

/// Adds to the metric of tool `t` how the surfaces that it presses on bend inwards, times the press. In
/// a groove rounder than the press is deep, passes that know only the slope turn to and fro for ever; with
/// the bend they are Newton's and settle in two or three. Changes the way, not where it ends.
fn bend(scene: &Scene, pass: &Pass, t: usize, stretch: &Vec3, metric: &mut Metric) {
    let contacts = pass.contacts.as_slice();
    let stiffness = scene.tools[t].stiffness_n_per_m;
    let touching = |line: &&Line| {
        let contact = &contacts[line.contact as usize];
        line.members > 0
            && usize::from(contact.tool) == t
            && line.gap <= TOUCHING
            && line.normal.dot(stretch) < 0.0
    };
    // Each row counts the whole press: where several share it that is too much, and steps are shorter than they
    // might be; shared out evenly it was too little in a groove, and ticks there did not converge.
    for line in pass.lines.iter().filter(touching) {
        let contact = &contacts[line.contact as usize];
        let press = -stiffness * line.normal.dot(stretch);
        let first = line.first as usize;
        let members = &pass.members[first..first + line.members as usize];
        let blend = scene.blend_of(usize::from(contact.object));
        // No bend is sharper than that of two opposite normals.
        if press / blend < LEAST_BEND * stiffness {
            continue;
        }
        let hollow = hollowness(line, members, contacts, blend) * press;
        if hollow.trace() > LEAST_BEND * stiffness {
            metric.add(&hollow, &contact.arm);
        }
    }
}

/// Ranges of what is sorted by object that are about one object.
fn runs<T>(items: &[T], object: impl Fn(&T) -> u16) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let first = next;
        let this = object(items.get(first)?);
        next = first
            + items[first..]
                .iter()
                .take_while(|item| object(item) == this)
                .count();
        Some(first..next)
    })
}

/// Writes what each row is about: a contact, or on a blended object a seed with its members. In the
/// order of the contacts' objects; tool sphere by tool sphere on a blended one.
fn write_lines(scene: &Scene, ws: &mut Workspace, first: usize, d: Distance) {
    let Pass {
        contacts,
        lines,
        members,
        groups,
        ..
    } = &mut ws.passes[first];
    let blender = &mut ws.blender;
    lines.clear();
    members.clear();
    groups.clear();
    let contacts = contacts.as_slice();
    for run in runs(contacts, |contact| contact.object) {
        let k = usize::from(contacts[run.start].object);
        let blend = scene.blend_of(k);
        if blend == 0.0 {
            lines.extend(run.map(|index| Line::hard(index, &contacts[index])));
            continue;
        }
        let object = &scene.objects[k];
        // The list's gap is that of the contact spheres.
        let inset = |contact: &Contact| {
            object.tree.nodes()[contact.object_sphere as usize].contact_radius
                - object.tree.core_radius(contact.object_sphere, object.level)
        };
        let begun = groups.all.len();
        groups.add(contacts, run, |contact| contact.gap + inset(contact));
        for group in &groups.all[begun..] {
            let d = d.at(lever(group, groups, contacts));
            if group.is_clear_of(d, blend, 0.0) {
                continue;
            }
            blender.begin();
            for &index in groups.contacts(group) {
                let contact = &contacts[index as usize];
                let tool = &scene.tools[usize::from(contact.tool)].tree;
                let distance = contact.gap
                    + object.tree.nodes()[contact.object_sphere as usize].contact_radius
                    + tool.nodes()[contact.tool_sphere as usize].contact_radius;
                let gap = contact.gap + inset(contact);
                blender.push(Pair::new(index, gap, contact.normal, distance));
            }
            blender.rows(blend, d, |mut line, shares| {
                line.first = members.len() as u32;
                members.extend(shares);
                line.members = members.len() as u32 - line.first;
                lines.push(line);
            });
        }
    }
}

/// Lever of a group's tool sphere about the working point, metres.
fn lever(group: &Group, groups: &Groups, contacts: &[Contact]) -> f64 {
    let first = groups.contacts(group)[0];
    norm(&contacts[first as usize].arm)
}

/// The tissue's part of the problem: compliance and the way from the free shape. False when
/// nothing touched yields.
fn fill_tissue(scene: &Scene, ws: &mut Workspace, first: usize) -> bool {
    let Pass {
        contacts,
        lines,
        rows,
        tissue,
        ..
    } = &mut ws.passes[first];
    let contacts = contacts.as_slice();
    let about = |line: &Line| &contacts[line.contact as usize];
    let touched = |c: &Contact| !scene.objects[usize::from(c.object)].tissue.is_rigid();
    if ws.yielding.is_empty() || !contacts.iter().any(touched) {
        *tissue = false;
        return false;
    }
    *tissue = true;
    let m = rows.len();
    ws.gram[..m * m].fill(0.0);
    for run in runs(lines, |line| about(line).object) {
        let k = usize::from(about(&lines[run.start]).object);
        let object = &scene.objects[k];
        if object.tissue.is_rigid() {
            continue;
        }
        let model = object.tissue.model();
        ws.sites.clear();
        for line in &lines[run.clone()] {
            ws.sites.push(Site {
                sphere: about(line).object_sphere,
                normal: line.normal,
            });
        }
        model.add_gram(
            &object.tree,
            &ws.sites,
            &mut Gram::new(&mut ws.gram, m, run.start),
        );
        // n . (u_k - u0): the rows are written at the present shape, the load acts on the free one.
        let free = &ws.free[ws.shape_at[k]..ws.shape_at[k + 1]];
        for (row, line) in rows[run.clone()].iter_mut().zip(&lines[run]) {
            let contact = about(line);
            let mut at_rest = [Vec3::zeros()];
            model.centres(&object.tree, free, &[contact.object_sphere], &mut at_rest);
            let now = ws.nodes[k][contact.object_sphere as usize].centre;
            row.bias += contact.normal.dot(&(now - at_rest[0]));
        }
    }
    true
}

/// Writes the configurations under the multipliers to `target`; returns the largest motion there.
fn yield_target(scene: &Scene, ws: &mut Workspace, first: usize) -> f64 {
    let mut motion = 0.0;
    for index in 0..ws.yielding.len() {
        let k = ws.yielding[index];
        let object = &scene.objects[k];
        let model = object.tissue.model();
        ws.sites.clear();
        ws.site_loads.clear();
        for (contact, load) in ws.passes[first].loaded() {
            if usize::from(contact.object) == k {
                ws.sites.push(Site {
                    sphere: contact.object_sphere,
                    normal: contact.normal,
                });
                ws.site_loads.push(load);
            }
        }
        let at = ws.shape_at[k]..ws.shape_at[k + 1];
        let (free, target) = (&ws.free[at.clone()], &mut ws.target[at.clone()]);
        model.apply(&object.tree, &ws.sites, &ws.site_loads, free, target);
        motion = fmax(motion, model.motion(&object.tree, &ws.shape[at], target));
    }
    motion
}

/// Moves tools, tissue and loads by the same share of the step.
fn apply(
    scene: &Scene,
    state: &mut State,
    ws: &mut Workspace,
    group: &[usize],
    steps: &Steps,
    share: f64,
) {
    for (shape, target) in ws.shape.iter_mut().zip(&ws.target) {
        *shape += share * (target - *shape);
    }
    let objects = scene.objects.len();
    for &t in group {
        let (v, w) = steps[t];
        let tool = &scene.tools[t];
        let graphic = &mut state.tools[t].graphic;
        let at = graphic.transform(&tool.working_point) + v * share;
        graphic.orientation = renormalised(&(exp_rotation(&(w * share)) * graphic.orientation));
        graphic.position = at - graphic.orientation * tool.working_point;

        // Loads on the objects about the working point first, then about the world's origin.
        let targets = &mut ws.loads[t * objects..(t + 1) * objects];
        targets.fill(Wrench::ZERO);
        for (contact, lambda) in ws.passes[place(group)].loaded() {
            if usize::from(contact.tool) == t && lambda > 0.0 {
                let force = contact.normal * -lambda;
                let load = &mut targets[usize::from(contact.object)];
                load.force += force;
                load.torque += contact.arm.cross(&force);
            }
        }
        for (load, target) in state.loads[t * objects..(t + 1) * objects]
            .iter_mut()
            .zip(&*targets)
        {
            let target = target.moved(&at);
            load.force += (target.force - load.force) * share;
            load.torque += (target.torque - load.torque) * share;
        }
    }
}

/// Smallest true gap of each tool and of all after a motion of at most `moved`: of the spheres, or where they
/// are blended of the surface, made anew from where they are now, as far as it is under `d`.
fn true_gaps(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    first: usize,
    (d, gone): (Distance, Distance),
    reached: &mut [Reached; MAX_TOOLS],
) -> f64 {
    let Pass {
        contacts, groups, ..
    } = &ws.passes[first];
    let contacts = contacts.as_slice();
    let rotations: [Mat3; MAX_TOOLS] = std::array::from_fn(|t| {
        let graphic = &state.tools[t].graphic;
        graphic.orientation.to_rotation_matrix().into_inner()
    });
    for run in runs(contacts, |contact| contact.object) {
        if scene.blend_of(usize::from(contacts[run.start].object)) > 0.0 {
            continue;
        }
        for contact in &contacts[run] {
            let least = &mut reached[usize::from(contact.tool)].min_gap;
            let rotation = &rotations[usize::from(contact.tool)];
            *least = fmin(*least, true_gap(scene, state, ws, (contact, rotation)));
        }
    }
    let blender = &mut ws.blender;
    for group in &groups.all {
        let (t, k) = (usize::from(group.tool), usize::from(group.object));
        let (object, blend) = (&scene.objects[k], scene.blend_of(k));
        let lever = lever(group, groups, contacts);
        let limit = fmin(reached[t].min_gap, d.at(lever));
        if group.is_clear_of(limit, blend, gone.at(lever)) {
            continue;
        }
        blender.begin();
        let (pose, rotation) = (&state.tools[t].graphic, &rotations[t]);
        for &index in groups.contacts(group) {
            let contact = &contacts[index as usize];
            let tool_node = &scene.tools[t].tree.nodes()[contact.tool_sphere as usize];
            let between = centre(rotation, pose, &tool_node.centre)
                - object.tree.nodes()[contact.object_sphere as usize].centre;
            let distance = norm(&between);
            let normal = if distance > 1e-12 {
                between / distance
            } else {
                Vec3::z()
            };
            let core = object.tree.core_radius(contact.object_sphere, object.level);
            let gap = distance - tool_node.contact_radius - core;
            blender.push(Pair::new(index, gap, normal, distance));
        }
        let gap = blender.least(blend, limit);
        if gap < limit {
            reached[t].min_gap = gap;
        }
    }
    reached
        .iter()
        .fold(f64::INFINITY, |least, tool| fmin(least, tool.min_gap))
}

/// Gap of a pair at the present pose and shape, from the centres, not from the linearisation.
fn true_gap(
    scene: &Scene,
    state: &State,
    ws: &Workspace,
    (contact, rotation): (&Contact, &Mat3),
) -> f64 {
    let (t, k) = (usize::from(contact.tool), usize::from(contact.object));
    let (tool, object) = (&scene.tools[t], &scene.objects[k]);
    let tool_node = &tool.tree.nodes()[contact.tool_sphere as usize];
    let object_node = &object.tree.nodes()[contact.object_sphere as usize];
    let object_centre = if object.tissue.is_rigid() {
        object_node.centre
    } else {
        let mut moved = [Vec3::zeros()];
        let shape = &ws.shape[ws.shape_at[k]..ws.shape_at[k + 1]];
        object
            .tissue
            .model()
            .centres(&object.tree, shape, &[contact.object_sphere], &mut moved);
        moved[0]
    };
    let pose = &state.tools[t].graphic;
    let between = centre(rotation, pose, &tool_node.centre) - object_centre;
    norm(&between) - tool_node.contact_radius - object_node.contact_radius
}
