//! Figures of a session through a network that misbehaves, and of ticks at the hand.

use serde::Serialize;
use sulcus_connection::perform::Performed;
use sulcus_proto::Percentiles;
use sulcus_sessions::{Message, ReadError, Recording};

/// Figures of the way between hand and server.
#[derive(Clone, Debug, Serialize)]
pub struct NetworkSummary {
    /// Name of the network of `--network`; `None` without that option.
    pub network: Option<String>,
    /// End that computed the ticks that the hand felt: `server` or `hand`.
    pub tick: &'static str,
    /// Time from a pose to the wrench that answers it, milliseconds. For ticks at the hand the answer is the hand's.
    pub pose_age_ms: Percentiles,
    /// Whether the ticks at the hand had the hashes and the wrenches that the server recorded, in bits: all ticks, or
    /// the first 300,000 of a longer session. `None` if the server ticked.
    pub felt_identical: Option<bool>,
    /// Force at the hand for each newton of the tick that answers the hand's present pose, per cent: least squares over
    /// the samples of the devices in the recording. A delay makes the slope smaller.
    pub felt_force_percent: f64,
    /// Deviation of the force at the hand from that of the tick, root of the mean square over the samples with a force,
    /// newtons.
    pub felt_off_n: f64,
    /// Largest change of the displayed force between two passes of the device's loop, newtons.
    pub force_step_n: f64,
    /// Largest net energy that the displayed force put out into a hand since a contact began, millijoules.
    pub energy_out_mj: f64,
    /// Mean rate of both directions together, with the headers of IP and UDP, kbit/s; `None` without a network.
    pub bandwidth_kbit_s: Option<f64>,
    /// Mean length of the inputs of a tick at the hand, bytes; 0 if the server ticked.
    pub input_bytes_per_tick: f64,
    /// Number of ticks that the server had not computed at the end of the motion; 0 if the server ticked.
    pub ticks_behind: u64,
    /// Number of returns to the session after a lost connection.
    pub resumes: u32,
    /// Number of poses offered for each one sent, at the end.
    pub rate_divisor: u32,
    /// Number of packets that the network lost in both directions, in full queues too; 0 without a network.
    pub packets_lost: u64,
}

impl NetworkSummary {
    /// Figures of a session on the recording `recorded`.
    ///
    /// # Errors
    /// The recording changed after it was opened.
    pub fn new(ran: &Performed, recorded: &Recording) -> Result<Self, ReadError> {
        let at_hand = ran.hand.is_some();
        let age = if at_hand {
            ran.report.hand_age_us
        } else {
            ran.stats.rtt_us
        };
        let ms = |us: f64| us / 1e3;
        let felt = Felt::of(recorded)?;
        let felt_identical = match &ran.hand {
            Some(hand) => Some(same(hand.log(), hand.log_room(), recorded)?),
            None => None,
        };
        Ok(Self {
            network: None,
            tick: if at_hand { "hand" } else { "server" },
            pose_age_ms: Percentiles {
                p50: ms(age.p50),
                p99: ms(age.p99),
                p999: ms(age.p999),
                max: ms(age.max),
            },
            felt_identical,
            felt_force_percent: felt.percent(),
            felt_off_n: felt.off_n(),
            force_step_n: ran.report.max_displayed_step_n,
            energy_out_mj: ran.report.energy_out_j * 1e3,
            bandwidth_kbit_s: None,
            input_bytes_per_tick: ran.stats.bytes_per_tick,
            ticks_behind: ran.stats.ticks_behind,
            resumes: ran.stats.returns,
            rate_divisor: ran.stats.rate_divisor,
            packets_lost: 0,
        })
    }

    /// The same figures with those of a network whose packets are counted in `counts` over `seconds`.
    #[cfg(feature = "embedded")]
    #[must_use]
    pub fn through(
        mut self,
        network: sulcus_relay::Network,
        counts: sulcus_relay::RelayCounts,
        seconds: f64,
    ) -> Self {
        let both = [counts.up, counts.down];
        let bytes: u64 = both
            .iter()
            .map(sulcus_relay::Counts::bytes_on_the_wire)
            .sum();
        self.network = Some(network.to_string());
        self.bandwidth_kbit_s = Some(bytes as f64 * 8.0 / seconds / 1e3);
        self.packets_lost = both.iter().map(|way| way.lost + way.overflow).sum();
        self
    }

    /// Lines for people; none for ticks of the server without a network.
    pub fn lines(&self) -> Vec<String> {
        let age = &self.pose_age_ms;
        let mut lines = Vec::new();
        if self.network.is_none() && self.felt_identical.is_none() {
            return lines;
        }
        if let (Some(network), Some(rate)) = (&self.network, self.bandwidth_kbit_s) {
            lines.push(format!(
                "path          {network}: {} packets lost, {rate:.0} kbit/s, {} returns, poses at 1/{} of the rate",
                self.packets_lost, self.resumes, self.rate_divisor
            ));
        }
        lines.push(format!(
            "pose age      p50 {:.1}  p99 {:.1} ms, ticks at the {}; force at the hand off by {:.3} N rms",
            age.p50, age.p99, self.tick, self.felt_off_n
        ));
        if let Some(identical) = self.felt_identical {
            lines.push(format!(
                "hand          {}, {:.1} bytes a tick, {} ticks behind at the end of the motion",
                if identical {
                    "felt the recorded ticks, bit for bit"
                } else {
                    "felt other ticks than the recorded ones"
                },
                self.input_bytes_per_tick,
                self.ticks_behind
            ));
        }
        lines
    }
}

/// Force displayed at the readings of the devices, against the force of the ticks that used the readings.
#[derive(Default)]
struct Felt {
    /// Sums of the products of both forces, of the squares of the tick's, and of the squares of the difference.
    products: f64,
    squares: f64,
    off: f64,
    samples: u64,
}

impl Felt {
    /// Sums over the samples with a force.
    fn of(recorded: &Recording) -> Result<Self, ReadError> {
        let mut felt = Self::default();
        for message in recorded.messages() {
            let Message::Row(row) = message? else {
                continue;
            };
            for (sample, wrench) in row.device.iter().zip(&row.wrench) {
                let Some(sample) = sample else { continue };
                let pairs = sample.displayed.iter().zip(wrench).take(3);
                let pairs: Vec<(f64, f64)> = pairs
                    .map(|(felt, ticked)| (f64::from(*felt), f64::from(*ticked)))
                    .collect();
                if pairs
                    .iter()
                    .all(|(felt, ticked)| *felt == 0.0 && *ticked == 0.0)
                {
                    continue;
                }
                felt.samples += 1;
                for (shown, ticked) in pairs {
                    felt.products += shown * ticked;
                    felt.squares += ticked * ticked;
                    felt.off += (shown - ticked) * (shown - ticked);
                }
            }
        }
        Ok(felt)
    }

    fn percent(&self) -> f64 {
        if self.squares > 0.0 {
            100.0 * self.products / self.squares
        } else {
            100.0
        }
    }

    fn off_n(&self) -> f64 {
        (self.off / self.samples.max(1) as f64).sqrt()
    }
}

/// Whether the recording has the ticks of a hand, with the same hashes and wrenches.
fn same(
    log: &[sulcus_connection::at_hand::Ticked],
    log_room: usize,
    recorded: &Recording,
) -> Result<bool, ReadError> {
    let mut felt = log.iter();
    for message in recorded.messages() {
        let Message::Row(row) = message? else {
            continue;
        };
        let Some(ticked) = felt.next() else {
            // A full log has the first ticks alone.
            return Ok(log.len() == log_room);
        };
        let wrenches = ticked.wrench.iter().zip(&row.wrench);
        let same_wrench = wrenches.into_iter().all(|(felt, recorded)| {
            let felt = felt.force.iter().chain(&felt.torque);
            felt.zip(recorded).all(|(a, b)| a.to_bits() == b.to_bits())
        });
        if (ticked.tick, ticked.hash) != (row.tick, row.hash) || !same_wrench {
            return Ok(false);
        }
    }
    Ok(felt.next().is_none() && !log.is_empty())
}
