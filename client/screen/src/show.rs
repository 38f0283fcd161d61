//! Content of a window: what a session shows on it, and what the person at the window does.

use std::sync::Arc;

use sulcus_proto::TOOLS;
use sulcus_proto::display::{DisplayScene, SceneHash};

use crate::camera::Vector;
use crate::hand::Shared;
use crate::head::Head;
use crate::moment::{Moment, ToolAt};
use crate::panel::{Detail, PanelState, Primitive};
use crate::readings::Key;
use crate::views::View;

/// Session behind a window. The window's thread calls all functions; none may wait for the haptic thread.
pub trait Show {
    /// Scene with its hash; `None` before the first one.
    fn scene(&mut self) -> Option<(SceneHash, Arc<DisplayScene>)>;

    /// Instant to draw now, and the time since its content was made, seconds. `None` before the first one.
    fn moment(&mut self) -> Option<(Moment, f64)>;

    /// Contents of the panel. `detail` is the present level of the picture.
    fn panel(&mut self, detail: Detail) -> PanelState;

    /// Primitives over the picture in place of the panel, for a window of `window` pixels on a display with the scale
    /// factor `scale`; `None`: the panel.
    fn overlay(&mut self, _window: [u32; 2], _scale: f32) -> Option<Vec<Primitive>> {
        None
    }

    /// Place to which the picture points, mm. Without one the picture points at the site to be read.
    fn mark(&mut self) -> Option<Vector> {
        None
    }

    /// Ghosts of the tools, drawn see-through over the picture; `None` for a tool without one.
    fn ghosts(&mut self) -> [Option<ToolAt>; TOOLS] {
        [None; TOOLS]
    }

    /// Takes an act of the person at the window.
    fn act(&mut self, act: Act);

    /// Hands that mouse and keys move; `None` if a device moves them.
    fn hands(&self) -> Option<Arc<Shared>> {
        None
    }

    /// View that the content asks for. Each view is asked for once.
    fn wanted_view(&mut self) -> Option<Wanted> {
        None
    }

    /// Whether the hands have nothing left to move.
    fn hands_are_done(&self) -> bool {
        false
    }

    /// The person asks to leave the window. Returns whether the window closes now.
    fn leaves(&mut self) -> bool {
        true
    }

    /// Whether the session has ended and the window is to close.
    fn is_over(&mut self) -> bool;
}

/// View that a content asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// View.
    pub view: View,
    /// FDI number of the tooth in its middle; `None`: the usual one.
    pub tooth: Option<u8>,
    /// Magnification.
    pub zoom: f64,
}

/// Act of the person at the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Key of a finding.
    Reading(Key),
    /// Pause of the student, or its end.
    Pause,
    /// Another view.
    View(View),
    /// The camera has come to rest: turn to the right and tilt upwards, radians, and magnification.
    Camera {
        /// Turn to the right, radians.
        turn: f64,
        /// Tilt upwards, radians.
        tilt: f64,
        /// Magnification.
        zoom: f64,
    },
    /// Patient's head turned or tilted.
    Head(Head),
    /// Panel shown or hidden.
    Panel(bool),
    /// Blood wiped away.
    Wipe,
    /// Start of the force of a haptic device, in place of a button of the device.
    StartForce,
}

impl Act {
    /// Kind and JSON of the act as an event of a recording; `None` for an act that has an event of its own or none.
    pub fn event(&self) -> Option<(&'static str, String)> {
        let rounded = |x: f64| (x * 1e4).round() / 1e4;
        let data = match self {
            Self::Reading(_) | Self::Pause | Self::StartForce => return None,
            Self::View(view) => serde_json::json!({ "view": view.name() }),
            Self::Camera { turn, tilt, zoom } => serde_json::json!({
                "turn_rad": rounded(*turn), "tilt_rad": rounded(*tilt), "zoom": rounded(*zoom)
            }),
            Self::Head(head) => serde_json::json!({
                "head_turn_deg": head.turn_deg(), "head_tilt_deg": head.tilt_deg()
            }),
            Self::Panel(shown) => serde_json::json!({ "panel": shown }),
            Self::Wipe => serde_json::json!({ "wiped": true }),
        };
        Some((SCREEN, data.to_string()))
    }
}

/// Kind of the events of a screen.
pub const SCREEN: &str = "screen";
