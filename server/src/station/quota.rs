//! Quota of the folder of recordings: a session without room is refused before it begins, and running ones go on.
//!
//! A look at the folder runs beside the network and the simulations. A look asks for the length of new files and of
//! files that may still grow; a finished file is asked once. Between two looks an admission is plain arithmetic: the
//! sum of the newest look, the rest that running sessions may still write, and the forecast of the new session.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use serde_json::{Value, json};
use sulcus_sessions::ViewersPolicy;
use tokio::sync::Notify;

use crate::station::config::SessionPlan;

/// Bytes of an hour of a station with two hands at 1 kHz, measured with viewers' channels in the whole mouth.
const TWO_HANDS_PER_HOUR: f64 = 1.2e9;
/// Bytes of an hour of a station with one hand at 1 kHz: exact record and half of the largest viewers' channels.
const ONE_HAND_PER_HOUR: f64 = 0.7e9;
/// Bytes of an hour with two hands at 1 kHz and without viewers' channels: an exact record of 9.7 MB a minute, measured
/// with a sample of the device for every tick, and the kept channel.
const TWO_HANDS_ON_DEMAND: f64 = 0.6e9;
/// The same with one hand: an exact record of 5 MB a minute, a quarter more for the samples, and the kept channel.
const ONE_HAND_ON_DEMAND: f64 = 0.4e9;
/// Length of a session without a limit, for the forecast. Chosen: a lesson.
const LESSON: Duration = Duration::from_secs(3600);
/// Time between two looks at the folder.
const LOOK: Duration = Duration::from_secs(5);
/// Age of the last change from which a file no longer grows.
const SETTLED: Duration = Duration::from_secs(60);
/// Largest number of new files whose length one look asks for, and of growing ones.
const MOST_ASKED: usize = 4096;

/// Bytes that a station records in an hour; the exact record grows with the rate.
pub(crate) fn bytes_per_hour(viewers: ViewersPolicy, tools: usize, rate_hz: u16) -> f64 {
    let at_1_khz = match (viewers, tools > 1) {
        (ViewersPolicy::Recorded, true) => TWO_HANDS_PER_HOUR,
        (ViewersPolicy::Recorded, false) => ONE_HAND_PER_HOUR,
        (ViewersPolicy::OnDemand, true) => TWO_HANDS_ON_DEMAND,
        (ViewersPolicy::OnDemand, false) => ONE_HAND_ON_DEMAND,
    };
    at_1_khz * (f64::from(rate_hz) / 1000.0).max(1.0)
}

/// Forecast of a session's recording, bytes: its beginning with the scene, and its longest time.
pub(crate) fn forecast(viewers: ViewersPolicy, plan: &SessionPlan) -> u64 {
    let hours = plan.max_session.unwrap_or(LESSON).as_secs_f64() / 3600.0;
    let tools = plan.scene.tools.len();
    let of_time = bytes_per_hour(viewers, tools, plan.scene.params.rate_hz) * hours;
    plan.scene_bytes.len() as u64 + of_time as u64
}

/// Gigabytes for people.
pub(crate) fn gb(bytes: u64) -> String {
    let gb = bytes as f64 / 1e9;
    match bytes {
        0..1_000_000_000 => format!("{gb:.3} GB"),
        _ => format!("{gb:.1} GB"),
    }
}

/// Quota of a folder, with the sessions that write there.
#[derive(Debug)]
pub(crate) struct Quota {
    folder: PathBuf,
    /// Bytes that the folder may have.
    most: u64,
    /// Files of the newest look. The lock is held during a look, never on the network's thread.
    files: Mutex<BTreeMap<PathBuf, Known>>,
    room: Mutex<Room>,
    /// Wakes the looks at the end of a session.
    ended: Notify,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    bytes: u64,
    /// Whether the file no longer grows.
    is_settled: bool,
}

#[derive(Debug, Default)]
struct Room {
    /// Bytes of the folder at the newest look.
    used: u64,
    /// Sessions by the number of the station.
    sessions: BTreeMap<usize, Reserved>,
    /// Forecasts of the next sessions, by the number of the station.
    planned: BTreeMap<usize, u64>,
}

#[derive(Debug)]
struct Reserved {
    forecast: u64,
    /// Name of the recording; `None` before its begin.
    file: Option<String>,
    /// Length of the recording at the newest look.
    written: u64,
}

impl Room {
    /// Bytes of the folder when all sessions but that of `station` have ended.
    fn expected(&self, station: Option<usize>) -> u64 {
        let others = self.sessions.iter().filter(|(at, _)| Some(**at) != station);
        let left = others.map(|(_, one)| one.forecast.saturating_sub(one.written));
        left.fold(self.used, u64::saturating_add)
    }
}

impl Quota {
    /// Quota of `most` bytes, with a first look at the folder.
    pub fn new(folder: &Path, most: u64) -> Self {
        let quota = Self {
            folder: folder.to_owned(),
            most,
            files: Mutex::default(),
            room: Mutex::default(),
            ended: Notify::new(),
        };
        while !quota.look() {}
        quota
    }

    fn room(&self) -> MutexGuard<'_, Room> {
        self.room.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Looks at the folder. `false`: there were more new files than one look takes, and another one should follow.
    pub fn look(&self) -> bool {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let running: Vec<PathBuf> = {
            let room = self.room();
            let names = room.sessions.values().filter_map(|one| one.file.as_ref());
            names.map(|name| self.folder.join(name)).collect()
        };
        let mut next = BTreeMap::new();
        let (mut new, mut growing) = (0, 0);
        // A folder that cannot be listed is full: a session there could not be recorded either.
        let Ok(entries) = std::fs::read_dir(&self.folder) else {
            self.room().used = self.most;
            return true;
        };
        for entry in entries.flatten() {
            let path = entry.path();
            let known = match files.get(&path).copied() {
                Some(known) if known.is_settled && !running.contains(&path) => Some(known),
                known => {
                    let asked = if known.is_some() {
                        &mut growing
                    } else {
                        &mut new
                    };
                    *asked += 1;
                    if *asked > MOST_ASKED {
                        known
                    } else {
                        length(&entry)
                    }
                }
            };
            if let Some(known) = known {
                next.insert(path, known);
            }
        }
        let mut room = self.room();
        room.used = next.values().map(|known| known.bytes).sum();
        for session in room.sessions.values_mut() {
            let path = session.file.as_ref().map(|name| self.folder.join(name));
            let known = path.and_then(|path| next.get(&path));
            session.written = known.map_or(session.written, |known| known.bytes);
        }
        *files = next;
        new <= MOST_ASKED
    }

    /// Notes the forecast of a station's next session.
    pub fn planned(&self, station: usize, forecast: u64) {
        self.room().planned.insert(station, forecast);
    }

    /// Admits a session at a station and reserves its forecast, until [`Quota::release`].
    ///
    /// # Errors
    /// The folder has no room: one sentence.
    pub fn admit(&self, station: usize, forecast: u64) -> Result<(), String> {
        let mut room = self.room();
        let used = room.expected(Some(station));
        if used.saturating_add(forecast) > self.most {
            return Err(self.refusal(used, forecast));
        }
        let reserved = Reserved {
            forecast,
            file: None,
            written: 0,
        };
        room.sessions.insert(station, reserved);
        Ok(())
    }

    fn refusal(&self, used: u64, forecast: u64) -> String {
        format!(
            "the recordings of this server have reached their quota: {} of {} are used or reserved, and this session may need {}; tell the instructor",
            gb(used),
            gb(self.most),
            gb(forecast)
        )
    }

    /// Notes the recording of a session that has begun.
    pub fn began(&self, station: usize, file: &str) {
        if let Some(session) = self.room().sessions.get_mut(&station) {
            session.file = Some(file.to_owned());
        }
    }

    /// Frees what a session has reserved and did not write.
    pub fn release(&self, station: usize) {
        if self.room().sessions.remove(&station).is_some() {
            self.ended.notify_one();
        }
    }

    /// Bytes of the folder at the newest look.
    pub fn used(&self) -> u64 {
        self.room().used
    }

    /// Bytes that are neither used nor reserved.
    pub fn left(&self) -> u64 {
        self.most.saturating_sub(self.room().expected(None))
    }

    /// Reason why no station can begin a further session; `None`: one can.
    pub fn obstacle(&self) -> Option<String> {
        let room = self.room();
        let free = room
            .planned
            .iter()
            .filter(|(at, _)| !room.sessions.contains_key(at));
        let least = free.map(|(_, forecast)| *forecast).min()?;
        let used = room.expected(None);
        (used.saturating_add(least) > self.most).then(|| self.refusal(used, least))
    }

    /// State for the control socket.
    pub fn state(&self) -> Value {
        json!({
            "quota_bytes": self.most, "used_bytes": self.used(), "left_bytes": self.left(),
            "refusal": self.obstacle(),
        })
    }
}

/// Length of a file; `None` for a folder, and for a file that was removed meanwhile.
fn length(entry: &std::fs::DirEntry) -> Option<Known> {
    let data = entry.metadata().ok().filter(std::fs::Metadata::is_file)?;
    let age = data
        .modified()
        .map(|at| SystemTime::now().duration_since(at));
    Some(Known {
        bytes: data.len(),
        is_settled: matches!(age, Ok(Ok(age)) if age >= SETTLED),
    })
}

/// Looks at the folder again and again, on threads that may wait for the disk.
pub(crate) async fn watch(quota: Arc<Quota>) {
    loop {
        // A look that was cut short is followed by the next one at once.
        let own = quota.clone();
        let is_whole = tokio::task::spawn_blocking(move || own.look()).await;
        if is_whole.unwrap_or(true) {
            tokio::select! {
                () = tokio::time::sleep(LOOK) => {}
                () = quota.ended.notified() => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MB: u64 = 1_000_000;

    fn place(files: &[(&str, u64)]) -> tempfile::TempDir {
        let place = tempfile::tempdir().expect("a folder");
        for (name, bytes) in files {
            put(&place, name, *bytes);
        }
        place
    }

    fn put(place: &tempfile::TempDir, name: &str, bytes: u64) {
        let file = std::fs::File::create(place.path().join(name)).expect("a file");
        file.set_len(bytes).expect("a length");
    }

    #[test]
    fn a_session_is_refused_by_what_is_there_and_by_what_others_may_still_write() {
        let place = place(&[("a.mcap", 4 * MB), ("a.mcap.grade.json", MB)]);
        std::fs::create_dir(place.path().join("folder")).expect("makes");
        let quota = Quota::new(place.path(), 10 * MB);
        quota.admit(0, 3 * MB).expect("five and three are eight");
        let why = quota.admit(1, 3 * MB).expect_err("eleven");
        for words in ["quota", "0.008 GB of 0.010 GB", "may need 0.003 GB"] {
            assert!(why.contains(words), "{why}");
        }
        assert_eq!(why.matches(". ").count(), 0, "one sentence: {why}");
        // The recording grows into its own reservation, not beside it.
        quota.began(0, "b.mcap");
        put(&place, "b.mcap", 2 * MB);
        assert!(quota.look());
        assert_eq!(quota.left(), 2 * MB);
        quota.admit(1, 2 * MB).expect("ten");
        // The end of a session frees what it did not write.
        quota.release(1);
        quota.release(0);
        assert!(quota.look());
        assert_eq!(quota.left(), 3 * MB);
        quota.admit(0, 3 * MB).expect("ten again");
        quota
            .admit(0, 3 * MB)
            .expect("the same station replaces its own");
    }

    #[test]
    fn removed_and_grown_files_count_from_the_next_look_on() {
        let place = place(&[("a.mcap", 4 * MB)]);
        let quota = Quota::new(place.path(), 5 * MB);
        quota.planned(0, 2 * MB);
        assert!(quota.obstacle().is_some());
        std::fs::remove_file(place.path().join("a.mcap")).expect("removes");
        assert!(quota.look());
        assert_eq!((quota.left(), quota.obstacle()), (5 * MB, None));
        put(&place, "b.mcap", 4 * MB);
        assert!(quota.look());
        assert_eq!(quota.left(), MB);
        assert_eq!(quota.state()["used_bytes"], 4 * MB);
        drop(place);
        assert!(quota.look());
        assert_eq!(
            quota.left(),
            0,
            "a folder that cannot be listed has no room"
        );
    }

    #[test]
    fn many_files_take_several_looks_and_finished_ones_are_asked_once() {
        let place = tempfile::tempdir().expect("a folder");
        let old = SystemTime::now() - 2 * SETTLED;
        for k in 0..MOST_ASKED + 10 {
            let file = std::fs::File::create(place.path().join(format!("{k}.mcap")));
            let file = file.expect("a file");
            file.set_len(10).expect("a length");
            file.set_modified(old).expect("own file");
        }
        let quota = Quota::new(place.path(), 1 << 30);
        assert_eq!(quota.room().used, 10 * (MOST_ASKED as u64 + 10));
        // A settled file is not asked again, unless a session writes it.
        put(&place, "5.mcap", 99);
        quota.look();
        assert_eq!(quota.room().used, 10 * (MOST_ASKED as u64 + 10));
        quota.admit(0, 1).expect("room");
        quota.began(0, "5.mcap");
        quota.look();
        assert_eq!(quota.room().used, 10 * (MOST_ASKED as u64 + 9) + 99);
    }
}
