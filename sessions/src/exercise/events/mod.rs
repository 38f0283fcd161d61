//! Events of an exercise, found tick by tick by pure functions of the scene, the exercise, and the output and shapes of
//! a tick. Live server, demo in virtual time and replay run the same code and find the same events, bit for bit.
//!
//! | kind | cause | data |
//! |---|---|---|
//! | `site_reached` | a probe's tip comes into a zone | tool, tooth, site, depth_mm |
//! | `floor_felt` | force on the floor rises into the reading band | tool, tooth, site, depth_mm, force_n |
//! | `angle` | the tilt becomes wrong, or right again | tool, tooth, site, right, and the tilt in parts |
//! | `left_site` | the tip leaves a zone | tool, tooth, site, deepest_mm, max_force_n, seconds |
//! | `withdrawn` | the tip stays 0.2 s in a zone, and came out of the pocket since its last stay in another zone of that side | tool, tooth, from, to, seconds since it came out |
//! | `bleeding` | the tip has left a site that bleeds, or a trauma | tool, tooth, site, cause |
//! | `force_zone` | a hand enters another zone of force ([`Occurrence::force_zone`]) | |
//! | `target_visible`, `target_hidden` | rays from the target to the eye | tooth, free, free_past_mirror, of |
//! | `paused`, `resumed`, `force_limit` | station, student or instructor changes a level ([`LEVELS`]) | by, force_limit_n |
//! | `detached`, `attached` | the student is gone, or back ([`crate::record::attach`]) | reason; epoch, gap_ticks |
//! | `reading_called` | a client sends a call ([`call`]) | tooth, site, depth_mm, and if called recession_mm, bleeding, furcation |
//!
//! Forces are in newtons, depths along the tooth's axis below the gingival margin in millimetres, angles in degrees.
//! No function reads a clock. Time is the number of the tick, so skipped ticks count.
//!
//! In a gap of the connection ([`away`]) the state of a probe stands still. A visit goes on behind the gap if the tip
//! is still in its pocket. A hand that has moved meanwhile has not withdrawn the probe.

pub mod angle;
pub mod away;
mod bleeding;
pub mod call;
mod kinds;
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

pub use away::{Away, Presence};
pub use kinds::{BLEEDING, FORCE_LIMIT, KINDS, LEVELS, LOST, PAUSED, RESUMED, may_a_client_say};
pub use sight::Look;
pub use standing::Standing;
pub use tally::Tally;

use bleeding::Bleeding;
use kinds::{TARGET_HIDDEN, TARGET_VISIBLE};
use pocket::Pocket;
use sight::Sight;
use visit::{Probe, Seen};

/// Events of one session.
#[derive(Clone, Debug)]
pub struct Events {
    exercise: Exercise,
    pockets: Vec<Pocket>,
    probes: [Probe; MAX_TOOLS],
    bleeding: Bleeding,
    sight: Option<Sight>,
    look: Look,
    /// Centres of the spheres for sight, if they are read here.
    centres: Vec<Vec3>,
    missing: Vec<String>,
    tally: Tally,
    away: Away,
    said: Vec<Occurrence>,
}

impl Events {
    /// Start of a session. Parts of the exercise that the scene lacks are in [`Events::missing`].
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
            away: Away::default(),
            said: Vec::new(),
        }
    }

    /// Sets whether the student is detached in the next ticks. Events `detached` and `attached` name the first ticks.
    pub fn set_detached(&mut self, detached: bool) {
        self.away.set_detached(detached);
    }

    /// Ignores gaps of the connection, as for a recording that marks none.
    pub fn ignore_gaps(&mut self) {
        self.away.ignore();
    }

    /// Begins a gap of every held tool, at the end of a recording that another one continues.
    pub fn cut(&mut self) {
        self.away.cut();
    }

    /// Gaps of the connection, as of the last tick.
    pub fn away(&self) -> &Away {
        &self.away
    }

    /// Parts of the exercise that the scene lacks, as text.
    pub fn missing(&self) -> &[String] {
        &self.missing
    }

    /// Shapes to be read for sight, for a caller of [`Events::take`].
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// Counts so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Place of a tool's tip in the last tick; `None` outside of all pockets, in a gap of the connection, and for a
    /// tool that is no probe.
    pub fn standing(&self, tool: usize) -> Option<&Standing> {
        if self.away.of(tool) == Presence::Away {
            return None;
        }
        self.probes.get(tool)?.standing()
    }

    /// Whether the target was visible at the last evaluation; `None` without a target, or before the first evaluation.
    pub fn is_target_visible(&self) -> Option<bool> {
        let looked = self.tally.looks > 0;
        self.sight
            .as_ref()
            .filter(|_| looked)
            .map(Sight::is_visible)
    }

    /// Processes a tick. `shapes` is the workspace after that tick. Returns the events in a fixed order.
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

    /// Processes a tick outside of the thread that ticks, as by [`Events::observe`]. `look` is the result of
    /// [`Look::read`] after that tick, if it was due.
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
        self.away.observe(scene, output);
        for (t, (tool, out)) in scene.tools.iter().zip(&output.tools).enumerate() {
            if self.away.of(t) == Presence::Away {
                continue;
            }
            if let Some(ticks) = self.away.returned(t) {
                self.probes[t].returns(ticks);
            }
            // A mirror touches the gingiva, but measures nothing.
            let there = out.status & status::ABSENT == 0 && !tool.bands.is_empty();
            let seen = there.then(|| Seen {
                tip: out.graphic.transform(&tool.tip),
                out_of_tip: out.graphic.orientation * tool.tip_axis,
                reading: out.pocket.as_ref(),
                felt: self.away.of(t) == Presence::Here,
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
        // Without a mirror in the hand the tongue lies where nobody has put it.
        let look = look.filter(|_| !self.away.any() && !self.away.is_whole());
        if let (Some(sight), Some(centres)) = (&mut self.sight, look) {
            let view = sight.evaluate(scene, output, centres, &self.look);
            self.tally.seen(&view, sight.is_visible());
            if let Some(visible) = view.changed {
                self.said.push(Occurrence {
                    kind: if visible {
                        TARGET_VISIBLE
                    } else {
                        TARGET_HIDDEN
                    }
                    .into(),
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
