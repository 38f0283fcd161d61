//! Summary of a demo, as text for a person and as JSON.

use std::path::PathBuf;

use std::collections::BTreeMap;

use serde::Serialize;
use sulcus_program::PathText;
use sulcus_proto::Percentiles;
use sulcus_sessions::exercise::events::Tally;
use sulcus_sessions::{Grade, Mode};

use crate::calls::Called;
use crate::network::NetworkSummary;

/// Summary of one demo.
///
/// An absent value is `null` in the JSON. *Virtual time* is a run without a clock.
#[derive(Clone, Debug, Serialize)]
pub struct DemoSummary {
    /// Path of the recording.
    #[serde(serialize_with = "sulcus_program::path::text")]
    pub recording: PathBuf,
    /// Name of the exercise.
    pub exercise: String,
    /// Name of the scene.
    pub scene: String,
    /// Whether the session ran in virtual time.
    #[serde(rename = "virtual")]
    pub virtual_time: bool,
    /// Purpose of the session.
    pub mode: Mode,
    /// Ticks per second.
    pub rate_hz: u16,
    /// Number of ticks computed.
    pub ticks: u64,
    /// Number of ticks that ended after their period or were skipped; 0 in virtual time.
    pub deadline_misses: u64,
    /// Number of ticks of the clock's grid that were skipped; 0 in virtual time.
    pub skipped: u64,
    /// CPU time of the thread for a tick, microseconds.
    pub tick_us: Percentiles,
    /// Wall time of a tick, microseconds.
    pub tick_wall_us: Percentiles,
    /// Time from a pose to the first wrench that answers it, microseconds, with the wait for the server's next tick.
    /// `None` in virtual time, and if no pose was answered.
    pub rtt_us: Option<Percentiles>,
    /// Time from the arrival of a pose at the server to the begin of the tick that used it, microseconds; `None`
    /// likewise.
    pub wait_us: Option<Percentiles>,
    /// [`DemoSummary::rtt_us`] without the time that the server held the pose, microseconds; `None` likewise.
    pub network_us: Option<Percentiles>,
    /// Deepest penetration in the converged ticks that had a full query of all pairs, micrometres.
    pub max_residual_um: f64,
    /// Number of ticks from one full query to the next; 1 in a short session.
    pub residual_every: u64,
    /// Number of tool-ticks whose substeps ran out, after the tool's arrival.
    pub exhausted: u64,
    /// Largest force sent to a hand, newtons.
    pub max_force_n: f64,
    /// Energy of the displayed force; `None` in virtual time, which has no display loop.
    pub passivity: Option<PassivitySummary>,
    /// Figures of the way between hand and server; absent in virtual time, and in a plain demo without JSON.
    #[serde(flatten)]
    pub way: Option<NetworkSummary>,
    /// Number of datagrams that never arrived, in both directions together; 0 in virtual time.
    pub lost: u64,
    /// Number of datagrams that arrived after a newer datagram, in both directions together; 0 in virtual time.
    pub late: u64,
    /// Whether the replay gave the recorded hash, wrench and status in every tick, and the state of every snapshot.
    pub identical: bool,
    /// First tick that differs; `None` if no tick differs.
    pub first_divergent_tick: Option<u64>,
    /// Whether a grade may rest on the recording.
    pub gradable: bool,
    /// Whether the signature of the whole recording and its chain of hashes are valid.
    pub signature_valid: bool,
    /// Simulated time divided by the time of the run; about 1 in real time.
    pub realtime_factor: f64,
    /// Simulated time divided by the time of the replay.
    pub replay_realtime_factor: f64,
    /// Size of the recording, bytes.
    pub recording_bytes: u64,
    /// Readings in pockets; `None` if no tool was in a pocket, and after [`DemoSummary::withhold`].
    pub pocket: Option<PocketSummary>,
    /// Motion of the tissue; `None` for a scene in which nothing yields.
    pub tissue: Option<TissueSummary>,
    /// Events of the exercise, found in the replay.
    pub events: Option<EventsSummary>,
    /// Proposed grade; `None` for an exercise without a rubric, and after [`DemoSummary::withhold`].
    pub grade: Option<Grade>,
    /// Path of the student's page (HTML) beside the recording. `None` without a grade, in a mode other than practice,
    /// and if the page could not be written.
    #[serde(serialize_with = "sulcus_program::path::text_or_null")]
    pub page: Option<PathBuf>,
    /// Reason why the page could not be written; `None` if it was written or is not due.
    pub page_error: Option<String>,
}

/// Energy of the displayed force.
#[derive(Clone, Debug, Serialize)]
pub struct PassivitySummary {
    /// Largest net energy that the force put out into a hand since a contact began, millijoules.
    pub energy_out_mj: f64,
    /// Energy removed by the passivity controllers of both hands, millijoules.
    pub energy_taken_mj: f64,
    /// Number of periods in which a passivity controller acted, summed over both hands.
    pub damped_periods: u64,
}

/// Readings in pockets.
#[derive(Clone, Debug, Serialize)]
pub struct PocketSummary {
    /// Zones that the tip of a probe reached.
    pub sites: Vec<SiteSummary>,
    /// Number of entries of a hand into the zone of force "too heavy".
    pub too_heavy: u64,
    /// Number of entries into the zone in which healthy tissue bleeds.
    pub trauma: u64,
    /// Number of entries into the zone of damage.
    pub damage: u64,
}

/// Readings in one zone of one tooth.
#[derive(Clone, Debug, Serialize)]
pub struct SiteSummary {
    /// FDI number of the tooth; 0 in a scene without numbers.
    pub tooth: u8,
    /// Name of the site.
    pub site: &'static str,
    /// Prescribed depth, millimetres.
    pub truth_mm: f64,
    /// Deepest reading at a correct force, millimetres; `None` if the force was never correct.
    pub measured_mm: Option<f64>,
    /// Largest depth of the tip at any force, millimetres.
    pub deepest_mm: f64,
    /// Largest force on the floor, newtons.
    pub max_force_n: f64,
}

/// Motion of the tissue, and quality of the contact force.
#[derive(Clone, Debug, Serialize)]
pub struct TissueSummary {
    /// Largest displacement of any leaf sphere from its rest in the ticks with a full query, millimetres.
    pub indentation_mm: f64,
    /// Largest displacement of any leaf sphere from its rest in the last tick, micrometres.
    pub unrest_um: f64,
    /// Largest force before ramp, clamp and slew, newtons.
    pub max_raw_force_n: f64,
    /// Mean length of the second difference of the raw force over tool-ticks under load, newtons.
    pub buzz_n: f64,
    /// Largest difference between the sum of the contacts' loads and the raw wrench, relative to the loads.
    pub imbalance: f64,
    /// Number of loaded pairs of spheres whose normal turned by more than 90 degrees from one tick to the next.
    pub flips: u64,
}

/// Events of an exercise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventsSummary {
    /// Number of events of each kind.
    pub counts: BTreeMap<&'static str, u64>,
    /// Number of times that the tilt became wrong.
    pub wrong_angles: u64,
    /// Share of the time with a visible target, 0 to 1; `None` without a target.
    pub visible_share: Option<f64>,
    /// Mean share of the target that the tongue left free, 0 to 1; `None` without a target.
    pub mean_free: Option<f64>,
    /// Mean share of the target that tongue and mirror left free, 0 to 1; `None` without a target.
    pub mean_free_past_mirror: Option<f64>,
    /// Called depths in the order of the recording; empty after [`DemoSummary::withhold`].
    pub calls: Vec<Called>,
}

impl EventsSummary {
    /// Events from the counts of a session and its calls.
    pub fn new(tally: &Tally, calls: Vec<Called>) -> Self {
        Self {
            counts: tally.counts().collect(),
            wrong_angles: tally.wrong_angles,
            visible_share: tally.visible_share(),
            mean_free: tally.mean_free().map(|(free, _)| free),
            mean_free_past_mirror: tally.mean_free().map(|(_, past)| past),
            calls,
        }
    }

    fn lines(&self, lines: &mut Vec<String>) {
        let count = |kind: &str| self.counts.get(kind).copied().unwrap_or(0);
        if count("site_reached") > 0 {
            lines.push(format!(
                "walking       {} zones reached, floor felt {} times, {} wrong tilts, {} withdrawals, {} times bleeding",
                count("site_reached"),
                count("floor_felt"),
                self.wrong_angles,
                count("withdrawn"),
                count("bleeding")
            ));
        }
        if let (Some(visible), Some(free)) = (self.visible_share, self.mean_free) {
            lines.push(format!(
                "sight         target visible {:.0} % of the time, {:.0} % of it free on average",
                visible * 100.0,
                free * 100.0
            ));
        }
        if !self.calls.is_empty() {
            let off = |call: &&Called| (f64::from(call.depth_mm) - call.truth_mm).abs() > 1.0;
            lines.push(format!(
                "called        {} depths, {} of them more than 1 mm off",
                self.calls.len(),
                self.calls.iter().filter(off).count()
            ));
            for call in &self.calls {
                lines.push(format!(
                    "              {} {:13} {} mm called, {:.1} prescribed",
                    call.tooth, call.site, call.depth_mm, call.truth_mm
                ));
            }
        }
    }
}

impl PocketSummary {
    fn lines(&self, lines: &mut Vec<String>) {
        for site in &self.sites {
            let read = match site.measured_mm {
                Some(depth) => format!(
                    "{depth:.1} mm read, {:.1} prescribed ({:+.1})",
                    site.truth_mm,
                    depth - site.truth_mm
                ),
                None => format!(
                    "never read at correct force ({:.1} prescribed)",
                    site.truth_mm
                ),
            };
            lines.push(format!(
                "{:13} {} of {}, {:.2} N at most",
                site.site, read, site.tooth, site.max_force_n
            ));
        }
        lines.push(format!(
            "force zones   {} times too heavy, {} trauma, {} damage",
            self.too_heavy, self.trauma, self.damage
        ));
    }
}

impl TissueSummary {
    fn line(&self) -> String {
        format!(
            "tissue        displaced {:.1} mm at most, {:.2} um at the end, buzz {:.4} N",
            self.indentation_mm, self.unrest_um, self.buzz_n
        )
    }
}

impl DemoSummary {
    /// Removes depths, calls and grade, which a learner must not see in a self-assessment or an exam.
    pub fn withhold(&mut self) {
        (self.pocket, self.grade) = (None, None);
        if let Some(events) = &mut self.events {
            events.calls.clear();
        }
    }

    /// Text of the summary, in lines for a terminal, with the commands for the recording at the end.
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
                self.ticks as f64 / f64::from(self.rate_hz),
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
                "round trip    {} (with the wait for the server's tick)",
                times(rtt)
            ));
            lines.push(format!(
                "datagrams     {} lost, {} late",
                self.lost, self.late
            ));
        }
        if let Some(wait) = &self.wait_us {
            lines.push(format!(
                "tick wait     {} (of a pose for the server's tick)",
                times(wait)
            ));
        }
        lines.extend(self.way.iter().flat_map(NetworkSummary::lines));
        if let Some(network) = &self.network_us {
            lines.push(format!(
                "network       {} (both ways, without the time at the server)",
                times(network)
            ));
        }
        lines.push(format!(
            "residual      {:.3} um at most{}, {} ticks exhausted",
            self.max_residual_um,
            match self.residual_every {
                1 => String::new(),
                every => format!(" (measured in one tick of {every})"),
            },
            self.exhausted
        ));
        lines.push(format!("force         {:.2} N at most", self.max_force_n));
        if let Some(passivity) = &self.passivity {
            lines.push(format!(
                "energy        {:.3} mJ put out at most, {:.3} mJ removed in {} damped periods",
                passivity.energy_out_mj, passivity.energy_taken_mj, passivity.damped_periods
            ));
        }
        if let Some(pocket) = &self.pocket {
            pocket.lines(&mut lines);
        }
        if let Some(events) = &self.events {
            events.lines(&mut lines);
        }
        if let Some(tissue) = &self.tissue {
            lines.push(tissue.line());
        }
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
        if let Some(grade) = &self.grade {
            lines.extend(grade_lines(grade));
        } else if !self.gradable {
            lines.push("grading       NOT POSSIBLE: the recording is not complete".into());
        } else if self.mode != Mode::Practice {
            lines.push(format!(
                "grading       {}: depths and grade are not shown here; see the command below",
                self.mode
            ));
        }
        if !self.signature_valid {
            lines.push("signature     NOT VALID".into());
        }
        let megabytes = self.recording_bytes as f64 * 1e-6;
        lines.push(format!(
            "recording     {} ({megabytes:.2} MB)",
            self.recording.shown()
        ));
        if let Some(page) = &self.page {
            lines.push(format!("page          {}", page.shown()));
        }
        lines.push(String::new());
        lines.push("next:".into());
        let recording = self.recording.shown();
        let cargo = "cargo run --release -p";
        if let Some(page) = &self.page {
            lines.push(format!(
                "  open {} in a browser: grade, chart, advice",
                page.shown()
            ));
        }
        lines.push("  review the session in Rerun:".into());
        lines.push(format!(
            "    {cargo} sulcus-view --features rerun --bin sulcus-review -- {recording}"
        ));
        lines.push(
            "  list the contents of the recording, replay it with an independent solver as judge:"
                .into(),
        );
        for command in ["info", "replay --audit"] {
            lines.push(format!(
                "    {cargo} sulcus-sessions -- {command} {recording}"
            ));
        }
        if self.page.is_none() && (self.grade.is_some() || self.mode != Mode::Practice) {
            lines.push("  grade the session:".into());
            lines.push(format!(
                "    {cargo} sulcus-sessions -- grade --html pages {recording}"
            ));
        }
        lines.join("\n")
    }
}

/// Lines with score, result and advice. `sulcus-sessions grade` prints the whole grade.
fn grade_lines(grade: &Grade) -> Vec<String> {
    let Some(score) = grade.score else {
        let why = grade.reason.as_deref().unwrap_or("the reason is unknown");
        return vec![format!("grade         NONE: {why}")];
    };
    let rubric = grade.rubric.as_ref().map_or(String::new(), |used| {
        format!(" (rubric {}, version {})", used.name, used.version)
    });
    let passed = if grade.passed == Some(true) {
        "passed"
    } else {
        "NOT PASSED"
    };
    let mut lines = vec![format!(
        "grade         {score:.1} of 100 proposed, {passed}{rubric}"
    )];
    let practise = grade.advice.iter();
    lines.extend(practise.map(|advice| format!("              practise: {}", advice.title)));
    lines
}
