//! What happens in an exercise, found out tick by tick: pure functions of the scene, the exercise, and what a tick puts
//! out, the tick's shapes included. The live server, the demo in virtual time and whoever replays a recording run the
//! same code and come to the same events, bit for bit.
//!
//! | kind | when | data |
//! |---|---|---|
//! | `site_reached` | a probe's tip comes into a zone | tool, tooth, site, depth_mm |
//! | `floor_felt` | force on the floor rises into the reading band | tool, tooth, site, depth_mm, force_n |
//! | `angle` | the tilt becomes wrong, or right again | tool, tooth, site, right, and the tilt in parts |
//! | `left_site` | the tip leaves a zone | tool, tooth, site, deepest_mm, max_force_n, seconds |
//! | `withdrawn` | it stays 0.2 s in a zone, and came out of the pocket since it last did in another of that side | tool, tooth, from, to, seconds since it came out |
//! | `bleeding` | after a site that bleeds, or trauma | tool, tooth, site, cause |
//! | `force_zone` | a hand becomes too heavy ([`Occurrence::force_zone`]) | |
//! | `target_visible`, `target_hidden` | by rays from the eye | tooth, free, free_past_mirror, of |
//! | `paused`, `resumed`, `force_limit` | the station's side or the student changes its level ([`LEVELS`]) | by, force_limit_n |
//! | `reading_called` | a client says it ([`call`]) | tooth, site, depth_mm, and where called recession_mm, bleeding, furcation |
//!
//! Forces are in newtons, depths along the tooth's axis below the gingival margin, angles in degrees. Nothing here
//! reads a clock; time is the tick's number, so that skipped ticks count.

pub mod angle;
mod bleeding;
pub mod call;
pub(crate) mod pocket;
pub mod rays;
pub mod sight;
pub mod standing;
mod tally;
mod visit;

use serde_json::json;
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput, Vec3, Workspace};

use crate::exercise::Exercise;
use crate::record::occurrence::Occurrence;

pub use sight::Look;
pub use standing::Standing;
pub use tally::Tally;

use bleeding::Bleeding;
use pocket::Pocket;
use sight::Sight;
use visit::{Probe, Seen};

/// Kinds of events that are found here, in the order of [`Tally::counts`].
pub const KINDS: [&str; 9] = [
    "site_reached",
    "floor_felt",
    "angle",
    "left_site",
    "withdrawn",
    "bleeding",
    crate::record::occurrence::FORCE_ZONE,
    "target_visible",
    "target_hidden",
];

/// Whether a client may send an event of this kind: one word of lower-case letters, digits and underscores, and none of those that
/// only a station says. (A line of the log holds the kind as it is: any other could be taken for another line.)
pub fn may_a_client_say(kind: &str) -> bool {
    let word = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_';
    !kind.is_empty()
        && kind.bytes().all(word)
        && !KINDS.contains(&kind)
        && !LEVELS.contains(&kind)
        && kind != LOST
}

/// Kinds of the events that a pause or a force limit has changed: `by` (`station` or `student`) says whose level, and
/// `force_limit_n` the limit in newtons, 0 for none of that side's own.
pub const LEVELS: [&str; 3] = [PAUSED, RESUMED, FORCE_LIMIT];
/// Kind of the event that one side has paused.
pub const PAUSED: &str = "paused";
/// Kind of the event that one side has lifted its pause.
pub const RESUMED: &str = "resumed";
/// Kind of the event that one side has set its force limit.
pub const FORCE_LIMIT: &str = "force_limit";

/// Kind of the event that more came from a client than was recorded.
pub const LOST: &str = "client_events_lost";

/// Events of one session, as far as it has gone.
#[derive(Clone, Debug)]
pub struct Events {
    exercise: Exercise,
    pockets: Vec<Pocket>,
    probes: [Probe; MAX_TOOLS],
    bleeding: Bleeding,
    sight: Option<Sight>,
    look: Look,
    /// Where the spheres of the look go, when they are read here.
    centres: Vec<Vec3>,
    missing: Vec<String>,
    tally: Tally,
    said: Vec<Occurrence>,
}

impl Events {
    /// Nothing has happened yet. What of the exercise the scene lacks is in [`Events::missing`].
    pub fn new(scene: &Scene, exercise: &Exercise) -> Self {
        let pockets = pocket::all(scene);
        let mut missing = Vec::new();
        for zones in &exercise.zones {
            if !pockets.iter().any(|pocket| pocket.fdi == zones.tooth) {
                missing.push(format!("a pocket at tooth {}", zones.tooth));
            }
        }
        let sight = exercise.target.as_ref().and_then(|target| {
            Sight::new(scene, &pockets, target)
                .map_err(|why| missing.push(why))
                .ok()
        });
        let look = sight
            .as_ref()
            .map_or_else(Look::default, |_| Look::new(scene));
        Self {
            exercise: exercise.clone(),
            bleeding: Bleeding::new(pockets.len()),
            probes: std::array::from_fn(|_| Probe::new(pockets.len())),
            pockets,
            centres: vec![Vec3::zeros(); look.len()],
            look,
            sight,
            missing,
            tally: Tally::default(),
            said: Vec::new(),
        }
    }

    /// What the exercise asks for and the scene has not, in words.
    pub fn missing(&self) -> &[String] {
        &self.missing
    }

    /// What has to be read of the tick's shapes, for whoever reads them elsewhere (see [`Events::take`]).
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// Counts so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Where a tool's tip was in the tick taken in last; none where it is in no pocket, or is no probe.
    pub fn standing(&self, tool: usize) -> Option<&Standing> {
        self.probes.get(tool)?.standing()
    }

    /// Whether the target was visible when it was looked at last; none without a target, or before the first look.
    pub fn is_target_visible(&self) -> Option<bool> {
        let looked = self.tally.looks > 0;
        self.sight
            .as_ref()
            .filter(|_| looked)
            .map(Sight::is_visible)
    }

    /// Takes in a tick; `shapes` is the workspace as that tick left it. Returns what happened, in a fixed order.
    pub fn observe(
        &mut self,
        scene: &Scene,
        output: &TickOutput,
        shapes: &Workspace,
    ) -> std::vec::Drain<'_, Occurrence> {
        let mut centres = std::mem::take(&mut self.centres);
        let due = self.look.is_due(output.tick);
        if due {
            self.look.read(shapes, &mut centres);
        }
        self.advance(scene, output, due.then_some(centres.as_slice()));
        self.centres = centres;
        self.said.drain(..)
    }

    /// As [`Events::observe`], away from the thread that ticks: `look` is what [`Look::read`] gave after that tick, where
    /// it was due.
    pub fn take(
        &mut self,
        scene: &Scene,
        output: &TickOutput,
        look: Option<&[Vec3]>,
    ) -> std::vec::Drain<'_, Occurrence> {
        self.advance(scene, output, look);
        self.said.drain(..)
    }

    fn advance(&mut self, scene: &Scene, output: &TickOutput, look: Option<&[Vec3]>) {
        let first = self.said.len();
        for (t, (tool, out)) in scene.tools.iter().zip(&output.tools).enumerate() {
            // A mirror touches the gingiva, and reads nothing.
            let there = out.status & status::ABSENT == 0 && !tool.bands.is_empty();
            let seen = there.then(|| Seen {
                tip: out.graphic.transform(&tool.tip),
                out_of_tip: out.graphic.orientation * tool.tip_axis,
                reading: out.pocket.as_ref(),
            });
            let before = self.said.len();
            self.probes[t].observe(
                (output.tick, t),
                seen.as_ref(),
                &self.pockets,
                scene,
                &self.exercise.probing,
                &mut self.said,
            );
            self.bleeding.after(
                before,
                &mut self.said,
                &self.probes[t],
                &self.pockets,
                scene,
            );
            if let Some(reading) = out.pocket.filter(|reading| reading.entered_zone) {
                self.said
                    .push(Occurrence::force_zone(output.tick, t, &reading));
            }
        }
        if let (Some(sight), Some(centres)) = (&mut self.sight, look) {
            let view = sight.evaluate(scene, output, centres, &self.look);
            self.tally.seen(&view, sight.is_visible());
            if let Some(visible) = view.changed {
                self.said.push(Occurrence {
                    kind: KINDS[if visible { 7 } else { 8 }].into(),
                    tick: output.tick,
                    data: json!({
                        "tooth": sight.tooth(),
                        "free": view.free,
                        "free_past_mirror": view.free_past_mirror,
                        "of": view.of,
                    }),
                });
            }
        }
        self.tally.count(&self.said[first..]);
    }
}
