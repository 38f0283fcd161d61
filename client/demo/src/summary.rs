//! What a demo came to, for people and as JSON (the fields of the design, section 7).

use std::path::PathBuf;

use std::collections::BTreeMap;

use serde::Serialize;
use sulcus_program::PathText;
use sulcus_proto::Percentiles;
use sulcus_sessions::exercise::events::Tally;
use sulcus_sessions::{Grade, Mode};

use crate::calls::Called;

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct DemoSummary {
    /// Where the recording is.
    #[serde(serialize_with = "sulcus_program::path::text")]
    pub recording: PathBuf,
    /// Exercise performed.
    pub exercise: String,
    /// Scene it was performed in.
    pub scene: String,
    /// Whether it ran in virtual time.
    #[serde(rename = "virtual")]
    pub virtual_time: bool,
    /// What the session was for.
    pub mode: Mode,
    /// Ticks a second.
    pub rate_hz: u16,
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
    /// Deepest penetration of any converged tick that was looked at, by a full query of all pairs.
    pub max_residual_um: f64,
    /// Every how many ticks it was looked at: 1 in a short session.
    pub residual_every: u64,
    /// Tool-ticks whose substeps ran out, after arrival.
    pub exhausted: u64,
    /// Largest force sent to a hand.
    pub max_force_n: f64,
    /// Energy of the force displayed; null in virtual time, where nothing is displayed late.
    pub passivity: Option<PassivitySummary>,
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
    /// What was read in pockets; null where no tool was in one, and after anything but practice.
    pub pocket: Option<PocketSummary>,
    /// How tissue fared; null where nothing yields.
    pub tissue: Option<TissueSummary>,
    /// What happened in the exercise, found in the replay.
    pub events: Option<EventsSummary>,
    /// What the program proposes as a grade; null where nothing is asked that is graded, and after anything but practice.
    pub grade: Option<Grade>,
    /// The student's page (HTML) beside the recording; null where there is no grade to show.
    #[serde(serialize_with = "sulcus_program::path::text_or_null")]
    pub page: Option<PathBuf>,
    /// Why the page could not be written; null where it was, and where there is none.
    pub page_error: Option<String>,
}

/// Energy of the force displayed.
#[derive(Clone, Debug, Serialize)]
pub struct PassivitySummary {
    /// Most that it had put out into a hand, net, since a contact began.
    pub energy_out_mj: f64,
    /// What the passivity controller took out.
    pub energy_taken_mj: f64,
    /// Periods of a hand in which the controller acted.
    pub damped_periods: u64,
}

/// What was read in pockets.
#[derive(Clone, Debug, Serialize)]
pub struct PocketSummary {
    /// Each zone of the circumference that was reached.
    pub sites: Vec<SiteSummary>,
    /// Times that a hand became too heavy on the floor.
    pub too_heavy: u64,
    /// Times that it became so heavy that healthy tissue bleeds.
    pub trauma: u64,
    /// Times that it did damage.
    pub damage: u64,
}

/// One zone of one tooth.
#[derive(Clone, Debug, Serialize)]
pub struct SiteSummary {
    /// FDI number.
    pub tooth: u8,
    /// Name of the zone.
    pub site: &'static str,
    /// Depth that is prescribed there.
    pub truth_mm: f64,
    /// Deepest reading at correct force; null when the force never was.
    pub measured_mm: Option<f64>,
    /// Deepest that the tip was.
    pub deepest_mm: f64,
    /// Largest force on the floor.
    pub max_force_n: f64,
}

/// How tissue fared.
#[derive(Clone, Debug, Serialize)]
pub struct TissueSummary {
    /// Largest displacement of any leaf sphere.
    pub indentation_mm: f64,
    /// Displacement of the farthest leaf at the end.
    pub unrest_um: f64,
    /// Largest force before clamp and slew.
    pub max_raw_force_n: f64,
    /// Mean second difference of the raw force per tick.
    pub buzz_n: f64,
    /// Largest difference between the contacts' loads and the wrench, relative.
    pub imbalance: f64,
    /// Contact normals that flipped.
    pub flips: u64,
}

/// What happened in the exercise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventsSummary {
    /// How many of each kind.
    pub counts: BTreeMap<&'static str, u64>,
    /// Times that the tilt became wrong.
    pub wrong_angles: u64,
    /// Share of the time in which the target was visible past the tongue; null without a target.
    pub visible_share: Option<f64>,
    /// Mean share of the target that the tongue left free; null without a target.
    pub mean_free: Option<f64>,
    /// Mean share that tongue and mirror left free; null without a target.
    pub mean_free_past_mirror: Option<f64>,
    /// Depths that were called, in order.
    pub calls: Vec<Called>,
}

impl EventsSummary {
    /// From counts and calls.
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
                "walking       {} zones reached, floor felt {} times, {} tilts wrong, {} times withdrawn, {} bleed",
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
            "tissue        {:.1} mm at most, {:.2} um from rest at the end, buzz {:.4} N",
            self.indentation_mm, self.unrest_um, self.buzz_n
        )
    }
}

impl DemoSummary {
    /// Leaves out what a learner is not to see before their own score is given, or before an exam is over: depths and grade.
    pub fn withhold(&mut self) {
        (self.pocket, self.grade) = (None, None);
        if let Some(events) = &mut self.events {
            events.calls.clear();
        }
    }

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
            "residual      {:.3} um at most{}, {} ticks exhausted",
            self.max_residual_um,
            match self.residual_every {
                1 => String::new(),
                every => format!(" (one tick of {every} looked at)"),
            },
            self.exhausted
        ));
        lines.push(format!("force         {:.2} N at most", self.max_force_n));
        if let Some(passivity) = &self.passivity {
            lines.push(format!(
                "energy        {:.3} mJ put out at most, {:.3} mJ taken out in {} damped periods",
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
                "grading       {}: see below; depths and grade are not shown here",
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
        lines.push("  look at the session in Rerun, moment by moment:".into());
        lines.push(format!(
            "    {cargo} sulcus-view --features rerun --bin sulcus-review -- {recording}"
        ));
        lines.push("  list its contents, replay it with an independent solver as judge:".into());
        for command in ["info", "replay --audit"] {
            lines.push(format!(
                "    {cargo} sulcus-sessions -- {command} {recording}"
            ));
        }
        if self.page.is_none() && (self.grade.is_some() || self.mode != Mode::Practice) {
            lines.push("  grade it:".into());
            lines.push(format!(
                "    {cargo} sulcus-sessions -- grade --html pages {recording}"
            ));
        }
        lines.join("\n")
    }
}

/// The grade, in short: the whole of it is for `sulcus-sessions grade`.
fn grade_lines(grade: &Grade) -> Vec<String> {
    let Some(score) = grade.score else {
        let why = grade.reason.as_deref().unwrap_or("for no reason known");
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
