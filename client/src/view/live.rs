//! A running session, as its window shows it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use sulcus_connection::device::{DeviceEvent, Glance};
use sulcus_connection::display::{Cache, DisplayLink};
use sulcus_connection::link::{LinkError, now_ns};
use sulcus_core::MAX_TOOLS;
use sulcus_core::math::norm;
use sulcus_haptics::Stage;
use sulcus_program::tell;
use sulcus_proto::TOOLS;
use sulcus_proto::control::Command;
use sulcus_proto::display::{DisplayScene, SceneHash};
use sulcus_screen::depth;
use sulcus_screen::hand::Shared;
use sulcus_screen::handed::Person;
use sulcus_screen::moment::{Moment, ToolAt};
use sulcus_screen::panel::{
    Clock, Detail, Help, Link, Mode, Next, PanelState, Primitive, Recording, Status, ToolForce,
    Tour, Trace, Warning,
};
use sulcus_screen::readings::{Heard, READING_CALLED, Readings, Site, Stop, Wrong};
use sulcus_screen::show::{Act, Show};
use sulcus_screen::strings::ENGLISH;

use super::on_screen::{self, wire};
use super::watched::Eyes;
use super::{Facts, Helpers, Seated};

/// Time without a pass of the device's loop after which the link counts as lost, nanoseconds.
const SILENT_NS: u64 = 1_000_000_000;
/// Time for which a message of an instructor is shown.
const MESSAGE: Duration = Duration::from_secs(30);

/// Session behind a window.
pub struct Live {
    facts: Facts,
    person: Person,
    helpers: Helpers,
    eyes: Eyes,
    hands: Option<Arc<Shared>>,
    display: DisplayLink,
    over: Arc<AtomicBool>,
    readings: Option<Readings>,
    wrong: Option<Wrong>,
    traces: Vec<Trace>,
    /// Tick at which the blood was wiped away the last time.
    wiped: u64,
    tick: u64,
    /// Depth that the bands show, mm.
    depth_mm: Option<f64>,
    /// Newest message of an instructor, with the time of its arrival.
    message: Option<(String, Instant)>,
    /// Whether acts and sizes of pictures are told, as `--stats` asks.
    has_stats: bool,
    /// Size of the newest picture, pixels.
    size: Option<[u32; 2]>,
    /// Size that was told last, pixels.
    told: Option<[u32; 2]>,
}

impl Live {
    /// Session with a display's connection of its own. The settings of the person become an event of the recording.
    /// `has_stats` asks for a line on standard error for each act, and for each new size of the pictures.
    ///
    /// # Errors
    /// The system has no thread for the connection.
    pub fn new(
        seated: Seated,
        person: Person,
        helpers: Helpers,
        over: Arc<AtomicBool>,
        has_stats: bool,
    ) -> Result<Self, LinkError> {
        let Seated { facts, eyes, hands } = seated;
        let display = DisplayLink::begin(&facts.config, Cache::in_default_folder())?;
        let stop = |(tooth, site): &(u8, &'static str)| {
            let site = Site::from_name(site)?;
            Some(Stop {
                tooth: *tooth,
                site,
            })
        };
        let tour: Vec<Stop> = facts.tour.iter().filter_map(stop).collect();
        let (kind, json) = person.event(&facts.tools);
        let mut live = Self {
            person,
            helpers,
            display,
            over,
            readings: (!tour.is_empty()).then(|| Readings::new(tour)),
            wrong: None,
            traces: facts.tools.iter().map(|_| Trace::default()).collect(),
            wiped: 0,
            tick: 0,
            depth_mm: None,
            message: None,
            has_stats,
            size: None,
            told: None,
            facts,
            eyes,
            hands,
        };
        live.say(kind, json);
        Ok(live)
    }

    /// State of the newest pass.
    pub(super) fn glance(&mut self) -> Option<Glance> {
        self.eyes.glances.update();
        *self.eyes.glances.output_buffer()
    }

    /// Sends an event for the recording.
    pub(super) fn say(&mut self, kind: &'static str, json: String) {
        // The ring is full only if the device's loop has ended.
        let _ = self.eyes.events.push(DeviceEvent { kind, json });
    }

    /// Takes the size of a picture before the picture is drawn. A new size is told after the first picture of that size
    /// in the running session: the window then shows the session and takes keys.
    fn tell_size(&mut self, window: [u32; 2]) {
        let is_running = self.tick > 0;
        let before = self.size.replace(window);
        let drawn = before.filter(|drawn| is_running && self.told != Some(*drawn));
        if let Some([width, height]) = drawn.filter(|_| self.has_stats) {
            tell!("window        draws {width} x {height} pixels");
            self.told = drawn;
        }
    }

    /// Speaks the next step. An exam has none.
    fn speak(&mut self, state: &PanelState) {
        let Some(voice) = &mut self.helpers.voice else {
            return;
        };
        let next = Next::of(state.tour.as_ref(), &state.help, &state.status);
        let next = next.filter(|_| state.mode == Mode::Practice);
        let text = next.map(|next| next.sentence(&ENGLISH));
        voice.follow(text.as_deref(), Instant::now());
    }

    /// Newest message of an instructor, as long as it is shown.
    fn message(&mut self) -> Option<String> {
        while let Ok(text) = self.eyes.texts.pop() {
            self.message = Some((text, Instant::now()));
        }
        self.message.take_if(|(_, since)| since.elapsed() > MESSAGE);
        self.message.as_ref().map(|(text, _)| text.clone())
    }

    fn status(&self, glance: Option<&Glance>) -> Status {
        let is_live =
            glance.is_some_and(|glance| now_ns().saturating_sub(glance.now_ns) < SILENT_NS);
        let link = match glance {
            Some(glance) if glance.is_returning => Link::Returning,
            Some(glance) if is_live => Link::Up(
                glance
                    .age_ms
                    .map(|ms| ms.clamp(0.0, 60_000.0).round() as u16),
            ),
            _ => Link::Lost,
        };
        let mut warnings = Vec::new();
        // Neither device displays a force.
        if ["simulated", on_screen::NAME].contains(&&*self.facts.device) {
            warnings.push(Warning::NoForce(self.facts.device.clone()));
        }
        let stages = glance.map_or([None; MAX_TOOLS], |glance| glance.stages);
        for (tool, stage) in self.facts.tools.iter().zip(stages) {
            if let Some(stage) = stage.filter(|stage| *stage != Stage::Live) {
                warnings.push(Warning::Other(format!("{tool}: {stage}")));
            }
        }
        if let Some(trouble) = self.display.trouble() {
            warnings.push(Warning::Other(trouble));
        }
        let levels = glance.map(|glance| glance.levels).unwrap_or_default();
        let limit = levels.force_limit_n;
        Status {
            link,
            // The server records every session from its first tick on.
            recording: if is_live {
                Recording::On
            } else {
                Recording::Off
            },
            paused_by_student: levels.paused_by_student,
            paused_by_station: levels.paused_by_station,
            force_limit_n: (limit > 0.0).then_some(f64::from(limit)),
            person: Some(self.person),
            message: None,
            warnings,
        }
    }
}

impl Show for Live {
    fn scene(&mut self) -> Option<(SceneHash, Arc<DisplayScene>)> {
        let picture = self.display.newest()?;
        Some((picture.hash, picture.scene.clone()))
    }

    fn moment(&mut self) -> Option<(Moment, f64)> {
        let glance = self.glance();
        let picture = self.display.newest()?;
        let mut moment = match &picture.frame {
            Some(frame) => Moment::of(&picture.scene, frame),
            None => Moment::rest(&picture.scene),
        };
        let Some(glance) = glance else {
            return Some((moment, 0.0));
        };
        self.tick = glance.tick;
        // The link's own answers are newer than the feed.
        for (k, tool) in moment.tools.iter_mut().enumerate() {
            if let Some(pose) = glance.graphics[k].filter(|_| glance.held[k]) {
                *tool = ToolAt::new(true, &wire(&pose));
            }
        }
        let wiped = self.wiped;
        moment.spots.retain(|(spot, _)| spot.since > wiped);
        self.depth_mm = depth::by_bands(&picture.scene, &moment);
        if let Some(player) = &mut self.helpers.player {
            let forces = std::array::from_fn(|k| norm(&glance.displayed[k].force));
            let now_s = glance.tick as f64 * self.facts.tick_ns as f64 / 1e9;
            player.follow(now_s, &picture.scene, &moment, forces);
        }
        let age_s = now_ns().saturating_sub(glance.now_ns) as f64 / 1e9;
        Some((moment, age_s))
    }

    fn panel(&mut self, detail: Detail) -> PanelState {
        let glance = self.glance();
        let mut tools = Vec::new();
        let scene = self.display.newest().map(|picture| picture.scene.clone());
        let has_bands = |k: usize| {
            let tool = scene.as_ref().and_then(|scene| scene.tools.get(k));
            tool.is_some_and(|tool| !tool.bands.is_empty())
        };
        for (k, name) in self.facts.tools.iter().enumerate() {
            let Some(trace) = self.traces.get_mut(k) else {
                continue;
            };
            let force_n = glance.map_or(0.0, |glance| norm(&glance.displayed[k].force));
            trace.push(force_n as f32);
            tools.push(ToolForce {
                name: name.clone(),
                force_n,
                zone_n: self.facts.zone_n.filter(|_| has_bands(k)),
                trace: trace.clone(),
            });
        }
        let tick_s = self.facts.tick_ns as f64 / 1e9;
        let state = PanelState {
            mode: Mode::of(&self.facts.mode),
            clock: Clock {
                elapsed_s: glance.map_or(0.0, |glance| glance.tick as f64 * tick_s),
                length_s: self.facts.length_s,
            },
            tour: self
                .readings
                .as_ref()
                .map(|readings| Tour::of(readings, self.wrong)),
            status: Status {
                message: self.message(),
                ..self.status(glance.as_ref())
            },
            help: Help {
                title: self.facts.title.clone(),
                task: self.facts.task.clone(),
                tools,
                depth_mm: self.depth_mm,
                detail,
            },
        };
        self.speak(&state);
        state
    }

    fn overlay(&mut self, window: [u32; 2], _scale: f32) -> Option<Vec<Primitive>> {
        self.tell_size(window);
        None
    }

    fn ghosts(&mut self) -> [Option<ToolAt>; TOOLS] {
        let ghosts = self
            .glance()
            .map_or([None; MAX_TOOLS], |glance| glance.ghost);
        ghosts.map(|pose| pose.map(|pose| ToolAt::new(true, &wire(&pose))))
    }

    fn act(&mut self, act: Act) {
        if self.has_stats {
            tell!("window act    {act:?}");
        }
        if let Some((kind, json)) = act.event() {
            self.say(kind, json);
        }
        match act {
            Act::Reading(key) => {
                let Some(readings) = &mut self.readings else {
                    return;
                };
                match readings.press(key) {
                    Heard::Confirmed(entry) => {
                        self.wrong = None;
                        self.say(READING_CALLED, entry.json());
                    }
                    Heard::Taken => self.wrong = None,
                    Heard::Wrong(wrong) => self.wrong = Some(wrong),
                }
            }
            Act::Pause => {
                let paused = self
                    .glance()
                    .is_some_and(|glance| glance.levels.paused_by_student);
                let command = if paused {
                    Command::Resume
                } else {
                    Command::Pause
                };
                // The ring is full only if the device's loop has ended.
                let _ = self.eyes.commands.push(command);
            }
            Act::Wipe => self.wiped = self.tick,
            Act::StartForce => {
                self.eyes.starts.fetch_add(1, Ordering::Relaxed);
            }
            Act::View(_) | Act::Camera { .. } | Act::Head(_) | Act::Panel(_) => {}
        }
    }

    fn hands(&self) -> Option<Arc<Shared>> {
        self.hands.clone()
    }

    fn is_over(&mut self) -> bool {
        self.over.load(Ordering::Acquire)
    }
}
