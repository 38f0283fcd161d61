//! Seat of a session: the place of a screen between a device and its link.

use std::path::Path;

use sulcus_connection::device::EventDevice;
use sulcus_connection::link::{Link, LinkConfig};
use sulcus_proto::control::ServerHello;
use sulcus_sessions::pages::instants::Instant;
use sulcus_sessions::{Exercise, Grade, Mode};

use crate::simulated;

/// A session before its first period.
pub struct Begun<'a> {
    /// Configuration of the link.
    pub config: &'a LinkConfig,
    /// Hello of the server.
    pub hello: &'a ServerHello,
    /// Exercise.
    pub exercise: &'a Exercise,
}

/// Takes a device before its session, and returns the device that performs the session.
pub type Taker<'a> = dyn Fn(&Begun<'_>, Box<dyn EventDevice>) -> Box<dyn EventDevice> + 'a;

/// Seat with a screen; `None`: no screen, and the server makes no display of the scene.
pub type Seat<'a> = Option<Screen<'a>>;

/// Screen of a seat.
#[derive(Clone, Copy)]
pub struct Screen<'a> {
    /// Name of the device that takes the place of the simulated operator; `None`: the operator performs.
    pub device: Option<&'static str>,
    /// Returns a device that shows what it exchanges.
    pub take: &'a Taker<'a>,
    /// Takes the end of the session. A session that ends with an error has no such end.
    pub ended: &'a dyn Fn(&Ending<'_>),
}

/// End of a session, for its screen.
#[derive(Clone, Copy, Debug)]
pub enum Ending<'a> {
    /// The hands have ended, and the recording is being replayed.
    Replaying,
    /// The recording has been replayed.
    Replayed {
        /// Path of the recording.
        recording: &'a Path,
        /// Purpose of the session.
        mode: Mode,
        /// Grade; `None` for an exercise without a rubric.
        grade: Option<&'a Grade>,
        /// Worst finding that cost points; `None` without such a finding.
        worst: Option<&'a Instant>,
    },
    /// The recording is at a server elsewhere. The text is the mode of the session.
    Elsewhere(&'a str),
}

/// Name of the device that performs a session.
pub fn device(seat: Seat<'_>) -> &'static str {
    seat.and_then(|screen| screen.device)
        .unwrap_or(simulated::NAME)
}

/// Device in a seat, for a connected link.
pub fn taken(
    seat: Seat<'_>,
    config: &LinkConfig,
    link: &Link,
    exercise: &Exercise,
    device: impl EventDevice + 'static,
) -> Box<dyn EventDevice> {
    let begun = Begun {
        config,
        hello: link.hello(),
        exercise,
    };
    match seat {
        Some(screen) => (screen.take)(&begun, Box::new(device)),
        None => Box::new(device),
    }
}
