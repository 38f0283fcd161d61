//! Status of a running session, five times a second: force, site, depth, age of the pose, cost of a tick.
//!
//! The recorder's thread makes it from the ticks that it takes. The station's task reads the newest one.

use std::sync::Arc;
use std::sync::{Mutex, PoisonError};

use serde::Deserialize;
use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput};
use sulcus_link::Times;
use sulcus_proto::station::{StationStatus, ToolStatus};
use sulcus_sessions::{Events, Row};

use super::hands::{TrueDepth, depths, true_depth, zone};
use crate::capacity::{Cost, Estimate};

/// Interval between two statuses, seconds.
const EVERY_S: f64 = 0.2;

/// Newest status of a session's ticks.
#[derive(Debug, Default)]
pub(crate) struct Live(Mutex<Numbers>);

#[derive(Clone, Debug, Default)]
struct Numbers {
    tools: [ToolStatus; MAX_TOOLS],
    tick_p99_us: f32,
    /// Cost of the ticks since the last status; `None`: taken already.
    seen: Option<Cost>,
    /// Estimate so far.
    estimate: Option<Cost>,
    deadline_misses: u64,
    exhausted: u64,
    rows_dropped: u64,
    frames_dropped: u64,
}

impl Live {
    /// Writes the newest numbers into a status.
    pub fn fill(&self, status: &mut StationStatus) {
        let numbers = self.lock().clone();
        status.tools = numbers.tools;
        status.tick_p99_us = numbers.tick_p99_us;
        status.deadline_misses = numbers.deadline_misses;
        status.exhausted = numbers.exhausted;
        status.rows_dropped = numbers.rows_dropped;
        status.frames_dropped = numbers.frames_dropped;
    }

    /// Upper estimate of the cost of a tick, from the `measured` one on.
    pub fn cost(&self, measured: Cost) -> Cost {
        let mut numbers = self.lock();
        let mut estimate = Estimate::new(numbers.estimate.unwrap_or(measured));
        if let Some(seen) = numbers.seen.take() {
            estimate.take(seen);
        }
        numbers.estimate = Some(estimate.cost());
        estimate.cost()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Numbers> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Longest name of a device's stage, bytes.
const STAGE_BYTES: usize = 32;

/// Event of a client about its haptic device, as far as a status has it.
#[derive(Deserialize)]
struct Device {
    tool: usize,
    stage: String,
    limited_periods: u64,
}

/// Collector of statuses from the ticks of a session.
pub(crate) struct StatusOutlet {
    live: Arc<Live>,
    numbers: Numbers,
    /// Depth of each site by the scene, millimetres.
    depths: Vec<TrueDepth>,
    times: Times,
    /// Sum of the times since the last status, nanoseconds.
    sum_ns: u64,
    tick_ns: u64,
    every: u64,
    next: u64,
    /// Newest tick; the next one follows at once if no row was dropped.
    last: u64,
}

impl StatusOutlet {
    /// Collector for a session in `scene`. The status of an earlier session is forgotten.
    pub fn new(scene: &Scene, live: Arc<Live>) -> Self {
        *live.lock() = Numbers::default();
        Self {
            live,
            numbers: Numbers::default(),
            depths: depths(scene),
            times: Times::up_to(1),
            sum_ns: 0,
            tick_ns: scene.params.tick_ns(),
            every: scene.params.ticks_in(EVERY_S).max(1),
            next: 0,
            last: 0,
        }
    }

    /// Depth of each site by the scene.
    pub fn depths(&self) -> &[TrueDepth] {
        &self.depths
    }

    /// Sets the number of display frames that were dropped.
    pub fn frames_dropped(&mut self, frames: u64) {
        self.numbers.frames_dropped = frames;
    }

    /// Takes a client's event about its haptic device. A text that is no such event is ignored.
    pub fn device(&mut self, json: &str) {
        let Ok(said) = serde_json::from_str::<Device>(json) else {
            return;
        };
        let is_name = |byte: u8| byte.is_ascii_lowercase() || byte == b'_';
        if said.stage.len() > STAGE_BYTES || !said.stage.bytes().all(is_name) {
            return;
        }
        if let Some(tool) = self.numbers.tools.get_mut(said.tool) {
            tool.device_stage = said.stage;
            tool.device_limited = said.limited_periods;
        }
    }

    /// Takes a tick. `events` has taken it before.
    pub fn tick(&mut self, row: &Row, output: &TickOutput, events: &Events, cpu_ns: u32) {
        let skipped = u64::from(row.input.skipped);
        let dropped = row.tick.saturating_sub(self.last + 1 + skipped);
        self.last = row.tick;
        self.numbers.rows_dropped += dropped;
        let late = u64::from(u64::from(cpu_ns) > self.tick_ns);
        self.numbers.deadline_misses += skipped + late;
        self.times.record(u64::from(cpu_ns));
        self.sum_ns += u64::from(cpu_ns);
        let numbers = &mut self.numbers;
        for (k, (tool, out)) in numbers.tools.iter_mut().zip(&output.tools).enumerate() {
            numbers.exhausted += u64::from(out.status & status::EXHAUSTED != 0);
            let force = norm(&out.wrench.force) as f32;
            if force > tool.peak_force_n {
                tool.peak_force_n = force;
            }
            let age_ms = u64::from(row.input.tools[k].age_ticks) * self.tick_ns / 1_000_000;
            let now = events.standing(k).map_or(0, |at| zone(at.zone));
            tool.peak_zone = tool.peak_zone.max(now);
            tool.present = out.status & status::ABSENT == 0;
            tool.force_n = force;
            tool.status = out.status;
            tool.pose_age_ms = u16::try_from(age_ms).unwrap_or(u16::MAX);
        }
        if output.tick < self.next {
            return;
        }
        self.next = output.tick + self.every;
        for (k, tool) in numbers.tools.iter_mut().enumerate() {
            let standing = events.standing(k);
            tool.tooth = standing.map_or(0, |at| at.tooth);
            tool.site = standing.map_or_else(String::new, |at| at.site.name().to_owned());
            tool.depth_mm = standing.map_or(0.0, |at| (at.depth * 1e3) as f32);
            tool.true_depth_mm = standing.map_or(0.0, |at| true_depth(&self.depths, at));
            tool.floor_force_n = standing.map_or(0.0, |at| at.force as f32);
            tool.zone = standing.map_or(0, |at| zone(at.zone));
        }
        let times = self.times.percentiles();
        numbers.tick_p99_us = times.p99 as f32;
        numbers.seen = Some(Cost {
            mean_us: self.sum_ns as f64 / 1e3 / self.times.count().max(1) as f64,
            p50_us: times.p50,
            p99_us: times.p99,
            p999_us: times.p999,
        });
        self.times.clear();
        self.sum_ns = 0;
        {
            let mut live = self.live.lock();
            let estimate = live.estimate;
            *live = Numbers {
                estimate,
                ..numbers.clone()
            };
        }
        for tool in &mut numbers.tools {
            tool.peak_force_n = 0.0;
            tool.peak_zone = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::output::ToolOutput;
    use sulcus_core::{Pose, TickInput, Wrench};
    use sulcus_sessions::Exercise;

    use super::*;

    fn empty() -> Scene {
        Scene {
            name: String::new(),
            source_hash: String::new(),
            params: Default::default(),
            tools: vec![],
            objects: vec![],
        }
    }

    #[test]
    fn a_status_has_the_stage_of_a_device_and_no_text_of_a_client() {
        let scene = empty();
        let mut outlet = StatusOutlet::new(&scene, Arc::default());
        let event = |tool: usize, stage: &str| {
            format!("{{\"tool\":{tool},\"stage\":\"{stage}\",\"trips\":1,\"limited_periods\":7}}")
        };
        outlet.device(&event(1, "tripped_driver"));
        for other in [
            event(1, "<b>x</b>"),
            event(1, &"a".repeat(33)),
            event(2, "live"),
            "{".to_owned(),
        ] {
            outlet.device(&other);
        }
        let [none, device] = &outlet.numbers.tools;
        assert_eq!((none.device_stage.as_str(), none.device_limited), ("", 0));
        let found = (device.device_stage.as_str(), device.device_limited);
        assert_eq!(found, ("tripped_driver", 7));
    }

    #[test]
    fn a_status_holds_the_peak_since_the_last_one_and_counts_what_is_missing() {
        let scene = empty();
        let events = Events::new(&scene, &Exercise::free("free", 1.0));
        let live = Arc::<Live>::default();
        let mut outlet = StatusOutlet::new(&scene, live.clone());
        let mut tick = |tick: u64, newtons: f64, skipped: u16| {
            let mut out = ToolOutput::absent(Pose::identity());
            out.status = 0;
            out.wrench = Wrench {
                force: sulcus_core::Vec3::new(newtons, 0.0, 0.0),
                ..Wrench::ZERO
            };
            let output = TickOutput {
                tick,
                hash: 0,
                work: 0,
                tools: [out, ToolOutput::absent(Pose::identity())],
            };
            let input = TickInput {
                skipped,
                ..TickInput::IDLE
            };
            let row = Row::new(0, &input, &output);
            outlet.tick(&row, &output, &events, 100_000);
            let mut status = StationStatus::default();
            live.fill(&mut status);
            status
        };
        tick(1, 0.1, 0);
        // A tick between two statuses: its peak is in the next one. Three rows are missing, two points were skipped.
        tick(7, 3.0, 2);
        let status = tick(202, 0.5, 194);
        assert_eq!(status.rows_dropped, 3);
        assert_eq!(status.deadline_misses, 196);
        assert_eq!(
            (status.tools[0].force_n, status.tools[0].peak_force_n),
            (0.5, 3.0)
        );
        assert!(status.tools[0].present && !status.tools[1].present);
        assert!((status.tick_p99_us - 100.0).abs() < 1.0);
        assert_eq!(tick(402, 0.2, 199).tools[0].peak_force_n, 0.2);
    }
}
