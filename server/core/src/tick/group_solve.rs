//! Substeps of one group of tools: contact prediction, optimisation, step, check of the true gaps. Substeps repeat
//! until the step is small and every true gap is within its tolerance. The module `groups` decides which tools form a
//! group and which tissues belong to it.
//!
//! The trust region keeps the motion of the graphic tool plus that of the tissue under the prediction distance. Thus
//! the tool passes through no object between two substeps, at any speed. This is the continuous collision detection
//! that the paper left open.

use crate::contact::{Distance, Overflow, SMALLEST_PREDICTION};
use crate::math::{fclamp, fmax, fmin, norm};
use crate::output::status;
use crate::rows::{group_contacts, keep_smallest_gaps, write_rows};
use crate::state::State;
use crate::tick::collide::{Fits, collide};
use crate::tick::gaps::true_gaps;
use crate::tick::posed::posed;
use crate::tick::request::{TickRequest, TissueConflict, ToolOutcome, hands};
use crate::tick::settle::Settle;
use crate::tick::stage::{Stage, StageProbe};
use crate::tick::step::{Answer, apply, gives_way, keep_deepest, optimise};
use crate::tick::tissue_rows::aim_tissues;
use crate::tick::workspace::Workspace;
use crate::work::{most_contacts, solve_estimate};
use crate::{MAX_TOOLS, Params};

/// Factor by which the minimum prediction distance grows from substep to substep of a tick.
const WIDENING: f64 = 6.0;
/// Limit up to which the minimum prediction distance grows within a tick, metres; `Params::predict_min` if that is
/// larger. A prediction distance far beyond the motion only lists more rows.
const WIDEST: f64 = 5e-5;
/// Factor on `Params::predict_gain` for a group near a tissue that is out of rest. Tissue moves about as far as the
/// tool, and the prediction distance must cover both motions. Measured with the mirror on the tongue: at 1, three of
/// four ticks took a second substep. At 4, the additional rows cost as much as the saved substeps.
const YIELDS: f64 = 2.5;
/// Motion of the working point, metres, and turn, radians, beyond which contact prediction builds new lists of
/// neighbours: three quarters of their reach.
const FAR: (f64, f64) = (3.75e-5, 4.5e-3);

/// Run of the substeps of one group of tools in a tick: prediction distance, counters and outcomes so far.
pub(crate) struct GroupSolve<'a> {
    /// Slots of the group's tools, ascending.
    group: &'a [usize],
    /// Index of the group's substep in `Workspace::substeps`: the slot of the group's first tool.
    index: usize,
    /// Largest distance from the working point to the centre of a sphere, over all tools of the group, metres.
    longest: f64,
    /// Prediction distance per metre of motion: `Params::predict_gain`, times [`YIELDS`] if the group claims a tissue
    /// out of rest at the start of the tick.
    gain: f64,
    /// Prediction distance of the present or next substep: part common to all spheres, and turn.
    d: Distance,
    /// Minimum of the common part of the prediction distance in the next substeps, metres. Starts at
    /// `Params::predict_min`. Each substep without convergence raises the minimum by the factor [`WIDENING`], up to
    /// [`WIDEST`]. A tick of many substeps then advances in longer steps.
    floor: f64,
    /// Prediction distance and blend share that fitted after the last overflow of contact list or rows; `None` before
    /// any overflow. The next substep starts with at most twice this distance, because a new search costs more than all
    /// the rest.
    fits: Option<Fits>,
    substeps: u8,
    status: u16,
    converged: bool,
    outcomes: [ToolOutcome; MAX_TOOLS],
    settle: Settle,
    /// Whether the tool in each slot gives way to tissue in the present substep; see [`gives_way`].
    gives_way: [bool; MAX_TOOLS],
    /// Counted work of the last substep up to its rows, operations.
    listed: u64,
    /// Counted work of the last substep from its rows on, operations.
    solved: u64,
    /// Whether the limit on the change of force has shortened the step of the last substep.
    settled_last: bool,
}

impl<'a> GroupSolve<'a> {
    pub fn new(
        request: &TickRequest<'_>,
        state: &State,
        ws: &Workspace,
        group: &'a [usize],
    ) -> Self {
        let params = &request.scene.params;
        let mut solve = Self {
            group,
            index: group.first().copied().unwrap_or(0),
            longest: group.iter().fold(0.0, |most, &t| fmax(most, ws.levers[t])),
            gain: params.predict_gain * YIELDS,
            d: Distance::from(0.0),
            floor: params.predict_min,
            fits: None,
            substeps: 0,
            status: 0,
            converged: false,
            outcomes: [ToolOutcome::FREE; MAX_TOOLS],
            settle: Settle::new(request, state, ws, group),
            gives_way: [false; MAX_TOOLS],
            listed: 0,
            solved: 0,
            settled_last: false,
        };
        solve.d = solve.first_distance(request);
        solve
    }

    /// Returns the prediction distance of the first substep, from the largest motion and turn of the group's hands in
    /// this tick.
    fn first_distance(&self, request: &TickRequest<'_>) -> Distance {
        let moved = self.group.iter().map(|&t| request.goals[t].moved);
        let turned = self.group.iter().map(|&t| request.goals[t].turned);
        let most = |all: f64, one| fmax(all, one);
        self.distance(request, moved.fold(0.0, most), turned.fold(0.0, most))
    }

    /// Returns the prediction distance of a substep in which the tools may move by `moved` (metres) and turn by
    /// `turned` (radians). A turn moves spheres by their levers, so spheres near the tip need less distance than the
    /// shaft.
    fn distance(&self, request: &TickRequest<'_>, moved: f64, turned: f64) -> Distance {
        let params = &request.scene.params;
        let base = fclamp(
            self.gain * moved + params.predict_bias,
            self.floor,
            params.predict_max,
        );
        let most = (params.predict_max - base) / fmax(self.longest, 1e-9);
        Distance {
            base,
            turn: fmin(params.predict_gain * turned, most),
        }
    }

    /// Claims every tissue out of rest that a tool may meet in the first substep. The distance to the tool is within
    /// the prediction distance, or within the motion of the tissue back to its free shape. A group without such a
    /// tissue falls back to the prediction distance for rigid objects.
    ///
    /// # Errors
    /// Another group has claimed such a tissue.
    pub fn claim_tissues(
        &mut self,
        request: &TickRequest<'_>,
        state: &State,
        ws: &mut Workspace,
    ) -> Result<(), TissueConflict> {
        let scene = request.scene;
        for &t in self.group {
            if ws.awake.is_empty() {
                break;
            }
            let posed = posed(scene, state, t);
            ws.predictor.begin(&posed);
            for at in 0..ws.awake.len() {
                let Workspace {
                    predictor,
                    broad,
                    yielding,
                    slots,
                    zeros,
                    awake,
                    owners,
                    any,
                    levers,
                    ..
                } = &mut *ws;
                let slot = awake[at];
                let (object, relaxing) = (yielding[slot].object, yielding[slot].relaxing);
                if yielding[slot].still || owners[slot] == Some(self.index) {
                    continue;
                }
                let d = Distance {
                    base: fmax(self.d.base, relaxing / scene.params.trust),
                    turn: self.d.turn,
                };
                let displaced =
                    |k: usize| slots[k].map_or(0.0, |slot| yielding[slot].displaced(zeros));
                let near = broad.near(scene, predictor, &posed, (d, levers[t]), displaced);
                if near.binary_search(&(object as u16)).is_err() {
                    continue;
                }
                any.begin(1, Overflow::Stop);
                let found = yielding[slot].predict(scene, predictor, &posed, d, any);
                if found.is_err() || !any.as_slice().is_empty() {
                    claim_tissue(ws, slot, self.index)?;
                }
            }
        }
        if ws.substeps[self.index].tissues.is_empty() {
            self.gain = request.scene.params.predict_gain;
            self.d = self.first_distance(request);
        }
        Ok(())
    }

    /// Lists the contacts of the next substep, writes their rows, and claims every tissue among them. Returns whether
    /// the substep takes place: false if its rows are more than the bound on the work of the tick allows.
    ///
    /// # Errors
    /// Another group has claimed such a tissue.
    pub fn predict_contacts<P: StageProbe>(
        &mut self,
        request: &TickRequest<'_>,
        state: &State,
        ws: &mut Workspace,
        probe: &mut P,
    ) -> Result<bool, TissueConflict> {
        let (scene, index) = (request.scene, self.index);
        let first = self.substeps == 0;
        let bounded = scene.params.max_work > 0;
        if bounded && !first {
            std::mem::swap(&mut ws.substeps[index].contacts, &mut ws.solved);
        }
        self.substeps += 1;
        let begun = ws.counts.work();
        ws.counts.passes += self.group.len() as u64;
        probe.begin(Stage::Collide);
        if let Some(fits) = self.fits {
            self.d.base = fmin(self.d.base, 2.0 * fits.d.base);
            self.d.turn = fmin(self.d.turn, 2.0 * fits.d.turn);
        }
        let share = self.fits.map_or(1.0, |fits| fits.share);
        let limit = self.most_contacts(request);
        let (found, mut cut) = collide(scene, state, ws, (self.group, limit), (self.d, share));
        self.d = found.d;
        // Once out of the tissue, the tool turns to the hand for the rest of the tick.
        let overlaps = first || self.gives_way.contains(&true);
        let contacts = ws.substeps[index].contacts.as_slice();
        self.gives_way = if overlaps {
            gives_way(state, self.group, contacts, &ws.slots)
        } else {
            [false; MAX_TOOLS]
        };
        group_contacts(scene, &mut ws.substeps[index], &ws.cores);
        // Rows without room shorten the prediction distance, as a full contact list does. The contact list stays valid.
        let mut narrowed = false;
        loop {
            // Rows of tool spheres that had room then reach farther, which does no harm.
            let blending = (ws.cores.as_slice(), &mut ws.blender);
            let substep = &mut ws.substeps[index];
            let room = write_rows(scene, substep, blending, (self.d, narrowed));
            if self.gives_way.contains(&true) {
                // More pairs overlap than a problem has rows.
                keep_deepest(substep, &ws.slots);
            }
            if room < 1.0 {
                cut = true;
                self.d = self.d.shortened(room, self.longest);
            }
            if ws.substeps[index].contact_rows.len() <= scene.most_rows() {
                break;
            }
            (cut, narrowed) = (true, true);
            if self.d.at(self.longest) <= SMALLEST_PREDICTION {
                let contact_rows = &mut ws.substeps[index].contact_rows;
                keep_smallest_gaps(contact_rows, &mut ws.gaps, scene.most_rows());
                break;
            }
            self.d = self.d.shorter(self.longest);
        }
        ws.counts.add_blending(ws.blender.take_effort());
        if cut {
            self.status |= status::CONTACTS_FULL;
            self.fits = Some(Fits { d: self.d, ..found });
        }
        let mut next = 0;
        while let Some(contact) = ws.substeps[index].contacts.as_slice().get(next) {
            let object = contact.object;
            let rest = &ws.substeps[index].contacts.as_slice()[next..];
            next += rest.partition_point(|contact| contact.object == object);
            let Some(slot) = ws.slots[usize::from(object)] else {
                continue;
            };
            claim_tissue(ws, slot, index)?;
            let yielding = &mut ws.yielding[slot];
            if !yielding.is_evaluated() {
                let hands = hands(scene, state, request.held, request.detail);
                let moved = yielding.evaluate(state, slot, &hands);
                ws.broad.object_moved(yielding.object, moved);
                ws.counts.tissue += yielding.effort().step;
                ws.awake.push(slot);
            }
        }
        self.listed = ws.counts.work() - begun;
        let rows = ws.substeps[index].contact_rows.len();
        if bounded && !first && !self.solve_fits(&scene.params, ws, rows) {
            // The loads of the tick are those of the contacts that were solved.
            std::mem::swap(&mut ws.substeps[index].contacts, &mut ws.solved);
            self.substeps -= 1;
            return Ok(false);
        }
        Ok(true)
    }

    /// Solves the substep and moves tools, tissue and loads. Returns whether another substep is due: false after
    /// convergence, a failure of the solver, or `Params::max_substeps` substeps.
    pub fn solve_and_step<P: StageProbe>(
        &mut self,
        request: &TickRequest<'_>,
        state: &mut State,
        ws: &mut Workspace,
        probe: &mut P,
    ) -> bool {
        let (scene, index) = (request.scene, self.index);
        let params = &scene.params;
        probe.begin(Stage::Optimise);
        let begun = ws.counts.work();
        let target = optimise(request, state, ws, self.group, &self.gives_way);
        let Some(Answer {
            steps: step,
            settled,
        }) = target
        else {
            // An unusable solution is never applied: pose and load stay as they are.
            self.status |= status::SOLVER_FAILED;
            ws.substeps[index].applied = None;
            return false;
        };
        let tissues = ws.yielding.as_mut_slice();
        let scratch = (&mut ws.sites, &mut ws.site_loads);
        let tissue_motion = aim_tissues(&ws.substeps[index], tissues, scratch, &mut ws.counts);
        let (mut motion, mut moved, mut turned, mut share) = (tissue_motion, 0.0, 0.0, 1.0);
        for &t in self.group {
            let (v, w) = (norm(&step[t].0) + tissue_motion, norm(&step[t].1));
            (moved, turned) = (fmax(moved, v), fmax(turned, w));
            motion = fmax(motion, v + w * ws.levers[t]);
            // Motion and limit are both linear in the lever: a share valid at both ends is valid between.
            for lever in [0.0, ws.levers[t]] {
                let (motion, allowed) = (v + w * lever, params.trust * self.d.at(lever));
                if motion > allowed {
                    share = fmin(share, allowed / motion);
                }
            }
        }
        let eased = self.settle.share(state, ws, self.group);
        let settling = eased < share;
        let share = fmin(share, eased);
        apply(scene, state, ws, self.group, &step, share);
        ws.substeps[index].applied = Some(share);
        // Safety margin of 1 % on the linear bound of the motion.
        let gone = Distance {
            base: 1.01 * share * moved,
            turn: 1.01 * share * turned,
        };
        for tool in &mut self.outcomes {
            tool.min_gap = f64::INFINITY;
        }
        let deepest = true_gaps(scene, state, ws, index, (self.d, gone), &mut self.outcomes);
        let free = ws.substeps[index].contacts.as_slice().is_empty();
        let small = motion <= params.converged_step || free;
        if share == 1.0 && small && settled && deepest >= -params.converged_gap {
            self.converged = true;
            if self.gives_way.contains(&true) {
                // The tissue is out of the tool's way. The next tick turns to the hand.
                self.status |= status::SETTLING;
            }
            return false;
        }
        if settling && deepest >= -params.converged_gap {
            self.status |= status::SETTLING;
            self.converged = true;
            return false;
        }
        // A tick with many substeps must not be limited by a short prediction distance in each.
        self.floor = fmin(WIDENING * self.floor, fmax(params.predict_min, WIDEST));
        let listed_within = self.d.at(self.longest);
        self.d = self.distance(request, moved * (1.0 - share), turned * (1.0 - share));
        if gone.base > FAR.0 || gone.turn > FAR.1 {
            ws.counts.moved += self.group.iter().map(|&t| ws.spheres[t]).sum::<u64>();
        }
        self.solved = ws.counts.work() - begun;
        // At the limit of the change of force another substep has no room to move.
        let stands = std::mem::replace(&mut self.settled_last, settling) && settling;
        // A list within a much shorter distance has fewer contacts. Its rows tell what their solution takes.
        let next = if self.d.at(self.longest) <= 0.5 * listed_within {
            self.listed / 2
        } else {
            self.listed + self.solved
        };
        let fits = ws.counts.work() + next <= u64::from(params.max_work);
        let goes_on = params.max_work == 0 || (fits && !stands);
        self.substeps < params.max_substeps && goes_on
    }

    /// Returns the largest number of contacts of a substep. The tools present share the number that fits into the bound
    /// on the work of the tick.
    fn most_contacts(&self, request: &TickRequest<'_>) -> usize {
        let params = &request.scene.params;
        let present = request.held.iter().flatten().count().max(1);
        let of_tool = request.scene.most_contacts();
        of_tool.min(most_contacts(params.max_work) / present) * self.group.len()
    }

    /// Whether the solve of a substep with `rows` rows fits into the bound on the work of the tick.
    fn solve_fits(&self, params: &Params, ws: &Workspace, rows: usize) -> bool {
        let contacts = ws.substeps[self.index].contacts.as_slice().len();
        let estimate = solve_estimate(contacts, rows, !ws.substeps[self.index].tissues.is_empty());
        ws.counts.work() + estimate <= u64::from(params.max_work)
    }

    /// Writes the outcomes of the group's tools to `all`.
    pub fn finish(mut self, ws: &Workspace, all: &mut [ToolOutcome; MAX_TOOLS]) {
        let failed = self.status & status::SOLVER_FAILED != 0;
        if !self.converged && !failed {
            self.status |= status::EXHAUSTED;
        }
        let substep = &ws.substeps[self.index];
        for &t in self.group {
            let ours = || {
                let loads = substep.rows.iter().zip(&substep.solution.lambda);
                loads.filter(|(row, _)| usize::from(row.tool) == t)
            };
            let outcome = &mut self.outcomes[t];
            outcome.rows = ours().count() as u16;
            // Multipliers of an unusable solution load nothing.
            outcome.active = if failed {
                0
            } else {
                ours().filter(|(_, load)| **load > 0.0).count() as u16
            };
            outcome.status = self.status;
            outcome.substeps = self.substeps;
            outcome.converged = self.converged;
            all[t] = *outcome;
        }
    }
}

/// Claims the tissue `slot` (index in `Workspace::yielding`) for the group with the substep `index` (in
/// `Workspace::substeps`).
///
/// # Errors
/// Another group has claimed the tissue.
fn claim_tissue(ws: &mut Workspace, slot: usize, index: usize) -> Result<(), TissueConflict> {
    match ws.owners[slot] {
        Some(owner) if owner == index => Ok(()),
        Some(_) => Err(TissueConflict),
        None => {
            ws.owners[slot] = Some(index);
            ws.substeps[index].tissues.push(slot);
            Ok(())
        }
    }
}
