//! Input of a window: keys and mouse for the hands, 3D mouse, gamepad, and the pedal of the readings.

use std::sync::Arc;
use std::time::Instant;

use winit::event::MouseButton;
use winit::keyboard::{Key as WindowKey, KeyCode, PhysicalKey};

use crate::camera::Camera;
use crate::hand::keys::Control;
use crate::hand::pad::PadEvent;
use crate::hand::spacenav::{CapRule, Event};
use crate::hand::{Board, Frame, Motion, Shared};
use crate::handed::Handed;
use crate::readings::{Foot, Key, MouseSwitch, Switch};

/// Hands of a window, with the state of its keys.
pub(crate) struct HandsInput {
    shared: Arc<Shared>,
    board: Board,
    cap: Option<Cap>,
}

/// 3D mouse.
struct Cap {
    source: Source,
    rule: CapRule,
}

/// Way of a 3D mouse into the program.
enum Source {
    #[cfg(unix)]
    Daemon(crate::hand::spacenav::Socket),
    #[cfg(feature = "hid")]
    Hid(crate::hand::spacenav::Hid),
    #[cfg(not(any(unix, feature = "hid")))]
    None(std::convert::Infallible),
}

impl Source {
    /// 3D mouse of spacenavd if it runs, else the first one that the system lets this program read.
    fn find() -> Option<Self> {
        #[cfg(unix)]
        {
            use crate::hand::spacenav::{Socket, path};
            let path = path(std::env::var_os("SPNAV_SOCKET").as_deref());
            if let Ok(socket) = Socket::connect(&path) {
                tracing::info!("3D mouse by spacenavd");
                return Some(Self::Daemon(socket));
            }
        }
        #[cfg(feature = "hid")]
        if let Some(hid) = crate::hand::spacenav::Hid::open() {
            tracing::info!("3D mouse by USB HID");
            return Some(Self::Hid(hid));
        }
        None
    }

    fn events(&mut self) -> Result<Vec<Event>, String> {
        match self {
            #[cfg(unix)]
            Self::Daemon(socket) => socket.events().map_err(|lost| lost.to_string()),
            #[cfg(feature = "hid")]
            Self::Hid(hid) => hid.events(),
            #[cfg(not(any(unix, feature = "hid")))]
            Self::None(never) => match *never {},
        }
    }
}

impl HandsInput {
    /// Input for hands, with a 3D mouse if there is one.
    pub fn new(shared: Arc<Shared>) -> Self {
        let rule = CapRule::default();
        Self {
            shared,
            board: Board::new(),
            cap: Source::find().map(|source| Cap { source, rule }),
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
        let (events, lost) = match cap.source.events() {
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

    /// Takes an event of a gamepad.
    pub fn pad(&mut self, event: &PadEvent) {
        let board = &mut self.board;
        self.shared.feed(|hands| board.pad(event, hands));
    }

    /// Releases all keys, as for a window that lost the focus.
    pub fn let_go(&mut self) {
        let board = &mut self.board;
        self.shared.feed(|hands| board.let_go(hands));
    }
}

/// Control of a key by its place on the keyboard; `None` for a key that never belongs to the hands.
///
/// The letters lie under the hand without the mouse: I, J, K, L, U and O for a person with the mouse in the left hand.
pub(crate) fn of_key(key: PhysicalKey, mouse: Handed) -> Option<Control> {
    let PhysicalKey::Code(code) = key else {
        return None;
    };
    let letter = match (mouse, code) {
        (Handed::Right, KeyCode::KeyW) | (Handed::Left, KeyCode::KeyI) => Some(Control::W),
        (Handed::Right, KeyCode::KeyS) | (Handed::Left, KeyCode::KeyK) => Some(Control::S),
        (Handed::Right, KeyCode::KeyA) | (Handed::Left, KeyCode::KeyJ) => Some(Control::A),
        (Handed::Right, KeyCode::KeyD) | (Handed::Left, KeyCode::KeyL) => Some(Control::D),
        (Handed::Right, KeyCode::KeyQ) | (Handed::Left, KeyCode::KeyU) => Some(Control::Q),
        (Handed::Right, KeyCode::KeyE) | (Handed::Left, KeyCode::KeyO) => Some(Control::E),
        _ => None,
    };
    letter.or_else(|| named_control(code))
}

/// Control of a key without a letter.
fn named_control(code: KeyCode) -> Option<Control> {
    Some(match code {
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

/// Pedal of a window, with a clock of its own.
pub(crate) struct PedalInput {
    foot: Foot,
    begin: Instant,
}

impl PedalInput {
    /// Pedal that is up.
    pub fn new(foot: Foot) -> Self {
        Self {
            foot,
            begin: Instant::now(),
        }
    }

    /// Takes a press or a release. Returns whether the switch is the pedal's.
    pub fn change(&mut self, switch: &Switch, is_down: bool) -> bool {
        let now = self.now_ms();
        self.foot.change(switch, is_down, now)
    }

    /// Keys of a group that has ended.
    pub fn wait(&mut self) -> Vec<Key> {
        let now = self.now_ms();
        self.foot.wait(now)
    }

    /// Forgets presses whose release would not come.
    pub fn let_go(&mut self) {
        self.foot.let_go();
    }

    fn now_ms(&self) -> u64 {
        self.begin.elapsed().as_millis() as u64
    }
}

/// Switch of a key; `None` for a key without a character or a name.
pub(crate) fn switch_of_key(key: &WindowKey) -> Option<Switch> {
    match key {
        // The names of winit are those of the W3C.
        WindowKey::Named(named) => Some(Switch::Key(format!("{named:?}").to_lowercase())),
        WindowKey::Character(text) => Some(Switch::Key(text.to_lowercase())),
        _ => None,
    }
}

/// Switch of a function key by its place on the keyboard; `None` for any other key.
pub(crate) fn switch_of_code(key: PhysicalKey) -> Option<Switch> {
    let PhysicalKey::Code(code) = key else {
        return None;
    };
    let name = format!("{code:?}");
    let number = name.strip_prefix('F')?;
    let is_function = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_function.then(|| Switch::Key(name.to_lowercase()))
}

/// Switch of a mouse button; `None` for a button beyond the fifth.
pub(crate) fn switch_of_button(button: MouseButton) -> Option<Switch> {
    let button = match button {
        MouseButton::Left => MouseSwitch::Left,
        MouseButton::Right => MouseSwitch::Right,
        MouseButton::Middle => MouseSwitch::Middle,
        MouseButton::Back => MouseSwitch::Back,
        MouseButton::Forward => MouseSwitch::Forward,
        MouseButton::Other(_) => return None,
    };
    Some(Switch::Mouse(button))
}

/// Gamepads of a window; none in a build without the feature `gamepad`.
pub(crate) struct PadsInput {
    #[cfg(all(feature = "gamepad", target_os = "linux"))]
    pads: Option<crate::hand::pad::Pads>,
}

impl PadsInput {
    /// Gamepads, if a hand or a pedal takes their events.
    #[cfg_attr(
        not(all(feature = "gamepad", target_os = "linux")),
        allow(unused_variables)
    )]
    pub fn new(has_hands: bool, pedal: Option<&Foot>) -> Self {
        Self {
            #[cfg(all(feature = "gamepad", target_os = "linux"))]
            pads: {
                let is_pedal = pedal.is_some_and(|foot| matches!(foot.switch(), Switch::Pad(_)));
                (has_hands || is_pedal).then(crate::hand::pad::Pads::new)
            },
        }
    }

    /// Events since the previous call of this function.
    pub fn events(&mut self) -> Vec<PadEvent> {
        #[cfg(all(feature = "gamepad", target_os = "linux"))]
        return self
            .pads
            .as_mut()
            .map(crate::hand::pad::Pads::events)
            .unwrap_or_default();
        #[cfg(not(all(feature = "gamepad", target_os = "linux")))]
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use winit::keyboard::NamedKey;

    #[test]
    fn keys_of_the_window_are_the_switches_of_their_names() {
        for (name, key) in [
            ("F13", WindowKey::Named(NamedKey::F13)),
            ("PageDown", WindowKey::Named(NamedKey::PageDown)),
            ("ArrowLeft", WindowKey::Named(NamedKey::ArrowLeft)),
            ("Space", WindowKey::Named(NamedKey::Space)),
            ("ScrollLock", WindowKey::Named(NamedKey::ScrollLock)),
            ("AudioVolumeUp", WindowKey::Named(NamedKey::AudioVolumeUp)),
            ("b", WindowKey::Character("B".into())),
        ] {
            assert_eq!(switch_of_key(&key), Some(name.parse().expect("a switch")));
        }
        let back: Switch = "mouse-back".parse().expect("a switch");
        assert_eq!(switch_of_button(MouseButton::Back), Some(back));
    }

    #[test]
    fn letters_of_the_hands_lie_under_the_hand_without_the_mouse() {
        let of = |code, hand| of_key(PhysicalKey::Code(code), hand);
        assert_eq!(of(KeyCode::KeyA, Handed::Right), Some(Control::A));
        assert_eq!(of(KeyCode::KeyJ, Handed::Left), Some(Control::A));
        assert_eq!(of(KeyCode::KeyA, Handed::Left), None);
        assert_eq!(of(KeyCode::KeyJ, Handed::Right), None);
        for hand in Handed::ALL {
            assert_eq!(of(KeyCode::Space, hand), Some(Control::Space));
        }
    }
}
