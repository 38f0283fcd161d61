//! Files of the cases: list, read, write, copy, remove.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use sulcus_scene::anatomy::mouth::faults;
use sulcus_scene::anatomy::patient::{Patient, PatientFault};

use super::error::CaseError;
use super::status::{State, Status, VERSION};
use super::{check_name, uses};
use crate::state::{
    Lock, StateError, StateFolder, create_private, read_private, remove_private, write_private,
};

/// Folder of cases in the state folder.
const FOLDER: &str = "cases";
/// Ending of a patient file.
const PATIENT: &str = ".patient.toml";
/// Largest patient file that is read, bytes.
const MOST_BYTES: u64 = 256 * 1024;
/// Largest status that is read, bytes.
const MOST_STATUS: u64 = 1 << 20;
/// Largest picture that is read, bytes.
const MOST_PICTURE: u64 = 16 << 20;
/// Largest number of cases.
const MOST_CASES: usize = 1000;

/// Cases of a state folder.
#[derive(Clone, Debug)]
pub struct CaseStore {
    state: StateFolder,
    folder: StateFolder,
}

/// Patient file of a case, read.
#[derive(Debug)]
pub struct Opened {
    /// Name of the case.
    pub name: String,
    /// Text of the file.
    pub text: String,
    /// Version of the text: a hash, hexadecimal.
    pub version: String,
    /// Patient, or the fault of a text that is no patient file. Ranges are not checked.
    pub patient: Result<Patient, String>,
    /// Faults of the patient's values.
    pub faults: Vec<PatientFault>,
    /// Facts of the last compilation.
    pub status: Option<Status>,
}

impl Opened {
    /// State of the case.
    pub fn state(&self) -> State {
        match &self.status {
            _ if self.patient.is_err() || !self.faults.is_empty() => State::Faulty,
            None => State::New,
            Some(status) if status.patient_hash == self.version => State::Compiled,
            Some(_) => State::Changed,
        }
    }

    /// First fault, with the number of others; `None` for a valid patient.
    pub fn fault(&self) -> Option<String> {
        if let Err(why) = &self.patient {
            return Some(why.clone());
        }
        let (first, others) = self.faults.split_first()?;
        Some(match others.len() {
            0 => first.to_string(),
            1 => format!("{first}; another value has a fault too"),
            n => format!("{first}; {n} other values have faults too"),
        })
    }
}

/// Faults of a patient. A check takes a tenth of a second, so the last ones are kept by the version of the text.
fn checked(version: &str, patient: &Patient) -> Vec<PatientFault> {
    static KEPT: Mutex<BTreeMap<String, Vec<PatientFault>>> = Mutex::new(BTreeMap::new());
    let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = kept().get(version) {
        return found.clone();
    }
    let found = faults(patient);
    let mut kept = kept();
    if kept.len() >= MOST_CASES {
        kept.pop_first();
    }
    kept.insert(version.to_owned(), found.clone());
    found
}

/// Version of a text.
pub(crate) fn version_of(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

impl CaseStore {
    /// Store of a state folder. The folder of cases is created if missing.
    ///
    /// # Errors
    /// The folder cannot be created, or is open to other users.
    pub fn open(state: &StateFolder) -> Result<Self, CaseError> {
        // The compiler and the server may have different working folders.
        let path = std::path::absolute(state.path()).unwrap_or_else(|_| state.path().to_owned());
        let state = StateFolder::open(Some(&path))?;
        let folder = state.inside(FOLDER)?;
        Ok(Self { state, folder })
    }

    /// State folder of the store.
    pub fn state(&self) -> &StateFolder {
        &self.state
    }

    /// Path of the compiled scene of a case. Plans name this path.
    pub fn scene(&self, name: &str) -> PathBuf {
        self.folder.file(&format!("{name}.scene"))
    }

    /// Path of the patient file of a case.
    pub fn patient(&self, name: &str) -> PathBuf {
        self.folder.file(&format!("{name}{PATIENT}"))
    }

    pub(super) fn file(&self, name: &str, ending: &str) -> PathBuf {
        self.folder.file(&format!("{name}.{ending}"))
    }

    fn lock(&self) -> Result<Lock, StateError> {
        Lock::wait(&self.folder.file("store.lock"))
    }

    pub(super) fn compile_lock(&self) -> PathBuf {
        self.folder.file("compile.lock")
    }

    /// Names of all cases in alphabetical order. Files with other names are ignored.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn names(&self) -> Result<Vec<String>, CaseError> {
        let path = self.folder.path();
        let entries = std::fs::read_dir(path).map_err(StateError::io("list", path))?;
        let mut names: Vec<String> = entries
            .filter_map(|entry| {
                let name = entry.ok()?.file_name().into_string().ok()?;
                let name = name.strip_suffix(PATIENT)?;
                check_name(name).is_ok().then(|| name.to_owned())
            })
            .collect();
        names.sort_by_cached_key(|name| (name.to_ascii_lowercase(), name.clone()));
        Ok(names)
    }

    /// Reads a case.
    ///
    /// # Errors
    /// The name has another form, no such case exists, or its files cannot be read.
    pub fn read(&self, name: &str) -> Result<Opened, CaseError> {
        let text = self.text(name)?;
        let path = self.patient(name);
        let shown = PathBuf::from(path.file_name().unwrap_or_default());
        let patient = Patient::parse_unchecked(&text, &shown).map_err(|error| error.to_string());
        let (version, status) = (version_of(&text), self.status(name));
        let was_compiled = status.as_ref().is_some_and(|status| {
            status.patient_hash == version && status.program == env!("CARGO_PKG_VERSION")
        });
        let faults = match &patient {
            Ok(patient) if !was_compiled => checked(&version, patient),
            _ => Vec::new(),
        };
        Ok(Opened {
            name: name.to_owned(),
            text,
            version,
            patient,
            faults,
            status,
        })
    }

    /// Text of the patient file of a case.
    ///
    /// # Errors
    /// The errors of [`CaseStore::read`].
    pub fn text(&self, name: &str) -> Result<String, CaseError> {
        check_name(name)?;
        let path = self.patient(name);
        let bytes = read_private(&path, MOST_BYTES)?.ok_or_else(|| self.unknown(name))?;
        String::from_utf8(bytes).map_err(|_| CaseError::NoText(path))
    }

    fn unknown(&self, name: &str) -> CaseError {
        let known = match self.names().unwrap_or_default() {
            names if names.is_empty() => "there are no cases yet".into(),
            names => format!("expected one of {}", names.join(", ")),
        };
        CaseError::Unknown {
            name: name.to_owned(),
            known,
        }
    }

    /// Facts of the compilation of a case; `None` without a compiled scene that fits.
    pub fn status(&self, name: &str) -> Option<Status> {
        let bytes = read_private(&self.file(name, "status.json"), MOST_STATUS).ok()??;
        let status: Status = serde_json::from_slice(&bytes).ok()?;
        let length = std::fs::metadata(self.scene(name)).ok()?.len();
        // A crash between the two files leaves a scene that the status does not describe.
        (status.version == VERSION && length == status.scene_bytes).then_some(status)
    }

    /// Makes a case from the text of a patient file, which must be one.
    ///
    /// # Errors
    /// A case has the name, the store is full, or the text is no patient file.
    pub fn create(&self, name: &str, text: &str) -> Result<Opened, CaseError> {
        check_name(name)?;
        Patient::parse_unchecked(text, Path::new(&format!("{name}{PATIENT}")))?;
        let lock = self.lock()?;
        let path = self.patient(name);
        if path.exists() {
            return Err(CaseError::Exists(name.to_owned()));
        }
        if self.names()?.len() >= MOST_CASES {
            return Err(CaseError::Full(MOST_CASES));
        }
        // Files that a removal could not end belong to another patient.
        self.remove_made(name)?;
        create_private(&path, text.as_bytes())?;
        drop(lock);
        self.read(name)
    }

    /// Replaces the text of a case if its version is still `version`. The compiled scene stays.
    ///
    /// # Errors
    /// The file was changed in the meantime, or the text is no patient file. The file is unchanged then.
    pub fn write(&self, name: &str, version: &str, text: &str) -> Result<Opened, CaseError> {
        check_name(name)?;
        Patient::parse_unchecked(text, Path::new(&format!("{name}{PATIENT}")))?;
        let lock = self.lock()?;
        let found = self.text(name)?;
        if version_of(&found) != version {
            return Err(CaseError::Conflict(name.to_owned()));
        }
        if found != text {
            write_private(&self.patient(name), text.as_bytes())?;
        }
        drop(lock);
        self.read(name)
    }

    /// Removes a case with its compiled scene and pictures.
    ///
    /// # Errors
    /// A plan uses the case, or a file cannot be removed.
    pub fn remove(&self, name: &str) -> Result<(), CaseError> {
        self.text(name)?;
        let users = uses::users(self, name)?;
        if !users.is_empty() {
            return Err(CaseError::InUse {
                name: name.to_owned(),
                users,
            });
        }
        let _lock = self.lock()?;
        remove_private(&self.patient(name))?;
        self.remove_made(name)
    }

    /// Removes all files of a case that a compilation made.
    fn remove_made(&self, name: &str) -> Result<(), CaseError> {
        remove_private(&self.file(name, "status.json"))?;
        remove_private(&self.scene(name))?;
        self.remove_pictures(name)
    }

    pub(super) fn remove_pictures(&self, name: &str) -> Result<(), CaseError> {
        let path = self.folder.path();
        let start = format!("{name}.");
        let entries = std::fs::read_dir(path).map_err(StateError::io("list", path))?;
        for entry in entries.flatten() {
            let file = entry.file_name();
            let file = file.to_string_lossy();
            if file.starts_with(&start) && file.ends_with(".png") {
                remove_private(&entry.path())?;
            }
        }
        Ok(())
    }

    /// Keeps a compiled scene with its facts. A case that was removed in the meantime gets none.
    pub(super) fn keep(&self, name: &str, scene: &[u8], status: &Status) -> Result<(), CaseError> {
        let _lock = self.lock()?;
        if !self.patient(name).exists() {
            return Err(self.unknown(name));
        }
        let bytes = serde_json::to_vec_pretty(status).map_err(|error| {
            StateError::content(&self.file(name, "status.json"), error.to_string())
        })?;
        write_private(&self.scene(name), scene)?;
        write_private(&self.file(name, "status.json"), &bytes)?;
        self.remove_pictures(name)
    }

    /// Drawn picture of the compiled scene; `None` if it was not drawn yet.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn picture(&self, name: &str, side: &str) -> Result<Option<Vec<u8>>, CaseError> {
        check_name(name)?;
        check_name(side)?;
        Ok(read_private(
            &self.file(name, &format!("{side}.png")),
            MOST_PICTURE,
        )?)
    }

    /// Keeps a drawn picture of the compiled scene with this hash.
    ///
    /// # Errors
    /// The scene was compiled anew in the meantime, or the file cannot be written.
    #[cfg(feature = "lab")]
    pub(crate) fn keep_picture(
        &self,
        name: &str,
        side: &str,
        scene_hash: &str,
        png: &[u8],
    ) -> Result<(), CaseError> {
        let _lock = self.lock()?;
        let status = self.status(name);
        if status.is_none_or(|status| status.scene_hash != scene_hash) {
            return Err(CaseError::Conflict(name.to_owned()));
        }
        Ok(write_private(
            &self.file(name, &format!("{side}.png")),
            png,
        )?)
    }
}

/// Text of the patient of a compiled scene of a case, for the recording; `None` for any other compiled scene.
pub(crate) fn patient_of(scene: &Path, bytes: &[u8]) -> Option<String> {
    let status = std::fs::read(scene.with_extension("status.json")).ok()?;
    let status: Status = serde_json::from_slice(&status).ok()?;
    let hash = blake3::hash(bytes).to_hex();
    (status.version == VERSION && *status.scene_hash == *hash.as_str()).then_some(status.patient)
}

/// Keeps a scene of a few bytes for a case, for tests of what stands on a compiled case.
#[cfg(all(test, feature = "console"))]
pub(crate) fn test_scene(store: &CaseStore, name: &str) {
    tests::keep_scene(store, name);
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
