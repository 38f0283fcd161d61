//! Configuration of a server.

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

/// Exercise of a station, as clients and recordings receive it.
#[derive(Clone, Debug, PartialEq)]
pub struct Exercise {
    /// Name: 1 to 64 ASCII letters, digits, `-`, `_` or `/`. The name is part of a recording's file name, `/` as `-`.
    pub name: String,
    /// Task for the student, at most 16 KiB.
    pub text: String,
    /// Definition (TOML) for the recording; empty for free exploration.
    pub definition: String,
    /// Seed of the exercise, sent to clients and recorded. The server itself draws no random numbers from it.
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

/// Configuration of a server. One server is one station, with one client at a time.
#[derive(Clone, Debug)]
pub struct ServerConfig {
    /// UDP address to listen on; port 0: any free port.
    pub listen: SocketAddr,
    /// Compiled scene; its parameters hold rate, solver and limits.
    pub scene: Arc<Scene>,
    /// The same scene as bytes, for the hash in the hello and for the recording.
    pub scene_bytes: Arc<Vec<u8>>,
    /// Folder for recordings; created if missing.
    pub recordings: PathBuf,
    /// Secret that a client must know, 1 to 256 bytes.
    pub token: String,
    /// Exercise offered.
    pub exercise: Exercise,
    /// Name of the station in recordings, at most 256 bytes. The certificate holds it too, if it can be a host name.
    pub station: String,
    /// Opaque learner id for recordings when the client names none; never a name; may be empty.
    pub learner: String,
    /// Purpose of the sessions. The purpose is recorded, and a grade is presented by it.
    pub mode: Mode,
    /// Text of the patient for the recording; may be empty.
    pub patient: String,
    /// Text of the rubric for the recording; empty: sessions are not graded.
    pub rubric: String,
    /// File of the key that signs recordings, created on first use. `None`: `StationKey::default_path` of
    /// `sulcus_sessions`.
    pub station_key: Option<PathBuf>,
    /// Level of detail of tissue. A session with a rubric needs a fixed level.
    pub detail: Detail,
    /// Force limit of the station's side at the start, newtons; 0: the scene's limit. A larger limit than the scene's
    /// has no effect. [`crate::ServerHandle::command`] changes the limit.
    pub force_limit_n: f32,
    /// Longest session; `None`: no limit.
    pub max_session: Option<Duration>,
    /// Time without a new pose after which a session ends. A client whose device hangs must not hold the station.
    pub max_silence: Duration,
    /// Whether to request real-time scheduling and locked memory. A missing right causes one warning.
    pub real_time: bool,
}

impl ServerConfig {
    /// Defaults: loopback, any free port, a random token, free exploration without a grade, practice, no time limit, a
    /// session's end after 60 s without a pose.
    ///
    /// # Errors
    /// The system gives no random numbers.
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
            return bad(
                "longest session",
                "0 s".into(),
                "more than 0 s, or no limit",
            );
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
                    "chosen by time in sessions with a rubric".into(),
                    "a fixed level in graded sessions: omit --detail-budget, or choose an exercise without a grade",
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

/// 128 random bits as 32 hexadecimal digits.
fn random_token() -> Result<String, ServerError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| ServerError::System(std::io::Error::other(error.to_string())))?;
    Ok(hex(&bytes))
}
