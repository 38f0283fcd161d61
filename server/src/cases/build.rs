//! Compilation of a case to its scene, in the process that calls.

use std::time::{Duration, Instant};

use sulcus_scene::{BuildOptions, BuiltIn, compile_text};
use toml::Table;

use super::check_name;
use super::error::CaseError;
use super::status::{Status, VERSION};
use super::store::{CaseStore, version_of};
use crate::state::date::now_s;
use crate::state::{Lock, StateError};

/// Pause between two attempts to take the lock of compilations.
const WAIT: Duration = Duration::from_millis(250);

/// Lowers the priority of this process to the least, and its compilations to one thread. With `only_idle` the process
/// runs in idle time alone, for a compilation beside stations that run.
pub fn be_gentle(only_idle: bool) {
    sulcus_scene::limit_threads(1);
    // A process that keeps its priority works too.
    let _ = rustix::process::nice(19);
    if only_idle {
        let parameters = libc::sched_param { sched_priority: 0 };
        // SAFETY: the call reads the structure, which lives on this stack, and changes this process alone.
        unsafe {
            libc::sched_setscheduler(0, libc::SCHED_IDLE, &parameters);
        }
    }
}

/// Text of the scene file of a case: the built-in mouth with this patient.
fn scene_text(name: &str, patient: &str) -> Result<String, String> {
    let mut scene: Table =
        crate::exact::read(BuiltIn::Mouth.text()).map_err(|error| error.to_string())?;
    scene.insert("name".into(), name.into());
    let mouth = scene.get_mut("mouth").and_then(toml::Value::as_table_mut);
    let mouth = mouth.ok_or("the built-in mouth has no table `mouth`")?;
    mouth.remove("condition");
    mouth.remove("seed");
    mouth.insert("patient".into(), patient.into());
    toml::to_string(&scene).map_err(|error| error.to_string())
}

/// Compiles a case and keeps the scene. One case of a state folder is compiled at a time; a second process waits.
/// `progress` gets the stage and the share of the whole, 0 to 1.
///
/// # Errors
/// The patient is not valid, or a file cannot be written. The former scene stays then.
pub fn build(
    store: &CaseStore,
    name: &str,
    progress: &dyn Fn(&str, f64),
) -> Result<Status, CaseError> {
    check_name(name)?;
    store.text(name)?;
    let _turn = turn(store, progress)?;
    let begin = Instant::now();
    let opened = store.read(name)?;
    let not_valid = |why: String| CaseError::NotValid {
        name: name.to_owned(),
        why,
    };
    if let Some(why) = opened.fault() {
        return Err(not_valid(why));
    }
    let path = store.patient(name);
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let text = scene_text(name, &file).map_err(not_valid)?;
    let share = |stage: &str, share: f64| {
        if stage == "done" {
            return;
        }
        // The gingivae follow the last stage that the compiler reports.
        let stage = if stage == "jaw" { "gingivae" } else { stage };
        progress(stage, (0.9 * share).min(0.9));
    };
    let compiled = compile_text(&text, &path, &BuildOptions::cached(), &share);
    let compiled = compiled.map_err(|error| not_valid(error.to_string()))?;
    progress("saving", 0.95);
    let scene = compiled.scene.to_bytes();
    let scene = scene.map_err(|error| not_valid(error.to_string()))?;
    // The compiler read the file itself: its text counts.
    let patient = compiled.patient.unwrap_or_default();
    let status = Status {
        version: VERSION,
        patient_hash: version_of(&patient),
        patient,
        scene_hash: blake3::hash(&scene).to_hex().to_string(),
        scene_bytes: scene.len() as u64,
        compiled_unix_s: now_s(),
        took_s: (begin.elapsed().as_secs_f64() * 10.0).round() / 10.0,
        program: env!("CARGO_PKG_VERSION").to_owned(),
        warnings: compiled.warnings,
    };
    store.keep(name, &scene, &status)?;
    progress("done", 1.0);
    Ok(status)
}

/// Waits for the lock of compilations.
fn turn(store: &CaseStore, progress: &dyn Fn(&str, f64)) -> Result<Lock, CaseError> {
    let path = store.compile_lock();
    loop {
        match Lock::attempt(&path, "another case is being compiled") {
            Err(StateError::Busy { .. }) => {
                progress("waiting for another compilation", 0.0);
                std::thread::sleep(WAIT);
            }
            taken => return Ok(taken?),
        }
    }
}
