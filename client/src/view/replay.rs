//! Seconds round an instant of a recording, replayed for the end page.

use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use sulcus_core::{Scene, TickInput, TickOutput, Workspace};
use sulcus_display::Display;
use sulcus_program::PathText;
use sulcus_proto::display::{DisplayScene, SceneHash};
use sulcus_screen::moment::Moment;
use sulcus_sessions::{Exercise, Recording, ReplayOptions, Span, replay_observed};

use crate::picture::Follower;

/// Time before and after the instant, seconds. Chosen: the way to the fault, and what the hand did next.
const AROUND_S: [f64; 2] = [2.5, 1.5];
/// Time between two frames, seconds. Tools between them are interpolated.
const FRAME_S: f64 = 1.0 / 30.0;
/// Time for which the last frame stands before the loop begins again, seconds.
const HOLD_S: f64 = 0.8;

/// Replayed seconds.
pub struct Replay {
    /// Scene of the recording, for the screen.
    pub scene: Arc<DisplayScene>,
    /// Its hash.
    pub hash: SceneHash,
    /// Frames in order; never empty.
    frames: Vec<Moment>,
}

impl Replay {
    /// Replays the seconds round `tick` of the recording at `path`, from the last snapshot before them. Bleeding that
    /// began before the snapshot does not show.
    ///
    /// # Errors
    /// The recording cannot be read or replayed, or has no tick there.
    pub fn around(path: &Path, tick: u64) -> anyhow::Result<Self> {
        let context = || path.shown().to_string();
        let recording = Recording::open(path).with_context(context)?;
        let scene = recording.scene().with_context(context)?;
        let display = Display::new(&scene)?;
        let exercise = Exercise::recorded(&recording.header().exercise);
        let tick_s = scene.tick_s();
        let (first, last) = recording.facts().ticks.unwrap_or_default();
        let [before, after] = AROUND_S.map(|s| (s / tick_s) as u64);
        let from = tick.saturating_sub(before).clamp(first, last);
        let to = tick.saturating_add(after).clamp(first, last);
        let options = ReplayOptions {
            span: Span {
                from_s: Some(from as f64 * tick_s),
                to_s: Some(to as f64 * tick_s),
            },
            ..ReplayOptions::default()
        };
        let mut follower = Follower::new(&scene, &display, &exercise);
        let every = ((FRAME_S / tick_s) as u64).max(1);
        let (mut next, mut frames) = (from, Vec::new());
        let mut observe = |_: &Scene, _: &TickInput, output: &TickOutput, shapes: &Workspace| {
            let due = output.tick >= next;
            if let Some(moment) = follower.tick(output, shapes, due) {
                frames.push(moment.clone());
                next = output.tick + every;
            }
        };
        replay_observed(&recording, &options, &mut |_| {}, &mut observe).with_context(context)?;
        if frames.is_empty() {
            anyhow::bail!("{}: no tick is recorded at {tick}", path.shown());
        }
        Ok(Self {
            hash: display.hash(),
            scene: Arc::new(display.scene().clone()),
            frames,
        })
    }

    /// Instant of the endless loop, `elapsed_s` seconds after its begin.
    pub fn moment(&self, elapsed_s: f64) -> Moment {
        looped(&self.frames, elapsed_s)
    }
}

fn looped(frames: &[Moment], elapsed_s: f64) -> Moment {
    let begin_s = frames.first().map_or(0.0, |frame| frame.time_s);
    let end_s = frames.last().map_or(0.0, |frame| frame.time_s);
    let at_s = begin_s + elapsed_s.rem_euclid(end_s - begin_s + HOLD_S);
    // The first frame behind that time; none while the last one stands.
    let k = frames.partition_point(|frame| frame.time_s <= at_s);
    let before = &frames[k.saturating_sub(1)];
    match frames.get(k) {
        Some(after) if k > 0 => {
            let share = (at_s - before.time_s) / (after.time_s - before.time_s);
            before.between(after, share as f32)
        }
        _ => before.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_proto::TOOLS;
    use sulcus_proto::datagram::WirePose;
    use sulcus_screen::moment::ToolAt;

    #[test]
    fn the_loop_goes_through_its_frames_stands_and_begins_again() {
        let frame = |k: u32| {
            let mut tools = [ToolAt::new(true, &WirePose::IDENTITY); TOOLS];
            tools[0].position.x = k as f32;
            Moment {
                time_s: 10.0 + f64::from(k),
                tools,
                moved: Vec::new(),
                spots: Vec::new(),
            }
        };
        let frames: Vec<Moment> = (0..4).map(frame).collect();
        for (elapsed_s, x) in [(0.0, 0.0), (0.5, 0.5), (2.25, 2.25), (3.5, 3.0), (4.3, 0.5)] {
            let at = looped(&frames, elapsed_s).tools[0].position.x;
            assert!((at - x).abs() < 1e-4, "{elapsed_s}: {at}");
        }
        assert_eq!(looped(&frames[..1], 7.7), frames[0]);
    }

    #[test]
    fn a_recording_is_replayed_round_its_instant() {
        let corpus = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../sessions/tests/corpus/probing.mcap"
        );
        let recording = Recording::open(Path::new(corpus)).expect("a recording");
        let (first, last) = recording.facts().ticks.expect("ticks");
        let middle = (first + last) / 2;
        let replay = Replay::around(Path::new(corpus), middle).expect("a replay");
        let at_s = middle as f64 * 1e-3;
        let times: Vec<f64> = replay.frames.iter().map(|frame| frame.time_s).collect();
        let steps = times.windows(2).map(|two| two[1] - two[0]);
        assert!(
            steps.into_iter().all(|s| (0.03..0.04).contains(&s)),
            "{times:?}"
        );
        assert!(
            times[0] <= at_s && times[times.len() - 1] >= at_s,
            "{times:?}"
        );
        assert!(replay.frames.iter().any(|frame| frame.tools[0].held));
    }
}
