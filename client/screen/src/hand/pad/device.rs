//! Gamepad of the system, read without waiting. Only this file names `evdev`.

use std::io::ErrorKind;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use evdev::{Device, KeyCode};

use super::{Pad, PadAxis, PadEvent};
use crate::hand::sticks::Sticks;

/// Gamepad that is open, with its state.
type Open = (Device, Pad);

/// Time between two searches for a gamepad.
const SEARCH: Duration = Duration::from_secs(3);

/// First gamepad of the system, if there is one. A gamepad that is plugged in later is found within three seconds.
pub struct Pads {
    open: Option<Open>,
    /// Buttons that are down.
    down: Vec<super::PadButton>,
    /// Time of the next search.
    search: Instant,
    /// Search under way. It opens every input device, which may take longer than a frame.
    searching: Option<JoinHandle<Option<Open>>>,
}

impl Default for Pads {
    fn default() -> Self {
        Self::new()
    }
}

impl Pads {
    /// Gamepads before the first search.
    pub fn new() -> Self {
        Self {
            open: None,
            down: Vec::new(),
            search: Instant::now(),
            searching: None,
        }
    }

    /// Takes the gamepad of a finished search, and begins the next search in a thread of its own.
    fn look(&mut self) {
        if self.searching.as_ref().is_some_and(JoinHandle::is_finished) {
            let found = self.searching.take().map(JoinHandle::join);
            self.open = found.and_then(Result::ok).flatten();
        }
        if self.open.is_none() && self.searching.is_none() && Instant::now() >= self.search {
            self.search = Instant::now() + SEARCH;
            let thread = std::thread::Builder::new().name("sulcus-gamepad".into());
            self.searching = thread.spawn(find).ok();
        }
    }

    /// Events since the previous call of this function. The call never waits. A gamepad that is gone releases its
    /// sticks and buttons.
    pub fn events(&mut self) -> Vec<PadEvent> {
        if self.open.is_none() {
            self.look();
        }
        let Some((device, pad)) = &mut self.open else {
            return Vec::new();
        };
        let mut events = Vec::new();
        let lost = match device.fetch_events() {
            Ok(fetched) => {
                for event in fetched {
                    let (kind, number) = (event.event_type().0, event.code());
                    pad.feed(kind, number, event.value(), &mut events);
                }
                None
            }
            Err(error) => Some(error).filter(|error| {
                !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
            }),
        };
        for event in &events {
            match event {
                PadEvent::Button(button, true) => self.down.push(*button),
                PadEvent::Button(button, false) => self.down.retain(|down| down != button),
                PadEvent::Sticks(_) => {}
            }
        }
        if let Some(error) = lost {
            tracing::warn!("the gamepad is gone: {error}");
            self.open = None;
            events.push(PadEvent::Sticks(Sticks::default()));
            let down = std::mem::take(&mut self.down);
            events.extend(
                down.into_iter()
                    .map(|button| PadEvent::Button(button, false)),
            );
        }
        events
    }
}

/// First device with the lower button of a gamepad, ready to be read.
fn find() -> Option<Open> {
    let is_pad = |device: &Device| {
        let keys = device.supported_keys();
        keys.is_some_and(|keys| keys.contains(KeyCode::BTN_SOUTH))
    };
    let (_, device) = evdev::enumerate().find(|(_, device)| is_pad(device))?;
    device.set_nonblocking(true).ok()?;
    let axes = device.get_absinfo().ok()?.map(|(axis, info)| PadAxis {
        number: axis.0,
        value: info.value(),
        range: [info.minimum(), info.maximum()],
    });
    let pad = Pad::new(axes);
    tracing::info!("gamepad: {}", device.name().unwrap_or("without a name"));
    Some((device, pad))
}
