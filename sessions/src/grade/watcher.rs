//! Watcher of a replay: events and evidence of every tick, without what happens in a pause or in a gap of the
//! connection.

use sulcus_core::output::{ForceZone, status};
use sulcus_core::{MAX_TOOLS, Scene, TickOutput, Workspace};

use super::evidence::{BLEEDING, Evidence, WITHDRAWN};
use super::settings::Settings;
use crate::exercise::Exercise;
use crate::exercise::events::{Events, Presence};
use crate::record::attach::Absence;
use crate::record::format::GAPS_SINCE;
use crate::record::occurrence::{FORCE_ZONE, Occurrence};
use crate::record::read::{ReadError, Recording};

/// Watcher of a replay. The replay calls it in every tick.
#[derive(Clone, Debug)]
pub struct Watcher {
    /// Events of the session.
    pub events: Events,
    /// Evidence so far.
    pub evidence: Evidence,
    settings: Settings,
    /// Number of the tick during a pause and during the ramp after it.
    paused: Option<u64>,
    /// Number of the last such tick.
    last_pause: Option<u64>,
    /// Gaps of the connection in the present recording, by its own ticks.
    absences: Vec<Absence>,
    /// Zone of force of each tool in its last tick that the hand felt.
    felt: [ForceZone; MAX_TOOLS],
    /// Whether a tool is behind a gap, and the hand does not feel its force yet.
    unfelt: [bool; MAX_TOOLS],
    /// Difference between the ticks of the session and those of the present recording.
    offset: u64,
    /// Number of the last tick of the session.
    last: u64,
}

impl Watcher {
    /// Watcher before the first tick.
    pub fn new(scene: &Scene, exercise: &Exercise, settings: Settings) -> Self {
        Self {
            events: Events::new(scene, exercise),
            evidence: Evidence::new(scene, exercise),
            settings,
            paused: None,
            last_pause: None,
            absences: Vec::new(),
            felt: [ForceZone::Light; MAX_TOOLS],
            unfelt: [false; MAX_TOOLS],
            offset: 0,
            last: 0,
        }
    }

    /// Prepares for the ticks of a recording: its gaps, and a clock that runs in them if the plan says so. A second
    /// recording continues the session of the first one. Returns the number to add to the ticks of the recording.
    ///
    /// # Errors
    /// The file has changed since it was opened.
    pub fn begin(&mut self, scene: &Scene, recording: &Recording) -> Result<u64, ReadError> {
        if recording.format() < GAPS_SINCE {
            self.events.ignore_gaps();
        } else {
            self.absences = Absence::all(recording)?;
        }
        let plan = recording.header().plan.as_ref();
        if plan.is_some_and(|plan| plan.clock_runs_in_gaps) {
            self.evidence.run_clock();
        }
        if self.last > 0 {
            self.events.cut();
            // Whole seconds keep the ticks at which sight is evaluated.
            let second = scene.params.ticks_in(1.0).max(1);
            self.offset = self.last.div_ceil(second).saturating_mul(second);
        }
        Ok(self.offset)
    }

    /// Takes in a tick. `shapes` is the workspace after the tick.
    pub fn observe(&mut self, scene: &Scene, output: &TickOutput, shapes: &Workspace) {
        let away = self.absences.iter().any(|gap| gap.contains(output.tick));
        self.events.set_detached(away);
        let output = &TickOutput {
            tick: output.tick.saturating_add(self.offset),
            ..*output
        };
        self.last = output.tick;
        let was = self.paused;
        let held = output
            .tools
            .iter()
            .filter(|tool| tool.status & status::ABSENT == 0);
        let bits = held.fold(0, |bits, tool| bits | tool.status);
        let still = was.is_some() && bits & status::RAMPING != 0;
        self.paused = (bits & status::PAUSED != 0 || still).then_some(output.tick);
        self.last_pause = self.paused.or(self.last_pause);
        for said in self.events.observe(scene, output, shapes) {
            // Bleeding that appears in a pause, or after it, comes from before the pause.
            let counts = said.kind == BLEEDING || self.paused.is_none();
            // Behind a gap the force of the ramp is judged at its end.
            let tool = said.data["tool"]
                .as_u64()
                .and_then(|tool| usize::try_from(tool).ok());
            let unfelt = said.kind == FORCE_ZONE
                && tool.is_some_and(|tool| self.unfelt.get(tool) == Some(&true));
            if counts
                && !unfelt
                && !self
                    .last_pause
                    .is_some_and(|tick| began_by(&said, tick, scene))
            {
                self.evidence.happened(&said);
            }
        }
        if self.paused.is_some() {
            self.evidence.pauses(output.tick, scene.tick_s());
            return;
        }
        if self.events.away().is_whole() {
            self.unfelt = std::array::from_fn(|t| self.unfelt[t] || self.is_unfelt(t));
            self.evidence.is_away(output.tick, scene.tick_s());
            return;
        }
        if was.is_some() {
            // A force that lasts over the end of the pause is felt from now on.
            let zones = output.tools.iter().filter_map(|tool| tool.pocket);
            zones.for_each(|reading| self.evidence.enters(reading.zone));
        }
        self.feels(output);
        self.evidence
            .observe(scene, output, &self.events, shapes, &self.settings);
    }

    /// Whether the hand does not feel the force of a tool in this tick: in a gap, and in the ramp behind it.
    fn is_unfelt(&self, tool: usize) -> bool {
        self.events.away().of(tool) != Presence::Here
    }

    /// Takes in the zones of force that the hands feel. A zone that was entered in a gap or in its ramp, and lasts,
    /// counts from its first felt tick, if it is heavier than the zone before the gap.
    fn feels(&mut self, output: &TickOutput) {
        for (t, tool) in output.tools.iter().enumerate() {
            let unfelt = self.is_unfelt(t);
            let ended = std::mem::replace(&mut self.unfelt[t], unfelt) && !unfelt;
            if unfelt {
                continue;
            }
            let zone = tool.pocket.map_or(ForceZone::Light, |pocket| pocket.zone);
            if ended && zone > self.felt[t] {
                self.evidence.enters(zone);
            }
            self.felt[t] = zone;
        }
    }
}

/// Whether a withdrawal began before or in a pause that lasted until `tick`. A pause makes the hand let go.
fn began_by(said: &Occurrence, tick: u64, scene: &Scene) -> bool {
    let ago = said.data["seconds"].as_f64().unwrap_or_default() / scene.tick_s();
    said.kind == WITHDRAWN && said.tick as f64 - ago <= tick as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::{SET, empty_scene};
    use sulcus_core::output::{ForceZone, PocketReading};
    use sulcus_core::{MAX_TOOLS, Pose, ToolOutput, Vec3};

    /// In a pause nobody feels a force; earlier versions counted it as trauma and as a heavy hand.
    #[test]
    fn what_is_done_in_a_pause_counts_for_nothing() {
        let scene = empty_scene();
        let exercise = Exercise::built_in();
        let exercise = exercise.iter().find(|one| one.name == "retraction");
        let exercise = exercise.expect("built in");
        let mut watcher = Watcher::new(&scene, exercise, SET);
        let shapes = Workspace::new(&scene);
        let mut output = TickOutput {
            work: 0,
            tick: 0,
            hash: 0,
            tools: [ToolOutput::absent(Pose::identity()); MAX_TOOLS],
        };
        // A tool without a hand is never at full strength.
        output.tools[0].status = status::ABSENT | status::RAMPING;
        let mut hold = |status: u16, force: f64, ticks: u32| {
            for _ in 0..ticks {
                output.tick += 1;
                output.tools[1].status = status;
                output.tools[1].raw_wrench.force = Vec3::new(0.0, 0.0, force);
                watcher.observe(&scene, &output, &shapes);
            }
            let evidence = &watcher.evidence;
            (evidence.mirror.peak(), evidence.hands.span_s())
        };
        let near = |found: (Option<f64>, Option<f64>), peak: f64, seconds: f64| {
            let (a, b) = (found.0.expect("pressed"), found.1.expect("held"));
            assert!(
                (a - peak).abs() < 1e-9 && (b - seconds).abs() < 1e-9,
                "{found:?}"
            );
        };
        near(hold(0, 1.0, 100), 1.0, 0.1);
        near(hold(status::PAUSED, 9.0, 5000), 1.0, 0.1);
        near(hold(status::RAMPING, 9.0, 100), 1.0, 0.1);
        near(hold(0, 1.0, 100), 1.0, 0.2);
        // A ramp without a pause before it is no pause.
        near(hold(status::RAMPING, 2.0, 100), 2.0, 0.3);
    }

    #[test]
    fn what_goes_on_over_the_end_of_a_pause_is_judged_by_when_it_began() {
        let scene = empty_scene();
        let exercise = Exercise::free("free", 1.0);
        let mut watcher = Watcher::new(&scene, &exercise, SET);
        let shapes = Workspace::new(&scene);
        let mut output = TickOutput {
            work: 0,
            tick: 0,
            hash: 0,
            tools: [ToolOutput::absent(Pose::identity()); MAX_TOOLS],
        };
        let mut press = |status: u16, zone: ForceZone| {
            output.tick += 1;
            output.tools[0].status = status;
            output.tools[0].pocket = Some(PocketReading {
                object: 0,
                around: 0.0,
                depth: 2e-3,
                floor_force: 2.5,
                zone,
                entered_zone: false,
            });
            watcher.observe(&scene, &output, &shapes);
            (watcher.evidence.trauma, watcher.evidence.damage)
        };
        assert_eq!(press(0, ForceZone::Light), (0, 0));
        assert_eq!(press(status::PAUSED, ForceZone::Damage), (0, 0));
        assert_eq!(press(status::RAMPING, ForceZone::Damage), (0, 0));
        // The force lasts over the end of the pause.
        assert_eq!(press(0, ForceZone::Damage), (0, 1));
        assert_eq!(press(0, ForceZone::Damage), (0, 1));
        // Tick 3 was the last of the pause. The tips left at ticks 2 and 5.
        let said = |tick: u64, seconds: f64| Occurrence {
            kind: WITHDRAWN.into(),
            tick,
            data: serde_json::json!({ "seconds": seconds }),
        };
        assert!(began_by(&said(8, 6e-3), 3, &scene));
        assert!(!began_by(&said(8, 3e-3), 3, &scene));
        assert_eq!((WITHDRAWN, BLEEDING), ("withdrawn", "bleeding"));
    }
}
