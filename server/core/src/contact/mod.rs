//! Contact prediction (CCP, section 3.2 of the paper): tree against tree, with the graphic tool's spheres grown by the
//! prediction distance `d`.
//!
//! Every pair of contact spheres closer than `d` becomes a [`Contact`]. No pair outside the list can touch while no
//! sphere moves more than `d` before the next pass. The trust region of the tick enforces this limit, which makes the
//! method a continuous collision detection.
//!
//! - `dual`: plain traversal of both trees in every pass. The reference, without a cache.
//! - `broad`: skips objects that a tool cannot reach.
//! - `neighbours`: cached pairs (family of spheres, tool sphere) for rigid objects. `front` builds the lists in the
//!   layout of `packs`.
//! - `near`: whether any pair is within a distance, with a limit on the work. For [`crate::clearance`], not for ticks.
//! - `soft`: cached pairs of spheres for tissues. `front` builds the lists, or `coarse` for a tissue with large
//!   spheres.
//!
//! All methods give the same contacts, bit for bit.

pub(crate) mod broad;
mod coarse;
mod dual;
mod front;
pub(crate) mod near;
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

/// Pair of contact spheres that may touch before the next pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Tool slot.
    pub tool: u8,
    /// Index of the object.
    pub object: u16,
    /// Index of the node in the object's tree.
    pub object_sphere: u32,
    /// Index of the node in the tool's tree.
    pub tool_sphere: u32,
    /// Unit normal from the object's sphere to the tool's, world axes.
    pub normal: Vec3,
    /// True gap between the two contact spheres at the pose of the pass, metres; negative is penetration.
    pub gap: f64,
    /// Centre of the tool's sphere minus the tool's working point, world axes, metres.
    pub arm: Vec3,
}

impl Contact {
    /// Returns the sort key of the contact: object, object sphere, tool, tool sphere.
    #[inline]
    pub fn key(&self) -> (u16, u32, u8, u32) {
        (self.object, self.object_sphere, self.tool, self.tool_sphere)
    }

    /// Returns the contact as seen by the object's tissue: sphere and normal.
    #[inline]
    pub fn site(&self) -> Site {
        Site {
            sphere: self.object_sphere,
            normal: self.normal,
        }
    }
}

/// Contacts of one pass, at most `limit` of them.
///
/// The limit is a field, because an allocator may round up the capacity of a `Vec`.
#[derive(Debug)]
pub struct ContactList {
    contacts: Vec<Contact>,
    limit: usize,
    overflow: Overflow,
    /// Number of contacts at the front that no other contact replaces.
    fixed: usize,
}

/// Policy for a contact that finds the list full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// The query stops with [`ContactsFull`]; the caller retries with a smaller prediction distance.
    Stop,
    /// The new contact replaces the contact with the largest gap, if its own gap is smaller.
    KeepSmallestGaps,
}

impl ContactList {
    /// Creates an empty list with room for `most` contacts in any query.
    pub fn with_capacity(most: usize) -> Self {
        Self {
            contacts: Vec::with_capacity(most),
            limit: most,
            overflow: Overflow::Stop,
            fixed: 0,
        }
    }

    /// Empties the list and sets the limit and the overflow policy of the next query.
    pub fn begin(&mut self, limit: usize, overflow: Overflow) {
        self.contacts.clear();
        (self.limit, self.overflow, self.fixed) = (limit, overflow, 0);
    }

    /// Keeps the contacts found so far: with [`Overflow::KeepSmallestGaps`], later contacts replace one another alone.
    pub(crate) fn fix(&mut self, overflow: Overflow) {
        (self.overflow, self.fixed) = (overflow, self.contacts.len());
    }

    /// Largest gap that a full list keeps beside its fixed contacts, metres. `None`: the list has room, or no such
    /// contact. Valid before [`ContactList::sort`].
    pub(crate) fn largest_kept(&self) -> Option<f64> {
        let heap = &self.contacts[self.fixed..];
        let is_full = self.contacts.len() == self.limit;
        heap.first().filter(|_| is_full).map(|worst| worst.gap)
    }

    /// Returns the contacts found, unordered until [`ContactList::sort`].
    #[inline]
    pub fn as_slice(&self) -> &[Contact] {
        &self.contacts
    }

    /// Sorts by [`Contact::key`]. The contacts of one tool on rigid objects come sorted and cost one comparison each.
    pub fn sort(&mut self) {
        self.contacts.sort_unstable_by_key(Contact::key);
    }

    #[inline(always)]
    fn push(&mut self, contact: Contact) -> Result<(), ContactsFull> {
        // Fast path: below `limit - 1` contacts neither overflow nor heap construction is due.
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
                let heap = &mut self.contacts[self.fixed..];
                for at in (0..heap.len() / 2).rev() {
                    sift_down(heap, at);
                }
            }
            return Ok(());
        }
        match self.overflow {
            Overflow::Stop => Err(ContactsFull),
            Overflow::KeepSmallestGaps => {
                let heap = &mut self.contacts[self.fixed..];
                if heap.first().is_some_and(|worst| outranks(worst, &contact)) {
                    heap[0] = contact;
                    sift_down(heap, 0);
                }
                Ok(())
            }
        }
    }
}

/// Restores the heap property (largest gap first) below the index `at`.
fn sift_down(heap: &mut [Contact], mut at: usize) {
    loop {
        let mut largest = at;
        for child in [2 * at + 1, 2 * at + 2] {
            if child < heap.len() && outranks(&heap[child], &heap[largest]) {
                largest = child;
            }
        }
        if largest == at {
            return;
        }
        heap.swap(at, largest);
        at = largest;
    }
}

/// Whether `a` is dropped before `b` when the list is full: larger gap, then larger key. The order is total, so that
/// the result does not depend on the order of the query.
fn outranks(a: &Contact, b: &Contact) -> bool {
    a.gap > b.gap || (a.gap == b.gap && a.key() > b.key())
}

/// Factor by which a prediction distance shrinks when the contact list overflows.
///
/// A larger factor costs more queries for a fast tool and lets the tool move farther in a tick.
pub(crate) const SHORTER: f64 = 0.7;
/// Smallest base of a prediction distance, metres. At this base without a turn, a full contact list keeps the smallest
/// gaps instead of a retry.
pub(crate) const SMALLEST_PREDICTION: f64 = 1e-6;

/// Prediction distance `base + turn * lever`, metres. The lever is the distance of the tool's sphere from the working
/// point, metres.
///
/// A tool whose working point moves by `base` and which turns by `turn` carries no sphere farther.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Part that is the same for every sphere, metres.
    pub base: f64,
    /// Part per metre of lever, metres per metre: the turn of the tool that the distance covers, radians.
    pub turn: f64,
}

impl Distance {
    /// Returns the distance for a sphere with this lever. Lever and distance are in metres.
    #[inline]
    pub fn at(&self, lever: f64) -> f64 {
        self.base + self.turn * lever
    }

    /// Returns the distance shortened by the factor [`SHORTER`]; see [`Distance::shortened`]. `longest` is the longest
    /// lever of the tool's spheres, metres.
    pub(crate) fn shorter(&self, longest: f64) -> Self {
        self.shortened(SHORTER, longest)
    }

    /// Returns the distance multiplied by `share` (0 to 1), with a base of at least [`SMALLEST_PREDICTION`]. `longest`
    /// is the longest lever of the tool's spheres, metres.
    ///
    /// The turn becomes 0 when the unshortened distance at the longest lever is at most `2 * SMALLEST_PREDICTION`.
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

/// Error of a full contact list. The list then holds an arbitrary part of the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactsFull;

/// Factor for object `k` (0.75 to 1.25) on how long cached contact data stays valid. The golden ratio spreads the
/// factors, so that caches do not all expire in the same tick.
pub(crate) fn spread(k: usize) -> f64 {
    0.75 + 0.5 * (k as f64 * 0.618_033_988_75).fract()
}

/// Returns the world position of `point`, a point in the tool's frame, metres. `pose` is `world_from_tool`, and
/// `rotation` its rotation matrix.
#[inline]
pub(crate) fn centre(rotation: &Mat3, pose: &Pose, point: &Vec3) -> Vec3 {
    pose.position + rotation * point
}
