//! End of a run: the forces fall, zero force for 30 ms, end of the connection.

use sulcus_core::Vec3;
use sulcus_core::math::norm;
use sulcus_haptics::Unready;
use sulcus_link::clock::{monotonic_ns, sleep_until};

use super::Run;

/// Duration of the messages with zero force at the end, nanoseconds. The note asks for 30 ms.
const REST_NS: u64 = 35_000_000;
/// Longest fall of the force before these messages, nanoseconds.
const FALL_NS: u64 = 40_000_000;

impl Run<'_> {
    /// Ends the run: lets the forces fall within the limits of the ports, sends zero for 30 ms, and closes the
    /// connection. Without `fall` the forces are zero at once.
    pub(in crate::haply) fn rest(&mut self, fall: bool) {
        if std::mem::replace(&mut self.rested, true) {
            return;
        }
        let mut next_ns = monotonic_ns();
        let fallen_ns = next_ns + FALL_NS;
        let mut zero_ns = None;
        // A silent service ends the rest by the end of its time.
        while zero_ns.is_none_or(|zero_ns| next_ns < zero_ns + REST_NS) {
            sleep_until(next_ns);
            self.listen();
            let now_ns = monotonic_ns();
            if fall && zero_ns.is_none() && now_ns < fallen_ns {
                self.exchange(now_ns, Some(Unready::NoPose));
            } else {
                self.device
                    .hands
                    .iter_mut()
                    .for_each(|hand| hand.set_force(Vec3::zeros()));
            }
            let is_zero = self
                .device
                .hands
                .iter()
                .all(|hand| norm(&hand.force()) == 0.0);
            if is_zero && zero_ns.is_none() {
                zero_ns = Some(now_ns);
            }
            if self.device.flow.is_none() {
                break;
            }
            self.send(now_ns);
            next_ns = now_ns + self.device.period_ns;
        }
        if let Some(flow) = self.device.flow.take() {
            flow.close();
        }
        if let Some((begin_ns, end_ns)) = self.between_ns {
            let mean_ns = end_ns.saturating_sub(begin_ns) / self.messages.saturating_sub(1).max(1);
            tracing::info!(
                "{} messages to the Haply service, one each {} us",
                self.messages,
                mean_ns / 1000
            );
        }
    }
}
