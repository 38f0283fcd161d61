//! Grouping of the contacts with blended objects: one group per pair of tool sphere and object.

use std::ops::Range;

use crate::MAX_TOOLS;
use crate::contact::Contact;
use crate::math::fmin;

/// Contacts of one tool sphere with one blended object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group {
    /// Index of the object.
    pub object: u16,
    /// Tool slot.
    pub tool: u8,
    /// Smallest core gap of the group's contacts at the pose of the substep, metres.
    smallest: f64,
    /// Lower bound of the blended gaps of the group at the pose of the substep, metres. Negative infinity until
    /// [`write_rows`](crate::rows::write_rows) has stored the bound of `Blender::rows`.
    pub least: f64,
    /// Start of the group's contacts in `Groups::order`.
    first: u32,
    /// Number of the group's contacts.
    count: u32,
}

/// Contacts with blended objects, grouped by tool sphere and object.
#[derive(Debug)]
pub(crate) struct Groups {
    /// Groups in the order of their first contacts in the contact list.
    pub all: Vec<Group>,
    /// Indices in the contact list, group by group, ascending within a group.
    order: Vec<u32>,
    /// Scratch: index in `all` of the group of each contact of the run in [`Groups::add`].
    of: Vec<u32>,
    /// Scratch of [`Groups::add`]: index in `all`, plus 1, of the group of each tool node; 0 for a node without a
    /// group. Node `n` of tool slot `t` is at `t * stride + n`.
    number: Vec<u32>,
    /// Number of nodes per tool slot in `number`.
    stride: usize,
}

impl Groups {
    /// Returns empty groups with capacity for `contacts` contacts and for tools of at most `nodes` nodes.
    pub fn with_capacity(contacts: usize, nodes: usize) -> Self {
        let nodes = if contacts > 0 { nodes } else { 0 };
        Self {
            all: Vec::with_capacity(contacts),
            order: Vec::with_capacity(contacts),
            of: Vec::with_capacity(contacts),
            number: vec![0; nodes * MAX_TOOLS],
            stride: nodes,
        }
    }

    /// Removes all groups.
    pub fn clear(&mut self) {
        self.all.clear();
        self.order.clear();
    }

    /// Groups a run of contacts with one object. `run` is a range of indices in `contacts`. `gap` returns the core gap
    /// of a contact, metres.
    pub fn add(&mut self, contacts: &[Contact], run: Range<usize>, gap: impl Fn(&Contact) -> f64) {
        let place = |contact: &Contact| {
            usize::from(contact.tool) * self.stride + contact.tool_sphere as usize
        };
        let before = self.all.len();
        self.of.clear();
        for contact in &contacts[run.clone()] {
            let number = &mut self.number[place(contact)];
            if *number == 0 {
                self.all.push(Group {
                    object: contact.object,
                    tool: contact.tool,
                    smallest: f64::INFINITY,
                    least: f64::NEG_INFINITY,
                    first: 0,
                    count: 0,
                });
                *number = self.all.len() as u32;
            }
            self.of.push(*number - 1);
            let group = &mut self.all[*number as usize - 1];
            group.count += 1;
            group.smallest = fmin(group.smallest, gap(contact));
        }
        let mut next = self.order.len();
        for group in &mut self.all[before..] {
            group.first = next as u32;
            next += std::mem::take(&mut group.count) as usize;
        }
        self.order.resize(next, 0);
        for (index, of) in run.zip(&self.of) {
            let group = &mut self.all[*of as usize];
            self.order[(group.first + group.count) as usize] = index as u32;
            group.count += 1;
        }
        for group in &self.all[before..] {
            let first = self.order[group.first as usize];
            self.number[place(&contacts[first as usize])] = 0;
        }
    }

    /// Returns the index in `all` of the group with the smallest core gap at the pose of the substep; `None` without
    /// groups.
    pub fn nearest(&self) -> Option<usize> {
        (0..self.all.len()).reduce(|best, k| {
            if self.all[k].smallest < self.all[best].smallest {
                k
            } else {
                best
            }
        })
    }

    /// Returns the indices in the contact list of the contacts of a group, ascending.
    pub fn contacts(&self, group: &Group) -> &[u32] {
        &self.order[group.first as usize..(group.first + group.count) as usize]
    }
}

impl Group {
    /// Whether no blended gap of the group can be under `limit` after a motion by at most `moved` since the pose of the
    /// substep. `false` means that a gap may be. `limit`, `moved` and the blend length `blend` are in metres.
    pub fn is_clear_of(&self, limit: f64, blend: f64, moved: f64) -> bool {
        // A motion changes every distance, and therefore the soft minimum, by at most `moved`.
        if self.least - moved >= limit {
            return true;
        }
        let spare = self.smallest - moved - limit;
        // The cheap bound, the logarithm of the next power of two, mostly saves the logarithm of the count.
        let most = std::f64::consts::LN_2 * f64::from(u32::BITS - self.count.leading_zeros());
        spare >= 0.0 && (spare >= blend * most || spare >= blend * libm::log(f64::from(self.count)))
    }
}
