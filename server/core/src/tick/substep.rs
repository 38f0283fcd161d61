//! One pass of a tick: contacts, the problem made of them, and its answer.

use crate::blend::{ContactRow, Groups, MAX_SEEDS, Member};
use crate::contact::{Contact, ContactList, Overflow};
use crate::optimise::{ProblemRow, Solution};

/// Gap under which a row is taken to have borne load at the end of the last tick, metres: what touched then has none,
/// and the tick begins where that one ended.
const TOUCHING: f64 = 1e-6;

/// Contacts, problem and answer of the last pass of one group of tools.
#[derive(Debug)]
pub(crate) struct Substep {
    pub contacts: ContactList,
    /// What each row is about.
    pub contact_rows: Vec<ContactRow>,
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
    pub warm_start: Vec<u32>,
    /// Compliance of the tissue in the rows' directions, row by row; none in a scene where nothing yields.
    pub gram: Vec<f64>,
    /// Whether it belongs to this pass.
    pub tissue: bool,
    /// Places in [`Workspace::yielding`] of the tissues that this group's tools came near in this tick.
    pub tissues: Vec<usize>,
    /// Share of its answer that was applied; none where the solver had no usable one.
    pub applied: Option<f64>,
}

impl Substep {
    /// Room for so many rows, and so many that share a dense matrix.
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

    /// Remembers which contacts' rows bear load.
    pub fn note_bearing(&mut self) {
        self.bearing.clear();
        let contacts = self.contacts.as_slice();
        let loads = self.contact_rows.iter().zip(&self.solution.lambda);
        let bearing = loads.filter(|(_, load)| **load > 0.0);
        self.bearing
            .extend(bearing.map(|(row, _)| contacts[row.contact as usize].key()));
        self.bearing.sort_unstable();
    }

    /// Finds the rows with which the solver begins: of the contacts that bore load in the last pass, or in a tick's first
    /// that touch already.
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
