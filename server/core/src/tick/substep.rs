//! Substep of a tick: contacts, the problem made of them, and its solution.

use crate::blend::{ContactRow, Groups, MAX_SEEDS, Member};
use crate::contact::{Contact, ContactList, Overflow};
use crate::optimise::{ProblemRow, Solution};

/// Gap under which a row counts as loaded at the end of the last tick, metres. A row touched then has no gap, and the
/// tick starts from that pose.
const TOUCHING: f64 = 1e-6;

/// Contacts, problem and solution of the last substep of one group of tools.
#[derive(Debug)]
pub(crate) struct Substep {
    pub contacts: ContactList,
    /// Contact rows, in the order of `rows`.
    pub contact_rows: Vec<ContactRow>,
    /// Contacts with blended objects, grouped by tool sphere and object.
    pub groups: Groups,
    /// Members of the blended rows, row by row.
    pub members: Vec<Member>,
    pub rows: Vec<ProblemRow>,
    /// Load on each contact, newtons: the multiplier of its row, or the sum of its shares of blended rows.
    pub shares: Vec<f64>,
    pub solution: Solution,
    /// Keys of the contacts whose rows bore load in the previous substep of this tick, sorted.
    pub bearing: Vec<(u16, u32, u8, u32)>,
    /// Warm start of the solver, indices in `rows`: rows of the contacts in `bearing`, or the touching rows if
    /// `bearing` is empty.
    pub warm_start: Vec<u32>,
    /// Compliance of the tissue between the rows, m/N: motion along the normal of one row for a unit load on another.
    /// The first `m * m` entries are in use for `m` rows, row-major. Empty in a scene without yielding objects.
    pub gram: Vec<f64>,
    /// Whether `gram` is part of the problem of this substep.
    pub tissue: bool,
    /// Indices in `Workspace::yielding` of the tissues that the group has claimed in this tick.
    pub tissues: Vec<usize>,
    /// Share of the step that was applied, 0 to 1; `None` without a usable solution.
    pub applied: Option<f64>,
}

impl Substep {
    /// Returns an empty substep with capacity for `rows` contacts and rows, for `dense` rows in the dense matrix and
    /// for `tissues` tissues. `blended` tells whether the scene has blended objects. `tool_nodes` is the largest number
    /// of nodes of a tool.
    pub fn with_capacity(
        (rows, dense): (usize, usize),
        blended: bool,
        tool_nodes: usize,
        tissues: usize,
    ) -> Self {
        Self {
            contacts: ContactList::with_capacity(rows),
            contact_rows: Vec::with_capacity(rows),
            groups: Groups::with_capacity(if blended { rows } else { 0 }, tool_nodes),
            members: Vec::with_capacity(if blended { rows * MAX_SEEDS } else { 0 }),
            shares: Vec::with_capacity(rows),
            rows: Vec::with_capacity(rows),
            solution: Solution::with_capacity(rows),
            bearing: Vec::with_capacity(rows),
            warm_start: Vec::with_capacity(rows),
            gram: vec![0.0; dense * dense],
            tissue: false,
            tissues: Vec::with_capacity(tissues),
            applied: Some(1.0),
        }
    }

    pub fn clear(&mut self) {
        self.applied = Some(1.0);
        self.contacts.begin(0, Overflow::Stop);
        self.contact_rows.clear();
        self.groups.clear();
        self.members.clear();
        self.rows.clear();
        self.shares.clear();
        self.solution.lambda.clear();
        self.bearing.clear();
        self.tissue = false;
        self.tissues.clear();
    }

    /// Stores the keys of the contacts whose rows bear load in `bearing`, for the warm start of the next substep.
    pub fn note_bearing(&mut self) {
        self.bearing.clear();
        let contacts = self.contacts.as_slice();
        let loads = self.contact_rows.iter().zip(&self.solution.lambda);
        let bearing = loads.filter(|(_, load)| **load > 0.0);
        self.bearing
            .extend(bearing.map(|(row, _)| contacts[row.contact as usize].key()));
        self.bearing.sort_unstable();
    }

    /// Selects the rows with which the solver starts: rows of the contacts that bore load in the previous substep.
    /// Without such contacts, as in the first substep of a tick, the touching rows are selected.
    pub fn find_bearing(&mut self) {
        self.warm_start.clear();
        if self.bearing.is_empty() {
            let contact_rows = self.contact_rows.iter().enumerate();
            let touching = contact_rows.filter(|(_, row)| row.gap < TOUCHING);
            self.warm_start.extend(touching.map(|(i, _)| i as u32));
            return;
        }
        let contacts = self.contacts.as_slice();
        for (i, row) in self.contact_rows.iter().enumerate() {
            let key = contacts[row.contact as usize].key();
            if self.bearing.binary_search(&key).is_ok() {
                self.warm_start.push(i as u32);
            }
        }
    }

    /// Returns each contact with its load, newtons.
    pub fn loaded(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.contacts
            .as_slice()
            .iter()
            .zip(self.shares.iter().copied())
    }

    /// Distributes the multipliers of the rows to the contacts: writes `shares`, newtons.
    pub fn share_out(&mut self) {
        self.shares.clear();
        self.shares.resize(self.contacts.as_slice().len(), 0.0);
        for (row, lambda) in self.contact_rows.iter().zip(&self.solution.lambda) {
            if row.members == 0 {
                self.shares[row.contact as usize] = *lambda;
            } else if *lambda > 0.0 {
                let first = row.first as usize;
                for member in &self.members[first..first + row.members as usize] {
                    self.shares[member.contact as usize] += member.weight * lambda;
                }
            }
        }
    }
}
