//! What a server is told before it starts.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use sulcus_core::{Scene, TickInput};
use sulcus_proto::limits::NAME_BYTES;
use sulcus_proto::ticket::hex;
use sulcus_sessions::Mode;

use crate::ServerError;
use crate::session::detail::Detail;

/// What a student is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Exercise {
    /// Name: letters, digits, `-`, `_`, `/`. It becomes part of the recording's file name.
    pub name: String,
    /// For the student.
    pub text: String,
    /// Its definition (TOML or JSON) as it goes into the recording; may be empty.
    pub definition: String,
    /// Seed of what is random in it.
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

/// Everything a server is told. One server is one station: one client at a time.
#[derive(Clone, Debug)]
pub struct ServerConfig {
    /// UDP address to listen on; port 0: any free one.
    pub listen: SocketAddr,
    /// Compiled scene; its parameters name the solver.
    pub scene: Arc<Scene>,
    /// The same scene as bytes: what is hashed and recorded.
    pub scene_bytes: Arc<Vec<u8>>,
    /// Folder for recordings; created when missing.
    pub recordings: PathBuf,
    /// Secret that a client must know.
    pub token: String,
    /// Exercise offered.
    pub exercise: Exercise,
    /// Name of this station, for the record and the certificate.
    pub station: String,
    /// Opaque learner id for the record when the client names none; never a name.
    pub learner: String,
    /// What sessions are for, for the record: who may see what of a grade.
    pub mode: Mode,
    /// The patient's text for the recording; may be empty.
    pub patient: String,
    /// The rubric's text for the recording; may be empty.
    pub rubric: String,
    /// File of the key that signs recordings, made on first use; `None`: at its usual place
    /// (`sulcus_sessions::StationKey::default_path`).
    pub station_key: Option<PathBuf>,
    /// Level of detail of tissue: fixed, as sessions with a rubric need it, or by the time that ticks leave.
    pub detail: Detail,
    /// Force limit of the station's side at the start, newtons; 0: the scene's limit. [`crate::ServerHandle::command`]
    /// changes it.
    pub force_limit_n: f32,
    /// Longest session; `None`: no limit.
    pub max_session: Option<Duration>,
    /// A session ends when no pose came for so long: a client whose device hangs must not hold the station all night.
    pub max_silence: Duration,
    /// Whether to ask the system for real-time scheduling and locked memory. (Where it is not
    /// permitted the server says so once and carries on.)
    pub real_time: bool,
}

impl ServerConfig {
    /// Loopback, any port, a random token, free exploration, no time limit.
    ///
    /// # Errors
    /// If the system gives no randomness.
    pub fn new(
        scene: Arc<Scene>,
        scene_bytes: Arc<Vec<u8>>,
        recordings: PathBuf,
    ) -> Result<Self, ServerError> {
        Ok(Self {
            listen: (Ipv4Addr::LOCALHOST, 0).into(),
            scene,
            scene_bytes,
            recordings,
            token: random_token()?,
            exercise: Exercise::default(),
            station: "station".into(),
            learner: String::new(),
            mode: Mode::default(),
            patient: String::new(),
            rubric: String::new(),
            station_key: None,
            detail: Detail::default(),
            force_limit_n: 0.0,
            max_session: None,
            max_silence: Duration::from_secs(60),
            real_time: true,
        })
    }

    pub(crate) fn validate(&self) -> Result<(), ServerError> {
        let bad = |field, found: String, expected| {
            Err(ServerError::Config {
                field,
                found,
                expected,
            })
        };
        if self.token.is_empty() || self.token.len() > NAME_BYTES {
            return bad(
                "token",
                format!("{} bytes long", self.token.len()),
                "1 to 256 bytes",
            );
        }
        let name = &self.exercise.name;
        let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/');
        if name.is_empty() || name.len() > 64 || !name.chars().all(known) {
            return bad(
                "exercise name",
                format!("`{name}`"),
                "1 to 64 letters, digits, `-`, `_` or `/`",
            );
        }
        if self.exercise.text.len() > 16 * 1024 {
            return bad(
                "exercise text",
                format!("{} bytes long", self.exercise.text.len()),
                "at most 16 KiB",
            );
        }
        if self.station.len() > NAME_BYTES {
            return bad(
                "station name",
                format!("{} bytes long", self.station.len()),
                "at most 256 bytes",
            );
        }
        if !crate::session::levels::is_limit(self.force_limit_n) {
            return bad(
                "force limit",
                self.force_limit_n.to_string(),
                "0 (the scene's) or a positive force in newtons",
            );
        }
        if self.max_session.is_some_and(|limit| limit.is_zero()) {
            return bad("session limit", "zero".into(), "more than zero, or none");
        }
        match self.detail {
            Detail::Fixed(level) if level > TickInput::MAX_DETAIL => {
                return bad(
                    "level of detail",
                    level.to_string(),
                    "0 (coarse) or 1 (fine)",
                );
            }
            Detail::Fixed(_) => {}
            Detail::ByTime(_) if !self.rubric.is_empty() => {
                return bad(
                    "level of detail",
                    "by time, in a session with a rubric".into(),
                    "a fixed level where a session is graded: all students must feel the same",
                );
            }
            Detail::ByTime(budget) => {
                if let Err((field, found, expected)) = budget.validate() {
                    return bad(field, found, expected);
                }
            }
        }
        Ok(())
    }
}

/// 128 random bits as text.
fn random_token() -> Result<String, ServerError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| ServerError::System(std::io::Error::other(error.to_string())))?;
    Ok(hex(&bytes))
}
