//! Input of a window for the hands: keys, mouse and 3D mouse.

use std::sync::Arc;

use winit::event::MouseButton;
use winit::keyboard::{KeyCode, PhysicalKey};

use crate::camera::Camera;
use crate::hand::keys::Control;
use crate::hand::spacenav::{CapRule, Socket};
use crate::hand::{Board, Frame, Motion, Shared};

/// Hands of a window, with the state of its keys.
pub(crate) struct HandsInput {
    shared: Arc<Shared>,
    board: Board,
    cap: Option<Cap>,
}

/// 3D mouse.
struct Cap {
    socket: Socket,
    rule: CapRule,
}

impl HandsInput {
    /// Input for hands, with the 3D mouse of spacenavd if one runs.
    pub fn new(shared: Arc<Shared>) -> Self {
        let path = crate::hand::spacenav::path(std::env::var_os("SPNAV_SOCKET").as_deref());
        let socket = Socket::connect(&path);
        if socket.is_ok() {
            tracing::info!("3D mouse by spacenavd");
        }
        let rule = CapRule::default();
        Self {
            shared,
            board: Board::new(),
            cap: socket.ok().map(|socket| Cap { socket, rule }),
        }
    }

    /// Whether the mouse moves the camera, not the tool.
    pub fn is_open(&self) -> bool {
        self.shared.feed(|hands| hands.is_open())
    }

    /// Takes a press or a release. Returns whether it belongs to the hands.
    pub fn control(&mut self, control: Control, is_pressed: bool) -> bool {
        let board = &mut self.board;
        self.shared.feed(|hands| {
            if is_pressed {
                return board.press(control, hands);
            }
            board.release(control, hands);
            false
        })
    }

    /// Takes a motion of the mouse, counts to the right and downwards.
    pub fn mouse(&self, right: f64, down: f64) {
        self.shared
            .feed(|hands| self.board.mouse(right, down, hands));
    }

    /// Takes notches of the wheel. Returns whether they belong to the hands.
    pub fn wheel(&self, notches: f64) -> bool {
        self.shared.feed(|hands| {
            let is_closed = !hands.is_open();
            if is_closed {
                self.board.wheel(notches, hands);
            }
            is_closed
        })
    }

    /// Takes the camera of the newest picture, in whose directions the hands move, and what the 3D mouse has sent.
    pub fn look(&mut self, camera: &Camera) {
        let frame = Frame::of(camera);
        self.shared.feed(|hands| hands.look(frame));
        let Some(cap) = &mut self.cap else { return };
        let (events, lost) = match cap.socket.events() {
            Ok(events) => (events, None),
            Err(lost) => (Vec::new(), Some(lost)),
        };
        let (board, rule) = (&mut self.board, &cap.rule);
        self.shared.feed(|hands| {
            events
                .iter()
                .for_each(|event| rule.act(event, board, hands))
        });
        if let Some(lost) = lost {
            tracing::warn!("the 3D mouse is gone: {lost}");
            self.shared
                .feed(|hands| self.board.cap(&Motion::none(), hands));
            self.cap = None;
        }
    }

    /// Releases all keys, as for a window that lost the focus.
    pub fn let_go(&mut self) {
        let board = &mut self.board;
        self.shared.feed(|hands| board.let_go(hands));
    }
}

/// Control of a key by its place on the keyboard; `None` for a key that never belongs to the hands.
pub(crate) fn of_key(key: PhysicalKey) -> Option<Control> {
    let PhysicalKey::Code(code) = key else {
        return None;
    };
    Some(match code {
        KeyCode::KeyW => Control::W,
        KeyCode::KeyS => Control::S,
        KeyCode::KeyA => Control::A,
        KeyCode::KeyD => Control::D,
        KeyCode::KeyQ => Control::Q,
        KeyCode::KeyE => Control::E,
        KeyCode::ArrowUp => Control::ArrowUp,
        KeyCode::ArrowDown => Control::ArrowDown,
        KeyCode::ArrowLeft => Control::ArrowLeft,
        KeyCode::ArrowRight => Control::ArrowRight,
        KeyCode::PageUp => Control::PageUp,
        KeyCode::PageDown => Control::PageDown,
        KeyCode::ShiftLeft | KeyCode::ShiftRight => Control::Shift,
        KeyCode::ControlLeft | KeyCode::ControlRight => Control::Ctrl,
        KeyCode::Space => Control::Space,
        KeyCode::Tab => Control::Tab,
        KeyCode::Home => Control::Home,
        KeyCode::Insert => Control::Insert,
        _ => return None,
    })
}

/// Control of a mouse button.
pub(crate) fn of_button(button: MouseButton) -> Option<Control> {
    match button {
        MouseButton::Left => Some(Control::LeftButton),
        MouseButton::Right => Some(Control::RightButton),
        _ => None,
    }
}
