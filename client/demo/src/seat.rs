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

/// Takes a device before its session, and returns the device that performs the session. A screen returns a device that
/// shows what it exchanges.
pub type Seat<'a> = &'a dyn Fn(&Begun<'_>, Box<dyn EventDevice>) -> Box<dyn EventDevice>;

/// Seat without a screen: the device itself.
pub fn bare(_: &Begun<'_>, device: Box<dyn EventDevice>) -> Box<dyn EventDevice> {
    device
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
    seat(&begun, Box::new(device))
}
