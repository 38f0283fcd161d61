//! Beginning of a recording: header, scene, state before the first tick.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use sulcus_core::{Coupling, Scene, State};
use sulcus_program::PathText;
use sulcus_proto::control::DeviceInfo;
use sulcus_proto::station::StationEvent;
use sulcus_sessions::record::plan::{PlanChange, PlanFacts};
use sulcus_sessions::record::predecessor::Predecessor;
use sulcus_sessions::{
    DeviceFacts, Limits, Recorder, SessionHeader, SessionWriter, StationKey, ViewersPolicy,
};
use tokio::sync::broadcast;

use crate::outlets::feed::{FeedPublisher, SessionFeed};
use crate::outlets::recording::{Listeners, Narrator, Open};
use crate::outlets::status::{Live, StatusOutlet};
use crate::station::config::SessionPlan;

/// Facts of a session before its recording.
pub(crate) struct Opening {
    /// Plan of the session. Its scene has the couplings in force, its bytes those of the file.
    pub plan: Arc<SessionPlan>,
    /// Couplings in force, in the order of the tools; empty for the scene's own.
    pub softer: Vec<Coupling>,
    /// Folder of recordings.
    pub folder: PathBuf,
    /// Policy about the channels for viewers.
    pub viewers: ViewersPolicy,
    /// File of the station's key; `None`: the default path.
    pub key: Option<PathBuf>,
    /// Name of the station.
    pub station: String,
    /// Opaque learner id; empty for an anonymous learner.
    pub learner: String,
    /// First line of the log: the client's program and device.
    pub client: String,
    /// Devices of the client, in the order of the tool slots.
    pub devices: Vec<DeviceInfo>,
    /// Attach epoch of the first connection.
    pub epoch: u32,
    /// Path of the recording that this one continues.
    pub predecessor: Option<PathBuf>,
    /// Status of the session, for the station.
    pub live: Arc<Live>,
    /// Events for instructors.
    pub events: broadcast::Sender<StationEvent>,
    /// Writer of the feed for displays.
    pub feed: Arc<Mutex<FeedPublisher>>,
}

/// Opens a recording under a new name and writes header, scene and first state. `started` is the session's begin,
/// nanoseconds since 1970.
///
/// # Errors
/// The key is unusable, the folder is missing, the disk is full, or a thousand sessions began in this second. The error
/// is a sentence for the status.
pub(crate) fn open(opening: Opening, started: u64) -> Result<Open, String> {
    let plan = &opening.plan;
    let header = SessionHeader {
        exercise_name: plan.exercise.name.clone(),
        exercise: plan.exercise.definition.clone(),
        patient: plan.patient.clone(),
        rubric: plan.rubric.clone(),
        seed: plan.exercise.seed,
        station: opening.station.clone(),
        learner_id: opening.learner.clone(),
        mode: Some(plan.mode),
        started_unix_ns: started,
        devices: devices(&plan.scene, &opening.devices),
        limits: Some(limits(&plan.scene)),
        plan: Some(facts(plan, &opening.station)),
        attach_epoch: Some(opening.epoch),
        predecessor: opening.predecessor.as_deref().and_then(predecessor),
        couplings: opening.softer.clone(),
        viewers: opening.viewers,
        ..SessionHeader::new(plan.scene_bytes.to_vec())
    };
    let key = station_key(opening.key.as_deref()).map_err(|error| error.to_string())?;
    let (recorder, path) =
        Recorder::create_in(&opening.folder, &header, &key).map_err(|error| error.to_string())?;
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let begin = State::new(&plan.scene).to_bytes();
    let client = Some(opening.client.as_str());
    let mut writer = SessionWriter::begin(recorder, &plan.scene, started, &begin, client)
        .map_err(|error| error.to_string())?;
    writer.flush().map_err(|error| error.to_string())?;
    let session = plan.display.as_ref().map(|display| {
        let mut feed = opening.feed.lock().unwrap_or_else(PoisonError::into_inner);
        SessionFeed::begin(&mut feed, &plan.scene, display.clone())
    });
    let listeners = Listeners {
        station: opening.station,
        status: StatusOutlet::new(&plan.scene, opening.live),
        events: opening.events,
        session,
        feed: opening.feed,
    };
    Ok(Open(writer, name, Narrator::new(plan), listeners))
}

/// Devices of the client for the tools of the scene.
pub(crate) fn devices(scene: &Scene, devices: &[DeviceInfo]) -> Vec<DeviceFacts> {
    let slots = (0..).zip(devices).take(scene.tools.len());
    let there = slots.filter(|(_, device)| device.is_there());
    there.map(|(tool, device)| facts_of(tool, device)).collect()
}

fn facts_of(tool: u8, device: &DeviceInfo) -> DeviceFacts {
    DeviceFacts {
        tool,
        name: device.name.clone(),
        period_ns: device.period_ns,
        workspace_scale: f64::from(device.workspace_scale),
        max_force_n: f64::from(device.max_force_n),
        max_torque_nm: f64::from(device.max_torque_nm),
        force_dof: device.force_axes + device.torque_axes,
        library: device.library.clone(),
        serial: device.serial.clone(),
        model_hash: device.model_hash.clone(),
        figures: device.figures.clone(),
        delay_us: device.delay_us,
        friction_n: decimal(device.friction_n),
        motion_axes: device.motion_axes,
        force_axes: device.force_axes,
        torque_axes: device.torque_axes,
        coupling: device.coupling.map(|most| Coupling {
            n_per_m: f64::from(most.n_per_m),
            nm_per_rad: decimal(most.nm_per_rad),
        }),
    }
}

/// Number with the decimals that an f32 has, for people: 0.26 instead of 0.25999999046325684.
fn decimal(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

/// Limits of the wrench that the client is told.
fn limits(scene: &Scene) -> Limits {
    let params = &scene.params;
    Limits {
        max_force_n: params.max_force,
        max_torque_nm: params.max_torque,
        max_force_step_n: params.max_force_step,
        max_torque_step_nm: params.max_torque_step,
    }
}

fn facts(plan: &SessionPlan, station: &str) -> PlanFacts {
    PlanFacts {
        name: station.to_owned(),
        revision: plan.revision.to_string(),
        resume_within_s: plan.resume_within.as_secs_f64(),
        clock_runs_in_gaps: plan.clock_in_gap,
        changed: plan.changed.as_ref().map(|changed| PlanChange {
            unix_ns: changed.unix_ns,
            by: changed.by.clone(),
        }),
    }
}

/// Recording that a new one continues. A file that cannot be read leaves the new recording on its own, with an error
/// in the log.
fn predecessor(path: &Path) -> Option<Predecessor> {
    Predecessor::of(path)
        .inspect_err(|error| {
            tracing::error!(
                "{}: the interrupted session cannot be continued: {error}",
                path.shown()
            );
        })
        .ok()
}

/// Key that signs recordings, from `path`, else from [`StationKey::default_path`]. A missing key is created.
pub(crate) fn station_key(path: Option<&Path>) -> Result<StationKey, sulcus_sessions::KeyError> {
    let path = path.map_or_else(StationKey::default_path, |path| Ok(PathBuf::from(path)))?;
    StationKey::load_or_create(&path)
}
