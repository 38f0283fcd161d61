//! Writer of the channels for viewers, tick by tick, in the recorder's thread.

use foxglove::messages::{FrameTransforms, PointCloud, PoseInFrame};
use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput};

use super::cadence::{Cadence, FRAMES_HZ, WRENCHES_HZ};
use super::clouds::{Cloud, at_rest, shown_level};
use super::foxglove_types::{pose_in_world, schema_of, transform};
use super::moved::Moved;
use super::names::paths;
use super::own_types::v1::{Contacts, SessionMetrics};
use super::shapes::{Sampler, Shapes};
use super::tool;
use super::topics::{SESSION_METRICS, TRANSFORMS, WORLD};
use crate::record::recorder::{RecordError, Recorder, Tape};
use crate::record::row::Row;
use crate::record::schema::view;

/// Channels for viewers of one session.
pub struct Views {
    sampler: Sampler,
    moved: Moved,
    frames: Cadence,
    wrenches: Cadence,
    tools: Vec<ToolView>,
    objects: Vec<ObjectView>,
    transforms: u16,
    session: u16,
    /// Skipped ticks since the last message.
    skipped: u32,
    /// Longest tick since the last message, microseconds.
    longest_tick_us: f32,
}

struct ToolView {
    /// Names of the haptic and of the graphic frame.
    frames: [String; 2],
    /// Numbers of the channels: haptic, graphic, wrench, contacts, metrics.
    channels: [u16; 5],
    /// Largest force since the last wrench, newtons.
    peak_force: f64,
    /// Whether the last list of contacts was not empty.
    touched: bool,
}

struct ObjectView {
    /// Cloud of the tissue; `None` for a rigid object.
    cloud: Option<Cloud>,
    channel: u16,
}

impl Views {
    /// Declares the channels in `recorder` and writes the shapes at rest. Must precede the first row.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn open(
        scene: &Scene,
        recorder: &mut Recorder,
        began_unix_ns: u64,
    ) -> Result<Self, RecordError> {
        Self::open_on(scene, recorder.tape(), began_unix_ns)
    }

    /// Declares the channels on a file, as by [`Views::open`].
    pub(crate) fn open_on(
        scene: &Scene,
        tape: &mut Tape,
        began_unix_ns: u64,
    ) -> Result<Self, RecordError> {
        let pose = schema_of::<PoseInFrame>("foxglove.PoseInFrame");
        let points = schema_of::<PointCloud>("foxglove.PointCloud");
        let mut tools = Vec::new();
        let names = paths(scene.tools.iter().map(|tool| tool.name.as_str()));
        for (held, name) in scene.tools.iter().zip(&names) {
            let topic = |what: &str| format!("/tools/{name}/{what}");
            let frames = ["haptic", "graphic"].map(|what| format!("tools/{name}/{what}"));
            let channels = [
                tape.add_view(&topic("haptic"), &pose)?,
                tape.add_view(&topic("graphic"), &pose)?,
                tape.add_view(&topic("wrench"), &view::WRENCH)?,
                tape.add_view(&topic("contacts"), &view::CONTACTS)?,
                tape.add_view(&topic("metrics"), &view::TOOL_METRICS)?,
            ];
            let spheres = tape.add_view(&topic("spheres"), &points)?;
            let level = shown_level(&held.tree, held.level);
            let cloud = at_rest(began_unix_ns, &frames[1], &held.tree, level);
            tape.view(spheres, began_unix_ns, &cloud)?;
            tools.push(ToolView {
                frames,
                channels,
                peak_force: 0.0,
                touched: false,
            });
        }
        let moved = Moved::new(scene);
        let mut objects = Vec::new();
        let names = paths(scene.objects.iter().map(|object| object.name.as_str()));
        for (k, (object, name)) in scene.objects.iter().zip(&names).enumerate() {
            let channel = tape.add_view(&format!("/objects/{name}/spheres"), &points)?;
            let level = shown_level(&object.tree, object.level);
            let cloud = at_rest(began_unix_ns, WORLD, &object.tree, level);
            tape.view(channel, began_unix_ns, &cloud)?;
            objects.push(ObjectView {
                cloud: moved.of(k).map(|_| Cloud::default()),
                channel,
            });
        }
        let frames = schema_of::<FrameTransforms>("foxglove.FrameTransforms");
        Ok(Self {
            sampler: Sampler::new(scene),
            moved,
            frames: Cadence::new(FRAMES_HZ, scene.tick_s()),
            wrenches: Cadence::new(WRENCHES_HZ, scene.tick_s()),
            tools,
            objects,
            transforms: tape.add_view(TRANSFORMS, &frames)?,
            session: tape.add_view(SESSION_METRICS, &view::SESSION_METRICS)?,
            skipped: 0,
            longest_tick_us: 0.0,
        })
    }

    /// Computes the places of the spheres for a copy of the shapes. [`Views::tick`] uses the same places.
    pub fn follow(&mut self, shapes: &Shapes) -> &Moved {
        self.moved.follow(shapes);
        &self.moved
    }

    /// Places of the spheres after the last copy of the shapes.
    pub fn moved(&self) -> &Moved {
        &self.moved
    }

    /// Copier of shapes for the thread that ticks.
    pub fn sampler(&self) -> Sampler {
        self.sampler.clone()
    }

    /// Writes the due messages of a tick whose row has just been added. `tick_ns` is the thread CPU time of the tick.
    /// `shapes` is the copy by [`Sampler::read`] after the tick, if it was due.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn tick(
        &mut self,
        recorder: &mut Recorder,
        scene: &Scene,
        row: &Row,
        output: &TickOutput,
        tick_ns: u32,
        shapes: Option<&Shapes>,
    ) -> Result<(), RecordError> {
        let tick_us = tick_ns as f32 * 1e-3;
        self.tick_on(recorder.tape(), scene, row, output, tick_us, shapes)?;
        Ok(())
    }

    /// Writes the due messages on a file, as by [`Views::tick`]; the metrics of the session, if they were due.
    /// `tick_us` is the CPU time of the tick, microseconds.
    pub(crate) fn tick_on(
        &mut self,
        tape: &mut Tape,
        scene: &Scene,
        row: &Row,
        output: &TickOutput,
        tick_us: f32,
        shapes: Option<&Shapes>,
    ) -> Result<Option<SessionMetrics>, RecordError> {
        let now = row.time_unix_ns;
        self.skipped = self.skipped.saturating_add(u32::from(row.input.skipped));
        self.longest_tick_us = self.longest_tick_us.max(tick_us);
        for (view, out) in self.tools.iter_mut().zip(&output.tools) {
            let force = norm(&out.wrench.force);
            if force > view.peak_force {
                view.peak_force = force;
            }
        }
        if self.wrenches.is_due(output.tick) {
            for (view, out) in self.tools.iter_mut().zip(&output.tools) {
                let peak = std::mem::take(&mut view.peak_force);
                if tool::is_held(out) {
                    let wrench = tool::wrench(output.tick, out, peak);
                    tape.view(view.channels[2], now, &wrench)?;
                }
            }
        }
        let mut said = None;
        if self.frames.is_due(output.tick) {
            self.poses(tape, scene, now, output)?;
            let metrics = SessionMetrics {
                tick: output.tick,
                skipped: std::mem::take(&mut self.skipped),
                longest_tick_us: std::mem::take(&mut self.longest_tick_us),
                detail: u32::from(row.input.detail),
                paused: row.input.paused,
                force_limit_n: row.input.force_limit_n,
                awake: shapes.map(|shapes| shapes.awake.len() as u32),
            };
            tape.view(self.session, now, &metrics)?;
            said = Some(metrics);
        }
        if let Some(shapes) = shapes.filter(|shapes| shapes.tick == output.tick) {
            self.shapes(tape, scene, now, output, shapes)?;
        }
        Ok(said)
    }

    fn poses(
        &mut self,
        tape: &mut Tape,
        scene: &Scene,
        now: u64,
        output: &TickOutput,
    ) -> Result<(), RecordError> {
        let mut transforms = Vec::with_capacity(2 * MAX_TOOLS);
        for (view, out) in self.tools.iter().zip(&output.tools) {
            if !tool::is_held(out) {
                continue;
            }
            let [haptic, graphic, _, _, metrics] = view.channels;
            for (channel, frame, pose) in [
                (haptic, &view.frames[0], &out.haptic),
                (graphic, &view.frames[1], &out.graphic),
            ] {
                tape.view(channel, now, &pose_in_world(now, pose))?;
                transforms.push(transform(now, frame, pose));
            }
            tape.view(metrics, now, &tool::metrics(scene, output.tick, out))?;
        }
        if transforms.is_empty() {
            return Ok(());
        }
        tape.view(self.transforms, now, &FrameTransforms { transforms })
    }

    fn shapes(
        &mut self,
        tape: &mut Tape,
        scene: &Scene,
        now: u64,
        output: &TickOutput,
        shapes: &Shapes,
    ) -> Result<(), RecordError> {
        for (t, (view, out)) in self.tools.iter_mut().zip(&output.tools).enumerate() {
            let touches = shapes.bearing[t] > 0;
            if touches || view.touched {
                let contacts: Contacts = tool::contacts(scene, t, out, shapes);
                tape.view(view.channels[3], now, &contacts)?;
            }
            view.touched = touches;
        }
        self.moved.follow(shapes);
        for (k, object) in self.objects.iter_mut().enumerate() {
            let (Some(cloud), Some(tissue)) = (&mut object.cloud, self.moved.of(k)) else {
                continue;
            };
            if let Some(points) = cloud.after(now, tissue) {
                tape.view(object.channel, now, &points)?;
            }
        }
        Ok(())
    }
}
