//! Loads of the contacts: their sum compared with the wrench, and flips of their normals.

use sulcus_core::math::norm;
use sulcus_core::{Vec3, Workspace, Wrench};

/// Smallest load that counts, newtons. A solver leaves smaller loads on inactive rows.
const DUST: f64 = 1e-6;
/// Smallest sum of loads for an imbalance, newtons.
const LEAST: f64 = 0.01;
/// Lever with which a torque counts as a force, metres.
const LEVER: f64 = 1e-3;

/// Difference between the loads of tool `t` and `felt`, the raw wrench about its working point, relative to the sum of
/// the loads' magnitudes; 0 for a sum below 0.01 N.
pub(crate) fn imbalance(ws: &Workspace, t: usize, felt: &Wrench) -> f64 {
    let (mut force, mut torque, mut magnitude) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for (contact, load) in ws.contacts().filter(|(c, _)| usize::from(c.tool) == t) {
        // The object pushes the tool, and the tool the hand.
        let push = contact.normal * load;
        force += push;
        torque += contact.arm.cross(&push);
        magnitude += load;
    }
    if magnitude < LEAST {
        return 0.0;
    }
    (norm(&(force - felt.force)).max(norm(&(torque - felt.torque)) / LEVER)) / magnitude
}

/// Key and normal of a loaded pair.
type Pair = ((u16, u32, u8, u32), Vec3);

/// Loaded pairs of the last tick with their normals.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bearing {
    last: Vec<Pair>,
    now: Vec<Pair>,
}

impl Bearing {
    /// Takes the contacts of a tick. Returns the number of normals that turned by more than 90 degrees since the last
    /// tick.
    pub fn flips(&mut self, ws: &Workspace) -> u64 {
        self.now.clear();
        let loaded = ws.contacts().filter(|(_, load)| *load > DUST);
        self.now
            .extend(loaded.map(|(contact, _)| (contact.key(), contact.normal)));
        self.now.sort_unstable_by_key(|pair| pair.0);
        let flipped = self.now.iter().filter(|(key, normal)| {
            self.last
                .binary_search_by_key(key, |pair| pair.0)
                .is_ok_and(|at| self.last[at].1.dot(normal) < 0.0)
        });
        let flips = flipped.count() as u64;
        std::mem::swap(&mut self.last, &mut self.now);
        flips
    }
}
