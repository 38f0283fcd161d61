//! Configuration of a server and of its stations.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use sulcus_core::{Coupling, Scene, SceneError, TickInput};
use sulcus_display::Display;
use sulcus_proto::hex::hex;
use sulcus_proto::limits::NAME_BYTES;
use sulcus_sessions::{Mode, ViewersPolicy};

use crate::ServerError;
use crate::capacity::Cost;
use crate::net::codes::{Codes, NoCodes};
use crate::net::tokens::{Fixed, Tokens};
use crate::session::detail::Detail;
use crate::station::planner::{NoPlanner, Planner};

/// Largest number of stations of a server.
pub const STATIONS: usize = 64;

/// Exercise of a station, as clients and recordings receive it.
#[derive(Clone, Debug, PartialEq)]
pub struct Exercise {
    /// Name: 1 to 64 ASCII letters, digits, `-`, `_` or `/`. The name is part of a recording's file name, `/` as `-`.
    pub name: String,
    /// Task for the student, at most 16 KiB.
    pub text: String,
    /// Definition (TOML) for the recording; empty for free exploration.
    pub definition: String,
    /// Seed of the exercise, recorded. The server itself draws no random numbers from it, and sends it to nobody.
    pub seed: u64,
}

impl Default for Exercise {
    fn default() -> Self {
        Self {
            name: "free".into(),
            text: "Explore freely.".into(),
            definition: String::new(),
            seed: 0,
        }
    }
}

/// Plan of a station's sessions, ready to run: exercise, compiled scene, rules.
#[derive(Clone)]
pub struct SessionPlan {
    /// Revision, from 1 on; each change of a station's plan takes the next number.
    pub revision: u32,
    /// Compiled scene; its parameters hold rate, solver and limits.
    pub scene: Arc<Scene>,
    /// The same scene as bytes, for the hash in the hello and for the recording.
    pub scene_bytes: Arc<Vec<u8>>,
    /// Exercise offered.
    pub exercise: Exercise,
    /// Opaque learner id for recordings when the client names none; never a name; may be empty.
    pub learner: String,
    /// Purpose of the sessions. The purpose is recorded, and a grade is presented by it.
    pub mode: Mode,
    /// Text of the patient for the recording; may be empty.
    pub patient: String,
    /// Text of the rubric for the recording; empty: sessions are not graded.
    pub rubric: String,
    /// Level of detail of tissue. A session with a rubric needs a fixed level.
    pub detail: Detail,
    /// Longest session; `None`: no limit.
    pub max_session: Option<Duration>,
    /// Time without a new pose of an attached student after which a session ends. A client whose device hangs must not
    /// hold the station.
    pub max_silence: Duration,
    /// Time for a student's return after a lost connection. Zero: a lost connection ends the session.
    pub resume_within: Duration,
    /// Whether the time of [`SessionPlan::max_session`] runs while the student is gone.
    pub clock_in_gap: bool,
    /// Largest force of the plan, newtons; 0: the scene's limit. Neither student nor instructor can raise it.
    pub force_limit_n: f32,
    /// Whether a client may run the ticks at the hand. It then holds the compiled mouth, and with it the answer.
    pub tick_at_hand: bool,
    /// Last change of the plan; `None` for the plan of the start.
    pub changed: Option<Changed>,
    /// Whether the patient is drawn anew for each session.
    pub renews: bool,
    /// Scene for displays; `None`: the station has no feed.
    pub display: Option<Arc<Display>>,
    /// Cost of a tick on this machine, for admission; `None`: not measured, and always admitted.
    pub cost: Option<Cost>,
}

/// Change of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Changed {
    /// Time, nanoseconds since 1970.
    pub unix_ns: u64,
    /// Author: the id of a token, or a user of the machine.
    pub by: String,
}

impl SessionPlan {
    /// Defaults: free exploration without a grade, practice, no time limit, a return within 30 s, a clock that stops in
    /// gaps, a session's end after 60 s without a pose.
    pub fn new(scene: Arc<Scene>, scene_bytes: Arc<Vec<u8>>) -> Self {
        Self {
            revision: 1,
            scene,
            scene_bytes,
            exercise: Exercise::default(),
            learner: String::new(),
            mode: Mode::default(),
            patient: String::new(),
            rubric: String::new(),
            detail: Detail::default(),
            max_session: None,
            max_silence: Duration::from_secs(60),
            resume_within: Duration::from_secs(30),
            clock_in_gap: false,
            force_limit_n: 0.0,
            tick_at_hand: true,
            changed: None,
            renews: false,
            display: None,
            cost: None,
        }
    }

    /// Plan of a session with other couplings, in the order of the tools. The simulation runs on a copy of the scene.
    /// The bytes of the scene, and thus the hash, stay.
    ///
    /// # Errors
    /// The couplings do not fit the scene.
    pub(crate) fn with_couplings(&self, couplings: &[Coupling]) -> Result<Self, SceneError> {
        Ok(Self {
            scene: Arc::new(self.scene.with_couplings(couplings)?),
            ..self.clone()
        })
    }

    /// Makes the display of the scene, so that screens can show the session. Takes some seconds for the first mouth of
    /// a process.
    ///
    /// # Errors
    /// A mesh of the scene is beyond the limits of a display.
    pub fn show(&mut self) -> Result<(), sulcus_proto::CodecError> {
        self.display = Some(Arc::new(Display::new(&self.scene)?));
        Ok(())
    }

    /// Checks all values.
    ///
    /// # Errors
    /// The first value out of its range.
    pub fn validate(&self) -> Result<(), ServerError> {
        let name = &self.exercise.name;
        let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/');
        if name.is_empty() || name.len() > 64 || !name.chars().all(known) {
            let expected = "1 to 64 letters, digits, `-`, `_` or `/`";
            return bad("exercise name", format!("`{name}`"), expected);
        }
        if self.exercise.text.len() > 16 * 1024 {
            let found = format!("{} bytes long", self.exercise.text.len());
            return bad("exercise text", found, "at most 16 KiB");
        }
        if self.max_session.is_some_and(|limit| limit.is_zero()) {
            let expected = "more than 0 s, or no limit";
            return bad("longest session", "0 s".into(), expected);
        }
        if !crate::session::levels::is_limit(self.force_limit_n) {
            let expected = "0 (the scene's) or a positive force in newtons";
            return bad(
                "force limit of the plan",
                self.force_limit_n.to_string(),
                expected,
            );
        }
        if self.resume_within > Duration::from_secs(3600) {
            let found = format!("{} s", self.resume_within.as_secs());
            return bad("time for a return", found, "0 to 3600 s");
        }
        match self.detail {
            Detail::Fixed(level) if level > TickInput::MAX_DETAIL => {
                let expected = "0 (coarse) or 1 (fine)";
                bad("level of detail", level.to_string(), expected)
            }
            Detail::Fixed(_) => Ok(()),
            Detail::ByTime(_) if !self.rubric.is_empty() => bad(
                "level of detail",
                "chosen by time in sessions with a rubric".into(),
                "a fixed level in graded sessions: omit --detail-budget, or choose an exercise without a grade",
            ),
            Detail::ByTime(budget) => match budget.validate(self.scene.params.rate_hz) {
                Ok(()) => Ok(()),
                Err((field, found, expected)) => bad(field, found, expected),
            },
        }
    }
}

/// Configuration of one station.
#[derive(Clone)]
pub struct StationConfig {
    /// Name in recordings, at most 256 bytes; unique in a server.
    pub name: String,
    /// Plan of the next session.
    pub plan: SessionPlan,
    /// Force limit of the station's side at the start, newtons; 0: the scene's limit. A larger limit than the scene's
    /// has no effect. [`crate::ServerHandle::command`] changes the limit.
    pub force_limit_n: f32,
}

impl StationConfig {
    /// A station with the name `station`.
    pub fn new(plan: SessionPlan) -> Self {
        Self {
            name: "station".into(),
            plan,
            force_limit_n: 0.0,
        }
    }

    fn validate(&self) -> Result<(), ServerError> {
        if self.name.is_empty() || self.name.len() > NAME_BYTES {
            let found = format!("{} bytes long", self.name.len());
            return bad("station name", found, "1 to 256 bytes");
        }
        if !crate::session::levels::is_limit(self.force_limit_n) {
            let expected = "0 (the scene's) or a positive force in newtons";
            return bad("force limit", self.force_limit_n.to_string(), expected);
        }
        self.plan.validate()
    }
}

/// Configuration of a server: address, folders, tokens and stations.
#[derive(Clone)]
pub struct ServerConfig {
    /// UDP address to listen on; port 0: any free port.
    pub listen: SocketAddr,
    /// TCP address for metrics in the text format of Prometheus, without any check of readers. `None`: no metrics.
    pub metrics: Option<SocketAddr>,
    /// Folder for recordings; created if missing.
    pub recordings: PathBuf,
    /// Policy of the recordings about the channels for viewers.
    pub viewers: ViewersPolicy,
    /// Bytes that the folder of recordings may have. A session whose forecast goes beyond is refused. `None`: no quota.
    pub recordings_quota: Option<u64>,
    /// File of the key that signs recordings, created on first use. `None`: `StationKey::default_path` of
    /// `sulcus_sessions`.
    pub station_key: Option<PathBuf>,
    /// Folder for notes on running sessions, by which a session goes on after a crash of the server. `None`: no notes.
    pub journal: Option<PathBuf>,
    /// Certificate (DER) and private key (PKCS #8, DER). `None`: new ones at each start.
    pub identity: Option<(Vec<u8>, Vec<u8>)>,
    /// Secret of the first station's student, 1 to 256 bytes. Its ticket is [`crate::ServerHandle::ticket`].
    pub token: String,
    /// Further tokens, with their roles and stations.
    pub tokens: Arc<dyn Tokens>,
    /// Codes with which learners sign in at a station.
    pub codes: Arc<dyn Codes>,
    /// Source of plans that an instructor sets.
    pub planner: Arc<dyn Planner>,
    /// Stations, 1 to [`STATIONS`].
    pub stations: Vec<StationConfig>,
    /// Folder with clients of this release, which the console offers for download. `None`: none.
    pub clients: Option<PathBuf>,
    /// Whether to request real-time scheduling and locked memory. A missing right causes one warning.
    pub real_time: bool,
}

impl ServerConfig {
    /// Defaults: loopback, any free port, a random token for the only station, a new certificate.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn new(station: StationConfig, recordings: PathBuf) -> Result<Self, ServerError> {
        Ok(Self {
            listen: (Ipv4Addr::LOCALHOST, 0).into(),
            metrics: None,
            recordings,
            viewers: ViewersPolicy::default(),
            recordings_quota: None,
            station_key: None,
            journal: None,
            identity: None,
            token: random_token()?,
            tokens: Arc::new(Fixed::default()),
            codes: Arc::new(NoCodes),
            planner: Arc::new(NoPlanner),
            stations: vec![station],
            clients: None,
            real_time: true,
        })
    }

    pub(crate) fn validate(&self) -> Result<(), ServerError> {
        if self.token.is_empty() || self.token.len() > NAME_BYTES {
            let found = format!("{} bytes long", self.token.len());
            return bad("token", found, "1 to 256 bytes");
        }
        if self.stations.is_empty() || self.stations.len() > STATIONS {
            let found = self.stations.len().to_string();
            return bad("number of stations", found, "1 to 64");
        }
        for (k, station) in self.stations.iter().enumerate() {
            station.validate()?;
            if self.stations[..k]
                .iter()
                .any(|one| one.name == station.name)
            {
                let found = format!("`{}` twice", station.name);
                return bad("station name", found, "a name of its own for each station");
            }
        }
        Ok(())
    }
}

fn bad(field: &'static str, found: String, expected: &'static str) -> Result<(), ServerError> {
    Err(ServerError::Config {
        field,
        found,
        expected,
    })
}

/// 128 random bits as 32 hexadecimal digits.
fn random_token() -> Result<String, ServerError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| ServerError::System(std::io::Error::other(error.to_string())))?;
    Ok(hex(&bytes))
}
