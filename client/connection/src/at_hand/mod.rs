//! Ticks at the hand: the client computes the session's ticks beside the device, and hands their exact inputs in.

pub(crate) mod outbox;
mod pace;
mod ticker;

pub use outbox::Out;
pub use ticker::{HandTicker, Ticked};

use std::sync::Arc;

use sulcus_core::{Coupling, Scene, SceneError};
use sulcus_proto::control::ServerHello;

/// Round trip from which on the ticks run at the hand by choice of the client.
pub const FAR: std::time::Duration = std::time::Duration::from_millis(3);

/// Place of the ticks that a client asks for. The server may keep them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TickPlace {
    /// At the server.
    #[default]
    Server,
    /// At the hand.
    Hand,
    /// At the hand if the round trip is above [`FAR`].
    Auto,
}

/// Scene with the couplings of a server's hello: the bits of its ticks are those of the server.
///
/// # Errors
/// The hello has another number of tools, or couplings that do not fit the scene.
pub fn coupled(scene: &Arc<Scene>, hello: &ServerHello) -> Result<Arc<Scene>, SceneError> {
    let couplings: Vec<Coupling> = hello
        .tools
        .iter()
        .map(|tool| Coupling {
            n_per_m: tool.stiffness_n_per_m,
            nm_per_rad: tool.stiffness_nm_per_rad,
        })
        .collect();
    if couplings == scene.couplings() {
        return Ok(scene.clone());
    }
    scene.with_couplings(&couplings).map(Arc::new)
}
