//! Comparison of the forces at the devices with the forces of the simulation.

use sulcus_core::Vec3;
use sulcus_haptics::Mapping;
use sulcus_standins::Log;

use crate::hands::DeviceBox;
use crate::messages::SEAT_HOUR;

/// Time before a frame in which a force of the simulation may act on it, nanoseconds: the way through link and door.
const BEFORE_NS: u64 = 40_000_000;
/// Time without a force of the simulation after which a hand must feel nothing, nanoseconds. The passivity controller
/// brakes a hand that leaves a contact with energy, and forgets the energy after 100 ms.
const FREE_NS: u64 = 200_000_000;
/// Time after a frame whose entry may hold its force: the loop notes a wrench after the device has its order.
const AFTER_NS: u64 = 2_000_000;
/// Force that shows a contact, newtons.
const PRESSED_N: f64 = 0.05;
/// Smallest cosine between a force at the device and that of the simulation.
const ALIGNED: f64 = 0.95;

/// Force of a tool over time.
#[derive(Default)]
pub struct Series {
    times: Vec<u64>,
    forces: Vec<Vec3>,
}

impl Series {
    pub fn push(&mut self, at_ns: u64, force: [f64; 3]) {
        self.times.push(at_ns);
        self.forces.push(force.into());
    }

    /// Forces from `from_ns` to `to_ns`.
    fn between(&self, from_ns: u64, to_ns: u64) -> &[Vec3] {
        let at = |t: u64| self.times.partition_point(|&time| time < t);
        &self.forces[at(from_ns)..at(to_ns)]
    }
}

/// Counts of frames of a device.
#[derive(Debug, Default)]
pub struct Judged {
    /// Frames between the first and the last wrench.
    pub frames: u64,
    /// Frames of a hand without a contact for 200 ms, while the other hand had one.
    pub crossed: u64,
    /// Frames of a hand without a contact for 200 ms that had a force.
    pub strange: u64,
    /// Frames in a steady contact.
    pub pressed: u64,
    /// Of these, frames with a force above that of the simulation.
    pub stronger: u64,
    /// Of these, frames with a force in another direction.
    pub aside: u64,
    /// Of these, frames with at least nine tenths of the force.
    pub whole: u64,
}

/// Compares every frame of a device with the forces of both tools.
pub fn judge(log: &Log, of_box: &DeviceBox, computed: &[Series; 2], tool: usize) -> Judged {
    let (own, other) = (&computed[tool], &computed[1 - tool]);
    let (Some(&first), Some(&last)) = (own.times.first(), own.times.last()) else {
        panic!("a session without a wrench");
    };
    let world_from_base = Mapping::seat(SEAT_HOUR);
    let mut judged = Judged::default();
    for (t, command) in log.commands(of_box.device) {
        if t < first + FREE_NS || t + AFTER_NS > last {
            continue;
        }
        judged.frames += 1;
        let base = Vec3::from(of_box.axes.map(|axis| command.asked_force[axis]));
        let felt = world_from_base * base;
        let mine = own.between(t - BEFORE_NS, t + AFTER_NS);
        let norms = || mine.iter().map(|force| force.norm());
        let most = norms().fold(0.0, f64::max);
        let least = norms().fold(f64::INFINITY, f64::min);
        let before = own.between(t - FREE_NS, t + AFTER_NS);
        if before.iter().all(|force| force.norm() == 0.0) {
            judged.strange += u64::from(felt.norm() > 1e-6);
            let theirs = other.between(t - BEFORE_NS, t + AFTER_NS);
            judged.crossed += u64::from(theirs.iter().all(|force| force.norm() > PRESSED_N));
        } else if least > PRESSED_N && least > 0.9 * most {
            judged.pressed += 1;
            let mean = mine.iter().sum::<Vec3>() / mine.len() as f64;
            judged.stronger += u64::from(felt.norm() > 1.05 * most + 0.01);
            let aligned = felt.dot(&mean) >= ALIGNED * felt.norm() * mean.norm();
            judged.aside += u64::from(felt.norm() > 0.01 && !aligned);
            judged.whole += u64::from(felt.norm() >= 0.9 * least);
        }
    }
    judged
}
