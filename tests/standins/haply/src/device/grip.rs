//! Grip at run time.

use super::config::Config;
use super::motion::Turn;
use super::options::{Buttons, GripArray, GripOptions};
use crate::Quaternion;

/// Grip at run time.
#[derive(Debug)]
pub(crate) struct Grip {
    pub(crate) id: String,
    pub(crate) arrays: Vec<GripArray>,
    pub(crate) config: Config,
    pub(crate) connected: bool,
    pub(crate) awake: bool,
    /// Count of connections of the device; a link that knows an older one gets the config again.
    pub(crate) generation: u64,
    pub(crate) buttons: Buttons,
    pub(crate) shown_buttons: Buttons,
    pub(crate) orientation: Quaternion,
    turn: Turn,
    start_ns: u64,
    period_ns: f64,
}

impl Grip {
    /// Grip at its start.
    pub(crate) fn new(options: &GripOptions, now_ns: u64) -> Self {
        Self {
            id: options.id.clone(),
            arrays: options.arrays.clone(),
            config: Config::of_grip(&options.id),
            connected: options.connected,
            awake: options.awake,
            generation: 1,
            buttons: Buttons::default(),
            shown_buttons: Buttons::default(),
            orientation: options.turn.sample(0.0),
            turn: options.turn.clone(),
            start_ns: now_ns,
            period_ns: 1e9 / options.rate_hz.max(1e-3),
        }
    }

    /// Another rotation; its time starts now.
    pub(crate) fn set_turn(&mut self, turn: Turn, now_ns: u64) {
        self.turn = turn;
        self.start_ns = now_ns;
    }

    /// Moves the grip to a time; a sleeping grip stands still.
    pub(crate) fn advance(&mut self, now_ns: u64) {
        if !self.awake {
            return;
        }
        let since = now_ns.saturating_sub(self.start_ns) as f64;
        let sampled = (since / self.period_ns).floor() * self.period_ns;
        self.orientation = self.turn.sample(sampled * 1e-9);
        self.shown_buttons = self.buttons;
    }

    /// Charge of the battery, 0 to 1.
    pub(crate) fn battery(&self) -> f64 {
        0.8
    }
}
