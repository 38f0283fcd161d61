//! Evidence of a session: every measure, gathered tick by tick from a replay.

use std::collections::{BTreeMap, BTreeSet};

use sulcus_core::contact::Contact;
use sulcus_core::math::norm;
use sulcus_core::output::{ForceZone, status};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput, Workspace};

use super::crown::Crown;
use super::floor_time::FloorTime;
use super::hands::{Hands, Moment, Steady};
use super::pressed::Pressed;
use super::settings::Settings;
use super::tolerances::{PROBED_S, TIE, TOUCH_N};
use super::touches::Touches;
use super::zones::{Span, Zones};
use crate::exercise::events::sight::is_tongue;
use crate::exercise::events::{Events, Presence, Standing, pocket};
use crate::exercise::{Exercise, ProbingTask};
use crate::grade::motion::moves::Moves;
use crate::grade::motion::series::Series;
use crate::record::occurrence::{FORCE_ZONE, Occurrence};

/// Evidence of a session.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Zones that the tip was in.
    pub zones: Zones,
    /// Touches of the floor.
    pub touches: Touches,
    /// Time on the floor.
    pub floor: FloorTime,
    /// Both hands.
    pub hands: Hands,
    /// Force on the mirror.
    pub mirror: Pressed,
    /// Force on the probes.
    pub probe: Pressed,
    /// Touched part of the crown, in an exercise on a crown.
    pub crown: Option<Crown>,
    /// Motion of every tool.
    pub moves: [Moves; MAX_TOOLS],
    /// Depth and force over time, for plots.
    pub series: Series,
    /// Zones that bled, from any cause.
    pub bled: BTreeSet<(u8, Site)>,
    /// Number of withdrawals between two zones of a side, on the way to a zone whose floor had not been felt.
    pub withdrawals: usize,
    /// Number of entries into the zone of trauma.
    pub trauma: usize,
    /// Number of entries into the zone of damage.
    pub damage: usize,
    /// Slot of the leading tool: the first mirror in a retraction, else the first probe, else the first tool.
    pub leading: usize,
    /// Prescribed depths, metres.
    floors: BTreeMap<(u8, Site), f64>,
    /// Zones whose floor has been felt. A sweep along the margin feels none.
    entered: BTreeSet<(u8, Site)>,
    /// Present zone, and the time of the force on its floor in this visit, seconds.
    here: Option<((u8, Site), f64)>,
    task: ProbingTask,
    steady: Steady,
    mirror_slot: Option<usize>,
    /// Whether an object is a tongue, by its index in the scene.
    tongues: Vec<bool>,
    has_zones: bool,
    first_tick: Option<u64>,
    last_tick: u64,
    /// Ticks in gaps of the connection.
    away: Gone,
    /// Whether the clock of the session runs in these gaps.
    clock_runs: bool,
}

/// Gaps of the connection so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gone {
    /// Number of gaps in which the student was away.
    pub gaps: u64,
    /// Ticks of the grid in these gaps.
    pub ticks: u64,
    /// Whether the last tick was in such a gap.
    now: bool,
}

impl Evidence {
    /// Empty evidence, before the first tick.
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
            // A retraction is a task for the mirror alone.
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
            away: Gone::default(),
            clock_runs: false,
        }
    }

    /// Lets the clock of the session run in gaps of the connection.
    pub(super) fn run_clock(&mut self) {
        self.clock_runs = true;
    }

    /// Gaps of the connection so far.
    pub fn gone(&self) -> Gone {
        self.away
    }

    /// Takes in a tick. `events` and `shapes` are those after the tick.
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
        // Skipped ticks belong to this tick.
        let ticks = match self.last_tick {
            0 => 1,
            last => output.tick.saturating_sub(last).max(1),
        };
        self.last_tick = output.tick;
        self.away.now = false;
        let dt = ticks as f64 * tick_s;
        let left_out = if self.clock_runs { 0 } else { self.away.ticks };
        let at_s = output.tick.saturating_sub(first + left_out) as f64 * tick_s;
        let away = events.away();
        let present =
            |t: usize| output.tools[t].status & status::ABSENT == 0 && away.of(t) != Presence::Away;
        let held = |t: &usize| *t < scene.tools.len() && present(*t);

        let mut standing = None;
        // Behind a gap the hand feels less than the tick's force until the ramp ends.
        let mut unfelt = false;
        for (t, tool) in scene.tools.iter().enumerate() {
            let out = &output.tools[t];
            if away.of(t) == Presence::Away {
                continue;
            }
            let here = held(&t);
            let force = norm(&out.raw_wrench.force);
            let in_pocket = events.standing(t).is_some();
            let at = out.graphic.transform(&tool.tip);
            if here && away.returned(t).is_some() {
                self.moves[t].returns(at);
            }
            let tip = here.then_some((at, force < TOUCH_N && !in_pocket));
            self.moves[t].observe(tip, ticks);
            let settles = away.of(t) == Presence::Settling;
            let heavy = |at: &&Standing| at.force > set.force_n[1];
            unfelt |= settles && events.standing(t).filter(heavy).is_some();
            if here && !settles {
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
        let works = !unfelt && away.of(self.leading) != Presence::Away;
        if let Some(at) = standing.filter(|_| works) {
            let floor = self.floors.get(&(at.tooth, at.site)).copied();
            let task = &self.task;
            let now = Span {
                tick: output.tick,
                // No time passes in a gap, so a force that stands over the gap goes on.
                to: (output.tick - self.away.ticks) as f64 * tick_s,
                dt,
            };
            self.zones.observe(at, now, set.force_n, task, floor);
            self.floor.observe(at, dt, set.force_n);
        }
        if works {
            self.stays(standing, dt, set.force_n[0]);
            self.touches.observe(standing, dt);
        }
        let mirror = self.mirror_slot.filter(held);
        let mirror = mirror.map(|t| output.tools[t].graphic.transform(&scene.tools[t].tip));
        let bears = self
            .mirror_slot
            .filter(held)
            .is_some_and(|t| self.on_tongue(t, shapes) >= TOUCH_N);
        let visible = events.is_target_visible();
        let lead = Some(self.leading).filter(held);
        let push = lead.map_or(0.0, |t| norm(&output.tools[t].raw_wrench.force));
        let now = (output.tick, at_s);
        self.series.observe(now, standing, push, visible);
        if away.any() {
            return;
        }
        let moment = Moment {
            in_pocket: self
                .has_zones
                .then(|| standing.is_some_and(|at| at.depth > 0.0)),
            held: (0..MAX_TOOLS).any(|t| held(&t)),
            visible: visible == Some(true),
            holds: self.steady.observe(mirror, tick_s, set.steady_mm * 1e-3) && bears,
        };
        self.hands.observe(&moment, dt);
    }

    /// Force of the tool in a slot on tongues, newtons. A mirror in the air or on a tooth holds no tongue.
    fn on_tongue(&self, slot: usize, shapes: &Workspace) -> f64 {
        let is_tongue = |object: u16| self.tongues.get(usize::from(object)) == Some(&true);
        let on_tongue =
            |contact: &Contact| usize::from(contact.tool) == slot && is_tongue(contact.object);
        let loads = shapes.contacts();
        let loads = loads.filter(|(contact, _)| on_tongue(contact));
        loads.map(|(_, load)| load).sum()
    }

    /// Takes in a tick of a pause. The hand feels nothing, so nothing counts and no time passes.
    pub(super) fn pauses(&mut self, tick: u64, tick_s: f64) {
        self.last_tick = tick;
        self.moves
            .iter_mut()
            .for_each(|moves| moves.observe(None, 1));
        self.touches.observe(None, tick_s);
        self.here = None;
    }

    /// Takes in a tick of a gap of the connection. Nothing counts, and whatever lasted before the gap goes on behind
    /// it.
    pub(super) fn is_away(&mut self, tick: u64, tick_s: f64) {
        let ticks = match self.first_tick {
            Some(_) => tick.saturating_sub(self.last_tick),
            None => 0,
        };
        self.last_tick = tick;
        self.away.gaps += u64::from(!self.away.now);
        self.away.now = true;
        self.away.ticks += ticks;
        if self.clock_runs {
            self.hands.waits(ticks as f64 * tick_s);
        }
    }

    /// Takes in the place of the tip. A zone is felt after [`PROBED_S`] with `least` newtons or more in one visit.
    pub(super) fn stays(&mut self, at: Option<&Standing>, dt: f64, least: f64) {
        self.here = at.map(|at| {
            let zone = (at.tooth, at.site);
            let before = self.here.filter(|(there, _)| *there == zone);
            let more = if at.force >= least { dt } else { 0.0 };
            (zone, before.map_or(0.0, |(_, seconds)| seconds) + more)
        });
        let long = |(_, seconds): &((u8, Site), f64)| *seconds >= PROBED_S - TIE;
        self.entered
            .extend(self.here.filter(long).map(|(zone, _)| zone));
    }

    /// Takes in the entry of the force on a floor into a zone of force.
    pub(super) fn enters(&mut self, zone: ForceZone) {
        match zone {
            ForceZone::Trauma => self.trauma += 1,
            ForceZone::Damage => self.damage += 1,
            ForceZone::Light | ForceZone::TooHeavy => {}
        }
    }

    /// Takes in an event of the tick.
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

/// Kind of the event that the tip was withdrawn between two zones of a side.
pub(super) const WITHDRAWN: &str = crate::exercise::events::KINDS[4];
/// Kind of the event that a zone bleeds.
pub(super) const BLEEDING: &str = crate::exercise::events::KINDS[5];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::read::Recording;
    use crate::replay::{ReplayOptions, replay_observed};

    /// Share of the contact ticks of tool 0 with a force on a tongue, in a recording of the corpus.
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
                if norm(&output.tools[0].raw_wrench.force) > 2.0 * TOUCH_N {
                    bears += 1;
                    on_tongue += u32::from(evidence.on_tongue(0, shapes) >= TOUCH_N);
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
}
