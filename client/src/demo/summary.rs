//! What a demo came to, for people and as JSON (the fields of the design, section 7).

use std::path::PathBuf;

use serde::Serialize;
use sulcus_proto::Percentiles;

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct DemoSummary {
    /// Where the recording is.
    pub recording: PathBuf,
    /// Exercise performed.
    pub exercise: String,
    /// Scene it was performed in.
    pub scene: String,
    /// Whether it ran in virtual time.
    #[serde(rename = "virtual")]
    pub virtual_time: bool,
    /// Ticks computed.
    pub ticks: u64,
    /// Ticks that ended after their period or were skipped; 0 in virtual time.
    pub deadline_misses: u64,
    /// Ticks of the clock's grid that were skipped; 0 in virtual time.
    pub skipped: u64,
    /// Thread CPU time of a tick.
    pub tick_us: Percentiles,
    /// Wall time of a tick.
    pub tick_wall_us: Percentiles,
    /// From a pose to the first wrench that answers it, waiting for the server's next tick included; null
    /// in virtual time.
    pub rtt_us: Option<Percentiles>,
    /// The same without the time that the server held the pose; null in virtual time.
    pub network_us: Option<Percentiles>,
    /// Deepest penetration of any converged tick, by a full query of all pairs.
    pub max_residual_um: f64,
    /// Tool-ticks whose substeps ran out, after arrival.
    pub exhausted: u64,
    /// Largest force sent to a hand.
    pub max_force_n: f64,
    /// Datagrams that never arrived, both ways.
    pub lost: u64,
    /// Datagrams that arrived after a newer one, both ways.
    pub late: u64,
    /// Whether the replay gave the same hashes for every tick.
    pub identical: bool,
    /// First tick that differs, if any.
    pub first_divergent_tick: Option<u64>,
    /// Whether a grade may rest on the recording.
    pub gradable: bool,
    /// Whether the recording's signatures hold.
    pub signature_valid: bool,
    /// Speed of the simulation against real time; about 1 when live.
    pub realtime_factor: f64,
    /// Speed of the replay against real time.
    pub replay_realtime_factor: f64,
    /// Size of the recording.
    pub recording_bytes: u64,
    /// Null until there is grading.
    pub grade: Option<()>,
}

impl DemoSummary {
    /// The summary for people.
    pub fn text(&self) -> String {
        let times = |p: &Percentiles| {
            format!(
                "p50 {:.1}  p99 {:.1}  p99.9 {:.1}  max {:.1} us",
                p.p50, p.p99, p.p999, p.max
            )
        };
        let mut lines = vec![
            format!(
                "exercise      {} in `{}`{}",
                self.exercise,
                self.scene,
                if self.virtual_time {
                    ", virtual time"
                } else {
                    ""
                }
            ),
            format!(
                "ticks         {} ({:.1} s), {}",
                self.ticks,
                self.ticks as f64 * 1e-3,
                if self.virtual_time {
                    format!("{:.0} times faster than real time", self.realtime_factor)
                } else {
                    format!(
                        "{} deadline misses, {} of them skipped",
                        self.deadline_misses, self.skipped
                    )
                }
            ),
            format!("tick, CPU     {}", times(&self.tick_us)),
            format!("tick, wall    {}", times(&self.tick_wall_us)),
        ];
        if let Some(rtt) = &self.rtt_us {
            lines.push(format!(
                "round trip    {} (waiting for the tick included)",
                times(rtt)
            ));
            lines.push(format!(
                "datagrams     {} lost, {} late",
                self.lost, self.late
            ));
        }
        if let Some(network) = &self.network_us {
            lines.push(format!(
                "network       {} (of it, both ways)",
                times(network)
            ));
        }
        lines.push(format!(
            "residual      {:.3} um at most, {} ticks exhausted",
            self.max_residual_um, self.exhausted
        ));
        lines.push(format!("force         {:.2} N at most", self.max_force_n));
        lines.push(match self.first_divergent_tick {
            None if self.identical => {
                format!(
                    "replay        identical, {:.0} times faster than real time",
                    self.replay_realtime_factor
                )
            }
            Some(tick) => format!("replay        DIFFERS from tick {tick} on"),
            None => "replay        DIFFERS".into(),
        });
        if !self.gradable {
            lines.push("grading       NOT POSSIBLE: the recording is not complete".into());
        }
        if !self.signature_valid {
            lines.push("signature     NOT VALID".into());
        }
        let megabytes = self.recording_bytes as f64 * 1e-6;
        lines.push(format!(
            "recording     {} ({megabytes:.2} MB)",
            self.recording.display()
        ));
        lines.push(String::new());
        lines.push("next:".into());
        lines.push(format!(
            "  cargo run --release -p sulcus-sessions -- info {}",
            self.recording.display()
        ));
        lines.push(format!(
            "  cargo run --release -p sulcus-sessions -- replay --audit {}",
            self.recording.display()
        ));
        lines.join("\n")
    }
}
