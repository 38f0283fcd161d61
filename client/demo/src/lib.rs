//! Demo of a whole session with a simulated operator: recorded, replayed and graded.
//!
//! [`exercise`] prepares a scene and an operator for an exercise. [`lockstep`] performs the exercise in virtual time,
//! `live` in real time against a server in the same process (feature `embedded`). [`check`] replays and grades the
//! recording. The `run` command of the client performs the same exercises at a server elsewhere.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod args;
pub mod calls;
pub mod check;
pub mod exercise;
pub mod lesson;
#[cfg(feature = "embedded")]
pub mod live;
pub mod lockstep;
pub mod network;
pub mod page;
pub mod place;
pub mod seat;
pub mod simulated;
pub mod summary;
pub mod swarm;
mod zones;

use std::path::PathBuf;

use anyhow::Context;
use sulcus_program::{PathText, say, tell};
use sulcus_sessions::{Mode, StationKey};

use crate::args::DemoArgs;
use sulcus_connection::progress::Steps;
use summary::DemoSummary;

/// Runs the demo, or lists the exercises, and prints the result to standard output. Returns the exit code.
///
/// The code is 0 for a success. It is 1 if the replay differs, the signature is not valid or the recording cannot be
/// graded. It is 2 if the student's page cannot be written.
///
/// # Errors
/// An unknown exercise, an invalid scene file, a folder or a recording that cannot be written, or a session that ends
/// early.
pub fn run(args: &DemoArgs) -> anyhow::Result<u8> {
    run_at(args, None)
}

/// The same with the simulated operator in a seat. A session in virtual time has no seat.
///
/// # Errors
/// The errors of [`run`].
pub fn run_at(args: &DemoArgs, seat: seat::Seat<'_>) -> anyhow::Result<u8> {
    if args.list_exercises {
        for (name, about) in exercise::list() {
            say!("{name:22} {about}");
        }
        return Ok(0);
    }
    let steps = Steps;
    let asked = exercise::Asked {
        exercise: &args.exercise,
        scene: args.scene.as_deref(),
        duration_s: args.duration,
        habit: args.habit,
        patient_seed: args.seed,
        hand_seed: args.hand_seed(),
        solver: args.solver.into(),
        rate_hz: args.rate_hz,
    };
    let mut prepared = exercise::prepare(&asked, &steps)?;
    prepared.learner.clone_from(&args.learner);
    prepared.mode = args.mode;
    if prepared.case.is_some() && args.duration.is_some() {
        tell!(
            "warning: `{}` has its own length; --duration has no effect",
            prepared.exercise.name
        );
    }
    for warning in &prepared.warnings {
        tell!("warning: {warning}");
    }
    std::fs::create_dir_all(&args.recordings).with_context(|| {
        format!(
            "cannot make the folder `{}` for recordings",
            args.recordings.shown()
        )
    })?;
    let mut summary = if args.virtual_time {
        run_virtual(args, &mut prepared, &steps)?
    } else {
        run_live(args, prepared, seat, &steps)?
    };
    if args.mode != Mode::Practice {
        summary.withhold();
    }
    if args.json {
        say!("{}", serde_json::to_string(&summary)?);
    } else {
        say!("{}", summary.text());
    }
    if let Some(why) = &summary.page_error {
        tell!("error: {why}");
        return Ok(2);
    }
    Ok(u8::from(
        !(summary.identical && summary.signature_valid && summary.gradable),
    ))
}

/// Path of the page, and the reason why it could not be written. At most one of the two is there.
fn either(page: Option<Result<PathBuf, String>>) -> (Option<PathBuf>, Option<String>) {
    match page {
        Some(Ok(page)) => (Some(page), None),
        Some(Err(why)) => (None, Some(why)),
        None => (None, None),
    }
}

#[cfg(feature = "embedded")]
use live::run as run_live;

#[cfg(not(feature = "embedded"))]
fn run_live(
    _: &DemoArgs,
    _: exercise::Prepared,
    _: seat::Seat<'_>,
    _: &Steps,
) -> anyhow::Result<DemoSummary> {
    anyhow::bail!(
        "this client has no embedded server, which a demo in real time needs: give --virtual, or join a server with `run`"
    )
}

fn run_virtual(
    args: &DemoArgs,
    prepared: &mut exercise::Prepared,
    steps: &Steps,
) -> anyhow::Result<DemoSummary> {
    let key = StationKey::load_or_create(&StationKey::default_path()?)?;
    let ran = lockstep::run(prepared, args.hand_seed(), &args.recordings, key, steps)?;
    let checked = check::with(&ran.recording, args.pictures, steps)?;
    let (page, page_error) = either(checked.page.clone());
    Ok(DemoSummary {
        recording: ran.recording,
        exercise: prepared.exercise.name.clone(),
        scene: prepared.scene.name.clone(),
        virtual_time: true,
        mode: prepared.mode,
        rate_hz: prepared.scene.params.rate_hz,
        ticks: ran.ticks,
        deadline_misses: 0,
        skipped: 0,
        tick_us: ran.tick_us,
        tick_wall_us: ran.tick_wall_us,
        rtt_us: None,
        network_us: None,
        wait_us: None,
        max_residual_um: checked.measures.residual * 1e6,
        residual_every: checked.residual_every,
        exhausted: checked.measures.exhausted,
        max_force_n: checked.measures.max_force,
        passivity: None,
        way: None,
        lost: 0,
        late: 0,
        identical: checked.report.identical,
        first_divergent_tick: checked.report.first_divergent_tick,
        gradable: checked.report.gradable,
        signature_valid: checked.signature_valid(),
        realtime_factor: ran.ticks as f64 * prepared.scene.tick_s() / ran.wall_s,
        replay_realtime_factor: checked.report.realtime_factor,
        recording_bytes: checked.bytes,
        pocket: checked.pocket(),
        tissue: checked.tissue(),
        events: Some(checked.events()),
        grade: checked.grade,
        page,
        page_error,
    })
}
