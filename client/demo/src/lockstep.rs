//! `demo --virtual`: operator, core and recorder in lock-step, without sockets and without a clock.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use anyhow::Context;
use sulcus_cases::Observer;
use sulcus_core::{
    NoProbe, RawPose, Scene, State, TickInput, TickOutput, Vec3, Workspace, Wrench, tick,
};
use sulcus_link::Times;
use sulcus_link::clock::thread_cpu_ns;
use sulcus_operator::{Shown, drawn};
use sulcus_proto::Percentiles;
use sulcus_sessions::record::recorder::SNAPSHOT_EVERY_S;
use sulcus_sessions::{
    DeviceFacts, DeviceSample, Events, Limits, RecordedTick, Recorder, Row, SessionEnd,
    SessionHeader, SessionWriter, Shapes, StationKey,
};

use crate::calls::calls;
use crate::exercise::Prepared;
use crate::zones::{entered, zone_line};
use sulcus_connection::interrupt;
use sulcus_connection::progress::Steps;

/// Measures of a run in lock-step.
pub struct Lockstep {
    /// Path of the recording.
    pub recording: PathBuf,
    /// Number of ticks computed.
    pub ticks: u64,
    /// CPU time of the thread for a tick, microseconds.
    pub tick_us: Percentiles,
    /// Wall time of a tick, microseconds.
    pub tick_wall_us: Percentiles,
    /// Wall time of operator, ticks and recording together, seconds.
    pub wall_s: f64,
}

/// Performs `prepared` into a new recording under `folder`, to the end of the session or to an interrupt (Ctrl-C).
///
/// `seed` is recorded, in the header and in the exercise's definition. The recording is signed with `key`.
///
/// # Errors
/// The recording cannot be written, or the clock of the machine is before 1970.
pub fn run(
    prepared: &mut Prepared,
    seed: u64,
    folder: &Path,
    key: StationKey,
    steps: &Steps,
) -> anyhow::Result<Lockstep> {
    let ticks = prepared.ticks;
    let started = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .context("the clock of the machine is before 1970; set the clock")?
        .as_nanos() as u64;
    let mut header = SessionHeader::new(prepared.scene_bytes.as_ref().clone());
    header.exercise_name = prepared.exercise.name.clone();
    header.exercise = prepared.definition(seed)?;
    header.patient.clone_from(&prepared.patient);
    header.rubric = prepared.rubric()?;
    header.seed = seed;
    header.learner_id.clone_from(&prepared.learner);
    header.mode = Some(prepared.mode);
    header.station = "virtual".into();
    header.started_unix_ns = started;
    let params = &prepared.scene.params;
    header.limits = Some(Limits {
        max_force_n: params.max_force,
        max_torque_nm: params.max_torque,
        max_force_step_n: params.max_force_step,
        max_torque_step_nm: params.max_torque_step,
    });
    header.devices = simulated(&prepared.scene);
    let (recorder, recording) = Recorder::create_in(folder, &header, &key)?;

    let scene = prepared.scene.clone();
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut writer = SessionWriter::begin(recorder, &scene, started, &state.to_bytes(), None)?;
    let (mut sampler, mut shapes) = (writer.sampler(), Shapes::new(&scene));
    let (mut cpu, mut wall) = (Times::up_to(1), Times::up_to(1));
    let mut shown = Shown::NOTHING;
    let mut observer = Observer::new(&scene);
    // The run needs only counts. The check at the end makes the full queries of all pairs.
    observer.residual_every = u64::MAX;
    let mut events = Events::new(&scene, &prepared.exercise);
    let bar = steps.bar("performing");
    let begin = Instant::now();
    let mut done = 0;
    for k in 1..=ticks {
        let over = prepared.until_done && prepared.operator.is_done();
        if over || interrupt::asked() {
            break;
        }
        done = k;
        let mut input = TickInput::IDLE;
        let displayed = shown.wrenches;
        input.tools = prepared.operator.step(&shown);
        if let Some(case) = prepared.case {
            (case.disturb)(k - 1, &mut input);
        }
        let (wall_0, cpu_0) = (Instant::now(), thread_cpu_ns());
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        let cpu_ns = thread_cpu_ns() - cpu_0;
        cpu.record(cpu_ns);
        wall.record(wall_0.elapsed().as_nanos() as u64);
        shown = as_sent(&output);
        observer.observe(&scene, &input, &output, &ws);
        let now = started + k * scene.params.tick_ns();
        let device = std::array::from_fn(|t| {
            let measured = || sample(k, k * scene.params.tick_ns(), &displayed[t]);
            input.tools[t].present.then(measured)
        });
        let row = Row::new(now, &input, &output).with_device(device);
        let due = sampler.is_due(output.tick);
        if due {
            sampler.read(output.tick, &ws, &mut shapes);
        }
        let recorded = RecordedTick {
            row: &row,
            output: &output,
            cpu_ns: u32::try_from(cpu_ns).unwrap_or(u32::MAX),
            shapes: due.then_some(&shapes),
        };
        let found = events.observe(&scene, &output, &ws);
        let called = calls(&mut prepared.operator);
        let occurrences = found
            .into_iter()
            .chain(called.iter().map(|call| call.at(k)));
        writer.tick(&scene, &recorded, occurrences)?;
        for (_, reading) in entered(&output) {
            bar.say(&zone_line(k as f64 * scene.tick_s(), &reading));
        }
        if k.is_multiple_of(scene.params.ticks_in(SNAPSHOT_EVERY_S)) {
            writer.snapshot(now, k, &state.to_bytes())?;
        }
        if k.is_multiple_of(500) {
            bar.set("performing", k as f64 / ticks as f64);
        }
    }
    writer.finish(SessionEnd {
        ticks: done,
        exhausted: observer.measures().exhausted,
        ..SessionEnd::default()
    })?;
    let wall_s = begin.elapsed().as_secs_f64();
    bar.done();
    Ok(Lockstep {
        recording,
        ticks: done,
        tick_us: cpu.percentiles(),
        tick_wall_us: wall.percentiles(),
        wall_s,
    })
}

/// Simulated devices of a scene's tools, which display every wrench in all directions.
fn simulated(scene: &Scene) -> Vec<DeviceFacts> {
    let device = |tool: u8| DeviceFacts {
        tool,
        name: "simulated hand".into(),
        period_ns: scene.params.tick_ns(),
        workspace_scale: 1.0,
        max_force_n: scene.params.max_force,
        max_torque_nm: scene.params.max_torque,
        force_dof: 6,
        library: "simulated".into(),
        motion_axes: 6,
        force_axes: 3,
        torque_axes: 3,
        ..DeviceFacts::default()
    };
    (0..).take(scene.tools.len()).map(device).collect()
}

/// Sample of a device that measures a pose for tick `k` and still displays the wrench of the tick before.
fn sample(k: u64, device_time_ns: u64, displayed: &Wrench) -> DeviceSample {
    let (f, t) = (&displayed.force, &displayed.torque);
    DeviceSample {
        // The number wraps, as on the wire.
        sequence: k as u32,
        device_time_ns,
        age_us: 0,
        displayed: [f.x, f.y, f.z, t.x, t.y, t.z].map(|x| x as f32),
    }
}

/// Wrenches and graphic poses of `output` as a device receives them: rounded to f32 as on the wire, then widened.
pub fn as_sent(output: &TickOutput) -> Shown {
    let narrow = |v: &Vec3| v.map(|x| f64::from(x as f32));
    Shown {
        wrenches: std::array::from_fn(|t| {
            let wrench = &output.tools[t].wrench;
            Wrench {
                force: narrow(&wrench.force),
                torque: narrow(&wrench.torque),
            }
        }),
        graphics: std::array::from_fn(|t| drawn(&RawPose::from(&output.tools[t].graphic))),
    }
}
