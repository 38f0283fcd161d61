//! Panel of the student's screen, as a list of rectangles and lines of text. No graphics adapter is needed.
//!
//! Practice shows all helps: force against the zone of the exercise, depth, next step. An exam shows what a clinic
//! would: time, site to be read, own findings. Link, recording, pause and force limit are always shown.
//!
//! ```
//! use sulcus_screen::panel::{PanelState, layout};
//! use sulcus_screen::strings::ENGLISH;
//!
//! let list = layout(&PanelState::default(), [1280, 720], 1.0, &ENGLISH).list;
//! assert!(!list.is_empty());
//! ```

mod canvas;
mod colour;
mod end;
mod exam;
mod gauge;
mod lesson;
mod mark;
mod next;
mod practice;
mod primitive;
mod state;
mod status;
#[cfg(test)]
mod tests;
mod trace;
mod words;

pub use canvas::Area;
pub use colour::Rgba;
pub use end::{End, end};
pub use lesson::lesson;
pub use next::Next;
pub use primitive::{Primitive, Quad, quads, used};
pub use state::{
    CONTACT_N, Clock, Detail, Help, Link, Mode, PanelState, Rating, Recording, Status, ToolForce,
    Tour, Warning,
};
pub use trace::{Trace, VALUES};

use crate::strings::Strings;
use canvas::Canvas;

/// Panel of one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Primitives; later ones cover earlier ones.
    pub list: Vec<Primitive>,
    /// Part of the window that the panel leaves free, without notices: the place of the picture's subject.
    pub free: Area,
}

/// Panel for a window of `window` physical pixels, width and height, on a display with the scale factor `scale`.
///
/// All primitives lie inside the window, and no two texts overlap. Parts that find no room are left out, status last.
pub fn layout(state: &PanelState, window: [u32; 2], scale: f32, strings: &Strings) -> Panel {
    let (mut canvas, whole) = Canvas::over(window, scale);
    let free = match state.mode {
        Mode::Practice => practice::practice(&mut canvas, whole, state, strings),
        Mode::Exam => {
            let tour = state.tour.as_ref();
            exam::exam(
                &mut canvas,
                whole,
                &state.clock,
                tour,
                &state.status,
                strings,
            )
        }
    };
    let mut notices = free.inset(canvas.metrics.pad);
    status::banner(&mut canvas, &mut notices, &state.status, strings);
    status::warnings(&mut canvas, &mut notices, &state.status, strings);
    Panel {
        list: canvas.list,
        free,
    }
}
