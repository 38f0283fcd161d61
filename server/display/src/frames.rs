//! Frames of a session, from the outputs of its ticks.

use sulcus_core::output::status;
use sulcus_core::{Scene, TickOutput, Vec3};
use sulcus_proto::TOOLS;
use sulcus_proto::display::{DisplayFrame, FrameTool, Moved, MovedHandle, STEP_M};
use sulcus_sessions::{Cadence, FRAMES_HZ, MovedTissue, Occurrence};

use crate::display::{Display, Follower, wire_pose};
use crate::spots::Spots;

/// Maker of the frames of one session. Frames are due on the ticks on which the shapes are copied.
pub struct Frames {
    cadence: Cadence,
    spots: Spots,
    /// Tools of the last frame.
    tools: [FrameTool; TOOLS],
    held_slots: usize,
    /// Scratch: displacements of spheres and of handles, metres.
    spheres: Vec<Vec3>,
    handles: Vec<Vec3>,
    faults: u64,
}

impl Frames {
    /// Maker for a session of `scene` with its `display`.
    pub fn new(scene: &Scene, display: &Display) -> Self {
        let mut tools = [FrameTool::default(); TOOLS];
        for (slot, tool) in tools.iter_mut().zip(&display.scene().tools) {
            slot.graphic = tool.park;
        }
        Self {
            cadence: Cadence::new(FRAMES_HZ, scene.tick_s()),
            spots: Spots::new(display.scene()),
            tools,
            held_slots: display.scene().tools.len(),
            spheres: Vec::new(),
            handles: Vec::new(),
            faults: 0,
        }
    }

    /// Whether a frame is due after this tick. Must be called once for every tick.
    pub fn is_due(&mut self, tick: u64) -> bool {
        self.cadence.is_due(tick)
    }

    /// Takes an event of the exercise. Only bleeding shows.
    pub fn occurred(&mut self, event: &Occurrence) {
        if !self.spots.occurred(event) {
            self.faults += 1;
        }
    }

    /// Number of impossible cases so far: numbers that were not finite, bleeding at a place that the scene lacks.
    pub fn faults(&self) -> u64 {
        self.faults
    }

    /// Returns the frame after a tick. `moved` has the newest places of the spheres; an older copy than `output` serves
    /// when the queue of copies was full. The caller numbers the frame.
    pub fn frame(
        &mut self,
        display: &Display,
        output: &TickOutput,
        paused: bool,
        moved: &sulcus_sessions::Moved,
    ) -> DisplayFrame {
        for (slot, tool) in self
            .tools
            .iter_mut()
            .zip(&output.tools)
            .take(self.held_slots)
        {
            let graphic = wire_pose(&tool.graphic);
            let mut numbers = graphic.position.iter().chain(&graphic.orientation);
            slot.held = tool.status & status::ABSENT == 0;
            if numbers.all(|x| x.is_finite()) {
                slot.graphic = graphic;
            } else {
                self.faults += 1;
            }
        }
        let mut objects = Vec::new();
        for (k, follower) in display.followers.iter().enumerate() {
            let tissue = moved.of(k).filter(|tissue| tissue.is_awake());
            let (Some(follower), Some(tissue)) = (follower, tissue) else {
                continue;
            };
            let handles = self.moved_handles(follower, tissue);
            if !handles.is_empty() {
                objects.push(Moved {
                    object: k as u16,
                    handles,
                });
            }
        }
        DisplayFrame {
            sequence: 0,
            scene: display.hash().short(),
            tick: output.tick,
            paused,
            tools: self.tools,
            moved: objects,
            spots: self.spots.all().to_vec(),
        }
    }

    fn moved_handles(&mut self, follower: &Follower, tissue: &MovedTissue) -> Vec<MovedHandle> {
        match follower {
            Follower::Masters => {
                let masters = tissue.configuration().chunks_exact(3);
                self.handles.clear();
                self.handles.extend(masters.map(Vec3::from_column_slice));
            }
            Follower::Same => {
                let (rest, now) = tissue.carrying();
                self.handles.clear();
                let by = rest.iter().zip(now).map(|(rest, now)| now - rest);
                self.handles.extend(by);
            }
            Follower::Spheres(skin) => {
                let (rest, now) = tissue.carrying();
                self.spheres.clear();
                self.spheres
                    .extend(rest.iter().zip(now).map(|(rest, now)| now - rest));
                self.handles.resize(skin.vertices(), Vec3::zeros());
                skin.displacements(&self.spheres, &mut self.handles);
            }
        }
        let mut moved = Vec::new();
        for (handle, by) in (0..).zip(&self.handles) {
            if !by.iter().all(|x| x.is_finite()) {
                self.faults += 1;
                continue;
            }
            // The conversion limits to the range of 16 bits.
            let by = [by.x, by.y, by.z].map(|x| (x / f64::from(STEP_M)).round() as i16);
            if by != [0; 3] {
                moved.push(MovedHandle { handle, by });
            }
        }
        moved
    }
}
