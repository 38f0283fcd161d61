//! What a grade rests on, gathered tick by tick from a replay.

use std::collections::{BTreeMap, BTreeSet};

use sulcus_core::contact::Contact;
use sulcus_core::math::norm;
use sulcus_core::output::{ForceZone, status};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput, Workspace};

use super::crown::Crown;
use super::floor::FloorTime;
use super::hands::{Hands, Moment, Pressed, Steady};
use super::rubric::Settings;
use super::touches::Touches;
use super::zones::{STAYED, Span, TIE, Zones};
use crate::exercise::events::sight::is_tongue;
use crate::exercise::events::{Events, Standing, pocket};
use crate::exercise::{Exercise, ProbingTask};
use crate::grade::motion::moves::Moves;
use crate::grade::motion::series::Series;
use crate::record::occurrence::{FORCE_ZONE, Occurrence};

/// All that was seen of a session.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Zones probed.
    pub zones: Zones,
    /// Touches of the floor.
    pub touches: Touches,
    /// Time on the floor.
    pub floor: FloorTime,
    /// Both hands.
    pub hands: Hands,
    /// How hard the mirror was pressed, and the probe.
    pub mirror: Pressed,
    /// See `mirror`.
    pub probe: Pressed,
    /// How far round the crown the probe went, where that is asked for.
    pub crown: Option<Crown>,
    /// The way of every tool.
    pub moves: [Moves; MAX_TOOLS],
    /// For plots.
    pub series: Series,
    /// Zones that bled, whatever the cause.
    pub bled: BTreeSet<(u8, Site)>,
    /// Times that the tip was withdrawn between two zones of a side, on its way to one on whose floor it had not stayed.
    pub withdrawals: usize,
    /// Entries into the zones of trauma and of damage.
    pub trauma: usize,
    /// See `trauma`.
    pub damage: usize,
    /// Slot of the tool that leads: the first probe, else the first tool.
    pub leading: usize,
    /// Depths prescribed, metres.
    floors: BTreeMap<(u8, Site), f64>,
    /// Zones on whose floor the tip stayed so far: who sweeps along the margin was in none.
    entered: BTreeSet<(u8, Site)>,
    /// Where the tip is now, and for how long it has borne on the floor there, seconds.
    here: Option<((u8, Site), f64)>,
    task: ProbingTask,
    steady: Steady,
    mirror_slot: Option<usize>,
    /// Of the scene's objects: which are tongues.
    tongues: Vec<bool>,
    has_zones: bool,
    first_tick: Option<u64>,
    last_tick: u64,
}

impl Evidence {
    /// Nothing seen yet.
    pub fn new(scene: &Scene, exercise: &Exercise) -> Self {
        let dt = scene.tick_s();
        let is_probe = |tool: &sulcus_core::Tool| !tool.bands.is_empty();
        let probe = scene.tools.iter().position(is_probe);
        Self {
            zones: Zones::default(),
            touches: Touches::default(),
            floor: FloorTime::default(),
            hands: Hands::default(),
            mirror: Pressed::default(),
            probe: Pressed::default(),
            crown: match exercise.kind {
                crate::exercise::Kind::Crown => Crown::of(scene),
                _ => None,
            },
            moves: std::array::from_fn(|_| Moves::new(dt)),
            series: Series::default(),
            bled: BTreeSet::new(),
            withdrawals: 0,
            trauma: 0,
            damage: 0,
            // Where the mirror alone is asked for, it leads.
            leading: match exercise.kind {
                crate::exercise::Kind::Retraction => scene.tools.iter().position(|t| !is_probe(t)),
                _ => probe,
            }
            .unwrap_or(0),
            floors: pocket::all(scene)
                .iter()
                .filter_map(|pocket| Some((pocket.fdi, pocket.gingiva(scene)?)))
                .flat_map(|(fdi, gingiva)| {
                    Site::ALL.map(|site| ((fdi, site), gingiva.prescribed(site).depth))
                })
                .collect(),
            entered: BTreeSet::new(),
            here: None,
            task: exercise.probing,
            steady: Steady::default(),
            mirror_slot: scene.tools.iter().position(|tool| !is_probe(tool)),
            tongues: scene
                .objects
                .iter()
                .map(|object| is_tongue(&object.tissue))
                .collect(),
            has_zones: !exercise.zones.is_empty(),
            first_tick: None,
            last_tick: 0,
        }
    }

    /// Takes in a tick, with `events` and `shapes` as they are after it.
    pub fn observe(
        &mut self,
        scene: &Scene,
        output: &TickOutput,
        events: &Events,
        shapes: &Workspace,
        set: &Settings,
    ) {
        let tick_s = scene.tick_s();
        let first = *self.first_tick.get_or_insert(output.tick);
        // What was skipped went by too.
        let ticks = match self.last_tick {
            0 => 1,
            last => output.tick.saturating_sub(last).max(1),
        };
        self.last_tick = output.tick;
        let dt = ticks as f64 * tick_s;
        let at_s = output.tick.saturating_sub(first) as f64 * tick_s;
        let present = |t: usize| output.tools[t].status & status::ABSENT == 0;
        let held = |t: &usize| *t < scene.tools.len() && present(*t);

        let mut standing = None;
        for (t, tool) in scene.tools.iter().enumerate() {
            let out = &output.tools[t];
            let here = held(&t);
            let force = norm(&out.raw_wrench.force);
            let in_pocket = events.standing(t).is_some();
            let tip = here.then(|| (out.graphic.transform(&tool.tip), force < FREE && !in_pocket));
            self.moves[t].observe(tip, ticks);
            if here {
                let pressed = if self.mirror_slot == Some(t) {
                    &mut self.mirror
                } else {
                    &mut self.probe
                };
                pressed.observe(force, dt, tick_s);
                if let Some(crown) = self.crown.as_mut().filter(|_| t == self.leading) {
                    crown.observe(&out.graphic.transform(&tool.tip), force, dt);
                }
            }
            standing = standing.or(events.standing(t));
        }
        if let Some(at) = standing {
            let floor = self.floors.get(&(at.tooth, at.site)).copied();
            let task = &self.task;
            let now = Span {
                tick: output.tick,
                to: output.tick as f64 * tick_s,
                dt,
            };
            self.zones.observe(at, now, set.force_n, task, floor);
            self.floor.observe(at, dt, set.force_n);
        }
        self.stays(standing, dt, set.force_n[0]);
        self.touches.observe(standing, dt);
        let mirror = self.mirror_slot.filter(held);
        let mirror = mirror.map(|t| output.tools[t].graphic.transform(&scene.tools[t].tip));
        let bears = self
            .mirror_slot
            .filter(held)
            .is_some_and(|t| self.on_tongue(t, shapes) >= FREE);
        let visible = events.is_target_visible();
        let moment = Moment {
            in_pocket: self
                .has_zones
                .then(|| standing.is_some_and(|at| at.depth > 0.0)),
            held: (0..MAX_TOOLS).any(|t| held(&t)),
            visible: visible == Some(true),
            holds: self.steady.observe(mirror, tick_s, set.steady_mm * 1e-3) && bears,
        };
        self.hands.observe(&moment, dt);
        let lead = Some(self.leading).filter(held);
        let push = lead.map_or(0.0, |t| norm(&output.tools[t].raw_wrench.force));
        self.series.observe(at_s, standing, push, visible);
    }

    /// What the tongue bears of the tool in a slot, newtons: in the air, or on a tooth, a mirror holds none, however still it is.
    fn on_tongue(&self, slot: usize, shapes: &Workspace) -> f64 {
        let is_tongue = |object: u16| self.tongues.get(usize::from(object)) == Some(&true);
        let on_tongue =
            |contact: &Contact| usize::from(contact.tool) == slot && is_tongue(contact.object);
        let loads = shapes.contacts();
        let loads = loads.filter(|(contact, _)| on_tongue(contact));
        loads.map(|(_, load)| load).sum()
    }

    /// What is done in a tick of a pause is no student's doing: the hand feels nothing, and no time is counted.
    fn pauses(&mut self, tick: u64, tick_s: f64) {
        self.last_tick = tick;
        self.moves
            .iter_mut()
            .for_each(|moves| moves.observe(None, 1));
        self.touches.observe(None, tick_s);
        self.here = None;
    }

    /// Enters the zone on whose floor the tip has borne, with `least` newtons or more, long enough in one visit.
    pub(super) fn stays(&mut self, at: Option<&Standing>, dt: f64, least: f64) {
        self.here = at.map(|at| {
            let zone = (at.tooth, at.site);
            let before = self.here.filter(|(there, _)| *there == zone);
            let more = if at.force >= least { dt } else { 0.0 };
            (zone, before.map_or(0.0, |(_, seconds)| seconds) + more)
        });
        let long = |(_, seconds): &((u8, Site), f64)| *seconds >= STAYED - TIE;
        self.entered
            .extend(self.here.filter(long).map(|(zone, _)| zone));
    }

    /// The force on a floor has come into a zone.
    fn enters(&mut self, zone: ForceZone) {
        match zone {
            ForceZone::Trauma => self.trauma += 1,
            ForceZone::Damage => self.damage += 1,
            ForceZone::Light | ForceZone::TooHeavy => {}
        }
    }

    /// Takes in what happened in the tick.
    pub fn happened(&mut self, said: &Occurrence) {
        let is = |key: &str, what: &str| said.data[key] == what;
        let zone = |site: &str| {
            let tooth = said.data["tooth"].as_u64();
            let tooth = tooth.and_then(|fdi| u8::try_from(fdi).ok())?;
            Some((tooth, Site::from_name(said.data[site].as_str()?)?))
        };
        match said.kind.as_str() {
            FORCE_ZONE if is("zone", "trauma") => self.enters(ForceZone::Trauma),
            FORCE_ZONE if is("zone", "damage") => self.enters(ForceZone::Damage),
            WITHDRAWN if zone("to").is_none_or(|to| !self.entered.contains(&to)) => {
                self.withdrawals += 1;
            }
            BLEEDING => self.bled.extend(zone("site")),
            _ => {}
        }
    }
}

/// Kinds of events ([`crate::exercise::events::KINDS`]).
const WITHDRAWN: &str = crate::exercise::events::KINDS[4];
const BLEEDING: &str = crate::exercise::events::KINDS[5];

/// A tool is free under so much force, newtons.
const FREE: f64 = 0.02;

/// Observes a session and everything in it, workspace included: what a replay calls in every tick.
#[derive(Clone, Debug)]
pub struct Watcher {
    /// The session's events.
    pub events: Events,
    /// What was gathered.
    pub evidence: Evidence,
    settings: Settings,
    /// The tick, while it is paused, or not at full strength again since.
    paused: Option<u64>,
    /// The last tick of which that was so.
    last_pause: Option<u64>,
}

impl Watcher {
    /// Before the first tick.
    pub fn new(scene: &Scene, exercise: &Exercise, settings: Settings) -> Self {
        Self {
            events: Events::new(scene, exercise),
            evidence: Evidence::new(scene, exercise),
            settings,
            paused: None,
            last_pause: None,
        }
    }

    /// Takes in a tick; `shapes` is the workspace as that tick left it.
    pub fn observe(&mut self, scene: &Scene, output: &TickOutput, shapes: &Workspace) {
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
            // Blood that shows in a pause, or after it, comes from before.
            let counts = said.kind == BLEEDING || self.paused.is_none();
            if counts
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
        if was.is_some() {
            // A force that was not let go of is felt from now on.
            let zones = output.tools.iter().filter_map(|tool| tool.pocket);
            zones.for_each(|reading| self.evidence.enters(reading.zone));
        }
        self.evidence
            .observe(scene, output, &self.events, shapes, &self.settings);
    }
}

/// Whether a withdrawal began in a pause that lasted until `tick`, or before it: the hand was told to let go then.
fn began_by(said: &Occurrence, tick: u64, scene: &Scene) -> bool {
    let ago = said.data["seconds"].as_f64().unwrap_or_default() / scene.tick_s();
    said.kind == WITHDRAWN && said.tick as f64 - ago <= tick as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::{SET, empty_scene};
    use crate::record::read::Recording;
    use crate::replay::{ReplayOptions, replay_observed};
    use sulcus_core::output::PocketReading;
    use sulcus_core::{Pose, ToolOutput, Vec3};

    /// Share of the ticks in which the tool in slot 0 bears on something in which the tongue bears it; of a recording of the corpus.
    fn share_on_tongue(name: &str) -> f64 {
        let path = format!("{}/tests/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
        let recording = Recording::open(path.as_ref()).expect("a recording");
        let scene = recording.scene().expect("a scene");
        let exercise = Exercise::recorded(&recording.header().exercise);
        let evidence = Evidence::new(&scene, &exercise);
        let (mut bears, mut on_tongue) = (0, 0);
        let options = ReplayOptions::default();
        replay_observed(
            &recording,
            &options,
            &mut |_| {},
            &mut |_, _, output, shapes| {
                if norm(&output.tools[0].raw_wrench.force) > 2.0 * FREE {
                    bears += 1;
                    on_tongue += u32::from(evidence.on_tongue(0, shapes) >= FREE);
                }
            },
        )
        .expect("a replay");
        assert!(bears > 100, "{name}: {bears}");
        f64::from(on_tongue) / f64::from(bears)
    }

    #[test]
    fn a_mirror_on_the_tongue_holds_it_and_a_tool_on_a_tooth_does_not() {
        let on_tongue = share_on_tongue("retraction.mcap");
        assert!(on_tongue > 0.99, "{on_tongue}");
        assert_eq!(share_on_tongue("crown.mcap"), 0.0);
    }

    /// A teacher's pause made trauma and a heavy hand of what nobody felt.
    #[test]
    fn what_is_done_in_a_pause_counts_for_nothing() {
        let scene = empty_scene();
        let exercise = Exercise::built_in();
        let exercise = exercise.iter().find(|one| one.name == "retraction");
        let exercise = exercise.expect("built in");
        let mut watcher = Watcher::new(&scene, exercise, SET);
        let shapes = Workspace::new(&scene);
        let mut output = TickOutput {
            tick: 0,
            hash: 0,
            tools: [ToolOutput::absent(Pose::identity()); MAX_TOOLS],
        };
        // (A tool that nobody holds is never at full strength.)
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
        // A ramp after anything else is no pause.
        near(hold(status::RAMPING, 2.0, 100), 2.0, 0.3);
    }

    #[test]
    fn what_goes_on_over_the_end_of_a_pause_is_judged_by_when_it_began() {
        let scene = empty_scene();
        let exercise = Exercise::free("free", 1.0);
        let mut watcher = Watcher::new(&scene, &exercise, SET);
        let shapes = Workspace::new(&scene);
        let mut output = TickOutput {
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
        // Still pressed when it is felt again.
        assert_eq!(press(0, ForceZone::Damage), (0, 1));
        assert_eq!(press(0, ForceZone::Damage), (0, 1));
        // Tick 3 was the last of the pause: out since tick 2, and out since tick 5.
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
