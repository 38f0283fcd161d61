//! Seat of a session: the place of a screen between a device and its link.

use sulcus_connection::device::EventDevice;
use sulcus_connection::link::{Link, LinkConfig};
use sulcus_proto::control::ServerHello;
use sulcus_sessions::Exercise;

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
}

/// Name of the device that performs a session.
pub fn device(seat: Seat<'_>) -> &'static str {
    seat.and_then(|screen| screen.device).unwrap_or("simulated")
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
