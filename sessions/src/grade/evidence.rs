//! What a grade rests on, gathered tick by tick from a replay.

use std::collections::{BTreeMap, BTreeSet};

use sulcus_core::contact::Contact;
use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput, Workspace};

use super::crown::Crown;
use super::floor::FloorTime;
use super::hands::{Hands, Moment, Pressed, Steady};
use super::moves::Moves;
use super::rubric::Settings;
use super::series::Series;
use super::touches::{BEGINS, Touches};
use super::zones::{STAYED, Span, TIE, Zones};
use crate::events::sight::is_tongue;
use crate::events::{Events, Standing, pocket};
use crate::exercise::{Exercise, ProbingTask};
use crate::occurrence::{FORCE_ZONE, Occurrence};

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
            self.moves[t].observe(tip);
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
        self.stays(standing, dt);
        self.touches.observe(standing, dt);
        let mirror = self.mirror_slot.filter(held);
        let mirror = mirror.map(|t| output.tools[t].graphic.transform(&scene.tools[t].tip));
        // A mirror in the air, or on a tooth, holds no tongue, however still it is.
        let bears = self.mirror_slot.filter(held).is_some_and(|t| {
            let on_tongue = |contact: &Contact| {
                usize::from(contact.tool) == t
                    && self.tongues.get(usize::from(contact.object)) == Some(&true)
            };
            let loads = shapes.contacts();
            let loads = loads.filter(|(contact, _)| on_tongue(contact));
            loads.map(|(_, load)| load).sum::<f64>() >= FREE
        });
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

    /// Enters the zone on whose floor the tip has borne long enough in one visit.
    pub(super) fn stays(&mut self, at: Option<&Standing>, dt: f64) {
        self.here = at.map(|at| {
            let zone = (at.tooth, at.site);
            let before = self.here.filter(|(there, _)| *there == zone);
            let more = if at.force >= BEGINS { dt } else { 0.0 };
            (zone, before.map_or(0.0, |(_, seconds)| seconds) + more)
        });
        let long = |(_, seconds): &((u8, Site), f64)| *seconds >= STAYED - TIE;
        self.entered
            .extend(self.here.filter(long).map(|(zone, _)| zone));
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
            FORCE_ZONE if is("zone", "trauma") => self.trauma += 1,
            FORCE_ZONE if is("zone", "damage") => self.damage += 1,
            "withdrawn" if zone("to").is_none_or(|to| !self.entered.contains(&to)) => {
                self.withdrawals += 1;
            }
            "bleeding" => self.bled.extend(zone("site")),
            _ => {}
        }
    }
}

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
}

impl Watcher {
    /// Before the first tick.
    pub fn new(scene: &Scene, exercise: &Exercise, settings: Settings) -> Self {
        Self {
            events: Events::new(scene, exercise),
            evidence: Evidence::new(scene, exercise),
            settings,
        }
    }

    /// Takes in a tick; `shapes` is the workspace as that tick left it.
    pub fn observe(&mut self, scene: &Scene, output: &TickOutput, shapes: &Workspace) {
        for said in self.events.observe(scene, output, shapes) {
            self.evidence.happened(&said);
        }
        self.evidence
            .observe(scene, output, &self.events, shapes, &self.settings);
    }
}
