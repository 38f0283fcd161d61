//! Optimisation and step of one substep: the problem of the rows, its solution, and the motion by a share of it.

use crate::contact::Contact;
use crate::math::{Vec3, Wrench, exp_rotation};
use crate::optimise::active_set::Effort;
use crate::optimise::{
    ContactSolver, Problem, ProblemRow, SolveStatus, SolverKind, UNKNOWNS, clarabel::Clarabel,
};
use crate::rows::bend;
use crate::rows::metric::Metric;
use crate::state::{Arrival, State};
use crate::tick::haptic::{renormalised, twist};
use crate::tick::posed::substep_of;
use crate::tick::request::TickRequest;
use crate::tick::substep::Substep;
use crate::tick::tissue_rows::fill_tissue;
use crate::tick::workspace::Workspace;
use crate::{MAX_TOOLS, Scene};

/// Share of the coupling's stiffness that holds an arriving tool in place while it overlaps tissue. Chosen: at 0.5 N/mm
/// the tool gives way by 4 mm before the hand feels 0.02 N.
const HELD_WEAKLY: f64 = 0.01;
/// Depth in tissue, metres, from which an arriving tool gives way. Chosen: far above the depth that a tick leaves, and
/// out of the tissue within a tick or two.
pub(crate) const OVERLAP: f64 = 1e-5;

/// Step of each tool, by slot: translation of the working point (metres) and rotation vector (radians), world axes.
pub(crate) type Steps = [(Vec3, Vec3); MAX_TOOLS];

/// Returns, by slot, which of the group's tools give way to tissue in this substep.
///
/// Tissue relaxes into an absent tool. After its entry such a tool would be pressed out of the tissue against its
/// coupling, which the hand would feel as a blow. The tool is therefore held only weakly ([`HELD_WEAKLY`]) as long as
/// it overlaps the tissue.
pub(crate) fn gives_way(
    state: &State,
    group: &[usize],
    contacts: &[Contact],
    slots: &[Option<usize>],
) -> [bool; MAX_TOOLS] {
    let mut found = [false; MAX_TOOLS];
    let arrives = |t: &usize| state.tools[*t].arrival == Arrival::Travelling;
    if group.iter().any(&arrives) {
        for contact in contacts {
            let t = usize::from(contact.tool);
            found[t] |= contact.gap < -OVERLAP
                && slots[usize::from(contact.object)].is_some()
                && arrives(&t);
        }
    }
    found
}

/// Drops the rows of all pairs of tissue spheres but the deepest of each sphere. `slots` tells which objects yield.
pub(crate) fn keep_deepest(substep: &mut Substep, slots: &[Option<usize>]) {
    let contacts = substep.contacts.as_slice();
    // Rows of one sphere of tissue are adjacent.
    substep.contact_rows.dedup_by(|row, kept| {
        let (one, other) = (
            &contacts[row.contact as usize],
            &contacts[kept.contact as usize],
        );
        let same = (one.object, one.object_sphere, one.tool)
            == (other.object, other.object_sphere, other.tool)
            && slots[usize::from(one.object)].is_some();
        if same && row.gap < kept.gap {
            *kept = *row;
        }
        same
    });
}

/// Builds and solves the problem of this substep and returns the steps of the group's tools. Returns `None` when the
/// solution is unusable. `gives_way` is that of [`gives_way`].
pub(crate) fn optimise(
    request: &TickRequest<'_>,
    state: &State,
    ws: &mut Workspace,
    group: &[usize],
    gives_way: &[bool; MAX_TOOLS],
) -> Option<Answer> {
    let (scene, goals) = (request.scene, request.goals);
    let index = substep_of(group);
    let mut free_step = [0.0; UNKNOWNS];
    let mut metrics = [Metric::UNIT; MAX_TOOLS];
    for &t in group {
        let (tool, now) = (&scene.tools[t], &state.tools[t]);
        if gives_way[t] {
            // No goal: the tool stays where it is, as far as the tissue allows.
            metrics[t] = Metric::weak(tool, HELD_WEAKLY);
            continue;
        }
        let v = goals[t].haptic.transform(&tool.working_point)
            - now.graphic.transform(&tool.working_point);
        let (w, _) = twist(
            &goals[t].haptic.orientation,
            &now.graphic.orientation,
            &now.twist_axis,
        );
        let mut metric = Metric::of(tool);
        bend(scene, &ws.substeps[index], t, &v, &mut metric);
        let free = metric.scaled_free_step(&v, &w);
        free_step[6 * t..6 * t + 6].copy_from_slice(&free);
        metrics[t] = metric;
    }
    let substep = &mut ws.substeps[index];
    substep.rows.clear();
    for row in &substep.contact_rows {
        let contact = &substep.contacts.as_slice()[row.contact as usize];
        let t = usize::from(contact.tool);
        let a = metrics[t].scaled_row(&row.normal, &contact.arm.cross(&row.normal));
        let bias = row.gap + crate::optimise::dot6(&a, &free_step[6 * t..6 * t + 6]);
        substep.rows.push(ProblemRow {
            a,
            tool: contact.tool,
            bias,
        });
    }
    let substep = &mut ws.substeps[index];
    let noted = (&mut ws.sites, &mut ws.counts);
    let tissue = fill_tissue(substep, &mut ws.yielding, &ws.slots, noted);
    if tissue {
        ws.substeps[index].find_bearing();
    }
    let Substep {
        rows,
        solution,
        gram,
        warm_start,
        ..
    } = &mut ws.substeps[index];
    let problem = Problem {
        rows,
        tissue: tissue.then(|| &gram[..rows.len() * rows.len()]),
        contact_compliance: scene.params.contact_compliance,
        warm_start: if tissue { warm_start } else { &[] },
        max_iterations: usize::from(scene.params.max_iterations),
    };
    match scene.params.solver {
        SolverKind::ActiveSet => ws.active_set.solve(&problem, solution),
        SolverKind::Clarabel => Clarabel.solve(&problem, solution),
    }
    let effort = match scene.params.solver {
        SolverKind::ActiveSet => ws.active_set.effort,
        SolverKind::Clarabel => Effort::default(),
    };
    ws.counts.add_solve(problem.rows.len(), effort);
    let solved = solution.status == SolveStatus::Solved;
    let y = solution.y;
    ws.substeps[index].share_out();
    if tissue && solved {
        ws.substeps[index].note_bearing();
    }
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

/// Usable solution of a substep's problem, as steps of the tools.
pub(crate) struct Answer {
    /// Step of each tool, by slot.
    pub steps: Steps,
    /// Whether the forces on all tools of the group are those of the coupling. False if the curvature of a blended
    /// surface, added to the metric of a tool, contributes more force than its tolerance.
    pub settled: bool,
}

/// Moves the group's tools, tissues and loads by the same `share` (0 to 1) of the way to the solution of the substep.
pub(crate) fn apply(
    scene: &Scene,
    state: &mut State,
    ws: &mut Workspace,
    group: &[usize],
    steps: &Steps,
    share: f64,
) {
    for &slot in &ws.substeps[substep_of(group)].tissues {
        let yielding = &mut ws.yielding[slot];
        let moved = yielding.advance(share);
        ws.broad.object_moved(yielding.object, moved);
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
        for (contact, lambda) in ws.substeps[substep_of(group)].loaded() {
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
            if *target == Wrench::ZERO && *load == Wrench::ZERO {
                // Turns -0.0 into 0.0: the bytes of the state omit only plain zeros.
                *load = Wrench::ZERO;
                continue;
            }
            let target = target.moved(&at);
            load.force += (target.force - load.force) * share;
            load.torque += (target.torque - load.torque) * share;
        }
    }
}
