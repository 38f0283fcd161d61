//! The receiving end of a display's feed: the scene, and the newest frame for the window.
//!
//! A display holds a QUIC connection of its own beside the haptic link, in a runtime of its own: a scene of megabytes
//! must not delay a wrench. [`transport`] has the settings of this connection. [`receive()`] runs on it after the
//! server's answer on the control stream. The client's hello lists [`Cache::known`]; the server sends no scene that the
//! cache has.
//!
//! [`DisplayLink`] does all of this on a thread of its own, and connects again after a loss. The window's thread takes
//! [`DisplayLink::newest`], which never waits.

mod cache;
mod connect;
mod receive;
mod stats;
#[cfg(test)]
mod tests;

use std::sync::{Arc, Mutex, PoisonError};

use quinn::TransportConfig;
use sulcus_proto::display::{DisplayFrame, DisplayScene, SceneHash};
use sulcus_proto::limits;
use triple_buffer::Output;

pub use cache::{Cache, SCENES};
pub use connect::DisplayLink;
pub use receive::{FeedEnd, receive};
pub use stats::FeedStats;

use crate::link::LinkError;

/// A scene with the newest frame that belongs to it.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Hash of the scene.
    pub hash: SceneHash,
    /// Scene at rest.
    pub scene: Arc<DisplayScene>,
    /// Newest frame of this scene; `None` before the first. All its numbers exist in the scene.
    pub frame: Option<DisplayFrame>,
}

/// The window's end of a feed.
pub struct Feed {
    pictures: Output<Option<Picture>>,
    stats: Arc<Mutex<FeedStats>>,
}

impl Feed {
    /// Newest picture so far, also after the end of the feed; `None` before the first scene.
    pub fn newest(&mut self) -> Option<&Picture> {
        self.pictures.update();
        self.pictures.output_buffer().as_ref()
    }

    /// Counts so far. The call takes a lock that the receiver holds for a copy only.
    pub fn stats(&self) -> FeedStats {
        *self.stats.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the transport settings of a display's connection.
///
/// # Errors
/// QUIC cannot be configured. The settings of this program cause no error.
pub fn transport() -> Result<TransportConfig, LinkError> {
    let mut transport =
        sulcus_link::bulk::of_display().map_err(|error| LinkError::System(error.to_string()))?;
    transport.keep_alive_interval(Some(limits::KEEP_ALIVE));
    Ok(transport)
}
