//! Contact prediction (the paper's CCP, section 3.2): tree against tree, with the graphic tool's
//! spheres grown by `d`.
//!
//! Every pair of contact spheres closer than `d` becomes a [`Contact`]; as long as no sphere moves
//! more than `d` before the next pass, no pair outside the list can touch. The tick's trust
//! region keeps that promise, which makes this a continuous collision detection.
//!
//! The plain way is to traverse both trees anew in every pass (`dual`). What a tool cannot come near is left out (`broad`). What was near is kept while the tool
//! stays near: for what is rigid the families of spheres (`neighbours`), found by `front` in a layout for it
//! (`packs`), for what yields the pairs of spheres (`soft`; by `front`, too, or where its spheres are large
//! by `coarse`). Which of the ways answered never shows in the answer.

pub(crate) mod broad;
mod coarse;
mod dual;
mod front;
mod neighbours;
mod packs;
mod posed;
mod predictor;
pub(crate) mod soft;
#[cfg(test)]
mod tests;

pub(crate) use dual::STACK;
pub use posed::PosedTool;
pub(crate) use posed::reach_of;
pub use predictor::{Predictor, Work};

use crate::math::{Mat3, Pose, Vec3};
use crate::tissue::Site;

/// A pair of contact spheres close enough to touch before the next pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Tool slot.
    pub tool: u8,
    /// Index of the object.
    pub object: u16,
    /// Node of the object's tree.
    pub object_sphere: u32,
    /// Node of the tool's tree.
    pub tool_sphere: u32,
    /// Unit normal from the object's sphere to the tool's, world axes.
    pub normal: Vec3,
    /// True gap between the two spheres at the pose of the pass, metres; negative is penetration.
    pub gap: f64,
    /// Centre of the tool's sphere minus the tool's working point, world axes, metres.
    pub arm: Vec3,
}

impl Contact {
    /// Order of the rows: by object, object sphere, tool, tool sphere.
    #[inline]
    pub fn key(&self) -> (u16, u32, u8, u32) {
        (self.object, self.object_sphere, self.tool, self.tool_sphere)
    }

    /// What the object's tissue sees of it.
    #[inline]
    pub fn site(&self) -> Site {
        Site {
            sphere: self.object_sphere,
            normal: self.normal,
        }
    }
}

/// The contacts of one pass, at most `limit` of them: a number of its own, not a `Vec`'s capacity,
/// which an allocator may round up.
#[derive(Debug)]
pub struct ContactList {
    contacts: Vec<Contact>,
    limit: usize,
    overflow: Overflow,
}

/// What happens to a contact that finds the list full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// The query ends: the caller asks again with a smaller distance.
    Stop,
    /// The contact with the largest gap makes room, if it is larger.
    KeepSmallestGaps,
}

impl ContactList {
    /// An empty list with room for `most` contacts in any query.
    pub fn with_capacity(most: usize) -> Self {
        Self {
            contacts: Vec::with_capacity(most),
            limit: most,
            overflow: Overflow::Stop,
        }
    }

    /// Empties the list for a query of at most `limit` contacts.
    pub fn begin(&mut self, limit: usize, overflow: Overflow) {
        self.contacts.clear();
        (self.limit, self.overflow) = (limit, overflow);
    }

    /// What was found, in no particular order until [`ContactList::sort`].
    #[inline]
    pub fn as_slice(&self) -> &[Contact] {
        &self.contacts
    }

    /// Sorts by [`Contact::key`].
    /// Contacts that come in order, as they do for one tool among rigid things, cost one look each.
    pub fn sort(&mut self) {
        self.contacts.sort_unstable_by_key(Contact::key);
    }

    #[inline(always)]
    fn push(&mut self, contact: Contact) -> Result<(), ContactsFull> {
        // One more than this and the list is full, which is rare.
        if self.contacts.len() + 1 < self.limit {
            self.contacts.push(contact);
            return Ok(());
        }
        self.push_last(contact)
    }

    #[cold]
    fn push_last(&mut self, contact: Contact) -> Result<(), ContactsFull> {
        if self.contacts.len() < self.limit {
            self.contacts.push(contact);
            if self.overflow == Overflow::KeepSmallestGaps && self.contacts.len() == self.limit {
                for at in (0..self.limit / 2).rev() {
                    self.sift_down(at);
                }
            }
            return Ok(());
        }
        match self.overflow {
            Overflow::Stop => Err(ContactsFull),
            Overflow::KeepSmallestGaps => {
                if self
                    .contacts
                    .first()
                    .is_some_and(|worst| outranks(worst, &contact))
                {
                    self.contacts[0] = contact;
                    self.sift_down(0);
                }
                Ok(())
            }
        }
    }

    /// Restores the heap (largest gap first) below `at`.
    fn sift_down(&mut self, mut at: usize) {
        loop {
            let mut largest = at;
            for child in [2 * at + 1, 2 * at + 2] {
                if child < self.contacts.len()
                    && outranks(&self.contacts[child], &self.contacts[largest])
                {
                    largest = child;
                }
            }
            if largest == at {
                return;
            }
            self.contacts.swap(at, largest);
            at = largest;
        }
    }
}

/// Whether `a` goes before `b` does when room is short: larger gap, then larger key, so that the
/// choice does not depend on the order of the query.
fn outranks(a: &Contact, b: &Contact) -> bool {
    a.gap > b.gap || (a.gap == b.gap && a.key() > b.key())
}

/// By how much a distance shrinks where a list has no room. Finer steps cost more queries of a fast tool and let it go
/// farther in a tick.
pub(crate) const SHORTER: f64 = 0.7;
/// Prediction distance at which full lists keep the smallest gaps, metres.
pub(crate) const SMALLEST_PREDICTION: f64 = 1e-6;

/// How close spheres must be to count: `base + turn * lever`, with the lever of the tool's sphere from
/// the working point. A tool that moves by `base` and turns by `turn` carries no sphere farther.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// The same for every sphere, metres.
    pub base: f64,
    /// Per metre of lever, radians.
    pub turn: f64,
}

impl Distance {
    /// For a sphere with this lever, metres.
    #[inline]
    pub fn at(&self, lever: f64) -> f64 {
        self.base + self.turn * lever
    }

    /// So much shorter that fewer contacts are within it, no less than [`SMALLEST_PREDICTION`]; the turn's part goes altogether where little is left
    /// at the longest lever.
    pub(crate) fn shorter(&self, longest: f64) -> Self {
        self.shortened(SHORTER, longest)
    }

    /// The same, `share` as long.
    pub(crate) fn shortened(&self, share: f64, longest: f64) -> Self {
        Self {
            base: crate::math::fmax(share * self.base, SMALLEST_PREDICTION),
            turn: if self.at(longest) > 2.0 * SMALLEST_PREDICTION {
                share * self.turn
            } else {
                0.0
            },
        }
    }
}

impl From<f64> for Distance {
    fn from(base: f64) -> Self {
        Self { base, turn: 0.0 }
    }
}

/// The list of contacts is full: what it holds is not all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactsFull;

/// Factor of how long what is known of object `k` holds: of about 1, and other for each, so that not all of them end in one tick.
pub(crate) fn spread(k: usize) -> f64 {
    0.75 + 0.5 * (k as f64 * 0.618_033_988_75).fract()
}

/// World position of a point of the tool.
#[inline]
pub(crate) fn centre(rotation: &Mat3, pose: &Pose, point: &Vec3) -> Vec3 {
    pose.position + rotation * point
}
