//! Devices of a swarm: the hand of an exercise, or random leaps.

use sulcus_cases::fuzz;
use sulcus_connection::device::{DeviceEvent, EventDevice};
use sulcus_core::{MAX_TOOLS, Scene, ToolInput};
use sulcus_haptics::{HandSource, Shown};
use sulcus_operator::Script;
use sulcus_operator::present;

use crate::simulated::Simulated;

/// Exercise of a station with random leaps: the hard case in their scene.
pub(super) const LEAPS: &str = "hard/random-poses";

/// Number of poses, after which the walk begins anew.
const LENGTH: u64 = 60_000;

/// Poses of a random walk with leaps of up to 9 mm and 0.7 rad in one tick about a narrow pocket. No hand with mass
/// follows them: a device that sends such poses is broken, or its program is patched.
pub(super) struct Leaps {
    script: Box<dyn Script + Send>,
    periods: u64,
}

impl Leaps {
    /// Leaps in the scene of [`LEAPS`], which has 1000 ticks in a second.
    pub fn new(scene: &Scene, seed: u64) -> Self {
        Self {
            script: fuzz::POCKET.script(scene, seed, LENGTH),
            periods: 0,
        }
    }
}

/// Device of one station.
pub(super) enum Player {
    /// The hand of an exercise.
    Hand(Box<Simulated>),
    /// Random leaps.
    Leaps(Leaps),
}

impl HandSource for Player {
    fn name(&self) -> &str {
        match self {
            Self::Hand(hand) => hand.name(),
            Self::Leaps(_) => "random leaps",
        }
    }

    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        match self {
            Self::Hand(hand) => hand.exchange(shown),
            Self::Leaps(leaps) => {
                let targets = leaps.script.targets(leaps.periods as f64 * 1e-3);
                leaps.periods = (leaps.periods + 1) % LENGTH;
                targets.map(|pose| pose.map_or(ToolInput::ABSENT, |pose| present(&pose)))
            }
        }
    }

    fn is_done(&self) -> bool {
        match self {
            Self::Hand(hand) => hand.is_done(),
            Self::Leaps(_) => false,
        }
    }
}

impl EventDevice for Player {
    fn events(&mut self) -> Vec<DeviceEvent> {
        match self {
            Self::Hand(hand) => hand.events(),
            Self::Leaps(_) => Vec::new(),
        }
    }
}
