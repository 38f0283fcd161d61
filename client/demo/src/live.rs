//! Live demo: an embedded server on the loopback interface, QUIC, and the simulated operator as the device.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use sulcus_program::{PathText, tell};
use sulcus_proto::control::EndReason;
use sulcus_server::{Exercise, Server, ServerConfig, SessionPlan, StationConfig};

use crate::args::DemoArgs;
use crate::check;
use crate::exercise::Prepared;
use crate::network::NetworkSummary;
use crate::place::tell_place;
use crate::seat::{self, Ending, Seat, taken};
use crate::simulated::{self, Simulated};
use crate::summary::{DemoSummary, PassivitySummary};
use sulcus_connection::at_hand::HandTicker;
use sulcus_connection::link::{Link, LinkConfig};
use sulcus_connection::perform::perform;
use sulcus_connection::progress::Steps;
use sulcus_relay::Relay;
use sulcus_sessions::Recording;

/// Largest number of ticks at the hand whose bits are compared with the recording: five minutes at 1 kHz.
const LOGGED: usize = 300_000;

/// Performs `prepared` in real time, with the simulated operator in a seat, and checks the recording. Returns the
/// summary.
///
/// # Errors
/// The server does not start or is lost, the server ends the session, or the recording cannot be read.
pub fn run(
    args: &DemoArgs,
    prepared: Prepared,
    seat: Seat<'_>,
    steps: &Steps,
) -> anyhow::Result<DemoSummary> {
    let (name, scene) = (prepared.exercise.name.clone(), prepared.scene.clone());
    let mut plan = SessionPlan::new(prepared.scene.clone(), prepared.scene_bytes.clone());
    plan.exercise = Exercise {
        name: name.clone(),
        text: prepared.exercise.task.clone(),
        definition: prepared.definition(args.hand_seed())?,
        seed: args.hand_seed(),
    };
    plan.patient.clone_from(&prepared.patient);
    plan.rubric = prepared.rubric()?;
    plan.learner.clone_from(&args.learner);
    plan.mode = args.mode;
    if seat.is_some() {
        plan.show()?;
    }
    let mut station = StationConfig::new(plan);
    station.name = "demo".into();
    let config = ServerConfig::new(station, args.recordings.clone())?;
    let server = Server::start(config)?;
    let seed = args.hand_seed();
    let relay = args
        .network
        .map(|network| Relay::through(network, server.local_addr(), seed))
        .transpose()
        .context("the relay of --network cannot start")?;
    let address = relay
        .as_ref()
        .map_or_else(|| server.local_addr(), Relay::address);
    let link_config = LinkConfig {
        tick: args.tick.into(),
        scene_hash: prepared.scene_hash(),
        ..LinkConfig::new(address, server.ticket(), seat::device(seat))
    };
    let link = Link::connect(link_config.clone())?;
    tell_place(&link);
    let hand = HandTicker::on(&link, &scene)?;
    let is_person = seat::device(seat) != simulated::NAME;
    let periods = prepared.periods(args.duration, is_person);
    let logged = usize::try_from(periods).unwrap_or(LOGGED).min(LOGGED);
    let hand = hand.map(|hand| hand.logged(logged));
    let begin = Instant::now();
    let disturb = prepared.case.map(|case| case.disturb);
    let device = Simulated {
        operator: prepared.operator,
        until_done: prepared.until_done,
    };
    let device = taken(seat, &link_config, &link, &prepared.exercise, device);
    let ran = perform(link, device, periods, disturb, hand, steps)?;
    let wall_s = begin.elapsed().as_secs_f64();
    let path = args.network.zip(relay.as_ref().map(Relay::counts));
    server.shutdown();
    server.join()?;
    let goodbye = match &ran.goodbye {
        Ok(goodbye) => goodbye.clone(),
        Err(error) => bail!("the embedded server was lost: {error}"),
    };
    let summary = &goodbye.summary;
    if summary.recording.is_empty() {
        bail!("{}", goodbye.text);
    }
    let recording: PathBuf = args.recordings.join(&summary.recording);
    if summary.end != EndReason::Stopped {
        bail!(
            "{}; the part recorded until then is {}",
            goodbye.text,
            recording.shown()
        );
    }
    if !summary.complete {
        tell!(
            "warning: the recording cannot be graded because it is not complete; rows dropped: {}",
            summary.rows_dropped
        );
    }
    if let Some(screen) = seat {
        (screen.ended)(&Ending::Replaying);
    }
    // One more pass over the recording, which the lines of a plain demo do not need.
    let asked = args.json || path.is_some() || ran.hand.is_some();
    let way = asked
        .then(|| NetworkSummary::new(&ran, &Recording::open(&recording)?))
        .transpose()?;
    let way = way.map(|way| match path {
        Some((network, counts)) => way.through(network, counts, wall_s),
        None => way,
    });
    let checked = check::with(&recording, args.pictures, steps)?;
    // The wire carries no readings of pockets. The lines therefore come from the replay.
    for line in &checked.zones {
        tell!("{line}");
    }
    if let Some(screen) = seat {
        (screen.ended)(&Ending::Replayed {
            recording: &recording,
            mode: args.mode,
            grade: checked.grade.as_ref(),
            worst: checked.worst.as_ref(),
        });
    }
    let (page, page_error) = crate::either(checked.page.clone());
    Ok(DemoSummary {
        recording,
        exercise: name,
        scene: scene.name.clone(),
        virtual_time: false,
        mode: args.mode,
        rate_hz: scene.params.rate_hz,
        ticks: summary.ticks,
        deadline_misses: summary.deadline_misses,
        skipped: summary.skipped,
        tick_us: summary.tick_us,
        tick_wall_us: summary.tick_wall_us,
        rtt_us: (ran.stats.answered > 0).then_some(ran.stats.rtt_us),
        wait_us: (ran.stats.answered > 0).then_some(ran.stats.wait_us),
        network_us: (ran.stats.answered > 0).then_some(ran.stats.network_us),
        max_residual_um: checked.measures.residual * 1e6,
        residual_every: checked.residual_every,
        exhausted: checked.measures.exhausted,
        max_force_n: checked.measures.max_force,
        way,
        passivity: Some(PassivitySummary {
            energy_out_mj: ran.report.energy_out_j * 1e3,
            energy_taken_mj: ran.report.energy_taken_j * 1e3,
            damped_periods: ran.report.damped_periods,
        }),
        lost: summary.poses.lost + ran.stats.wrenches.lost,
        late: summary.poses.late + ran.stats.wrenches.late,
        identical: checked.report.identical,
        first_divergent_tick: checked.report.first_divergent_tick,
        gradable: checked.report.gradable,
        signature_valid: checked.signature_valid(),
        realtime_factor: (summary.ticks + summary.skipped) as f64 * scene.tick_s() / wall_s,
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
