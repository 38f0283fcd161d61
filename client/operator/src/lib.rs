//! The simulated hand of the demo, the hard cases and the tests.
//!
//! A *script* gives target poses of a hand. The *hand* holds a *device* with mass and damping by a spring and a damper,
//! trembles at 8 to 12 Hz, and feels the wrench. The loop of hand, device and simulation is closed, so an unstable
//! simulation becomes visible. An operator is a function of its seed and of the wrenches and poses that it is shown.
//!
//! All units are SI, all axes are those of the world.

pub mod bands;
pub mod bimanual;
pub mod crown;
mod frame;
pub mod habit;
pub mod hand;
mod lean;
pub mod pocket_path;
pub mod retraction;
pub mod script;
mod shaft;
mod sounding;
mod stops;
pub mod tour;
pub mod tour_params;
mod travel;
pub mod tremor;
mod wall;

use sulcus_core::{MAX_TOOLS, Pose, ToolInput};

pub use habit::Habit;
pub use hand::{Hand, HandParams};
pub use script::{Call, Felt, Script};
pub use sulcus_haptics::{Shown, drawn};

/// A simulated person with up to two hands, who performs a script.
pub struct Operator {
    script: Box<dyn Script + Send>,
    hands: [Option<Hand>; MAX_TOOLS],
    params: HandParams,
    seed: u64,
    tick: u64,
}

impl Operator {
    /// An operator for `script`, with a tremor from `seed`.
    pub fn new(script: Box<dyn Script + Send>, params: HandParams, seed: u64) -> Self {
        Self {
            script,
            hands: [const { None }; MAX_TOOLS],
            params,
            seed,
            tick: 0,
        }
    }

    /// Largest length of the script, periods of the device.
    pub fn ticks(&self) -> u64 {
        (self.script.duration_s() * (1.0 / self.params.period_s)) as u64
    }

    /// Calls since the previous call of this function.
    pub fn calls(&mut self) -> Vec<Call> {
        self.script.calls()
    }

    /// Whether the script has finished all its tasks.
    pub fn is_done(&self) -> bool {
        self.script.is_done()
    }

    /// Advances one period of the device with the wrenches and graphic poses of `shown`. Returns the poses that the
    /// devices report; a slot without a target is absent.
    pub fn step(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        let t = self.tick as f64 * self.params.period_s;
        self.tick += 1;
        self.script.feel(&Felt {
            shown: *shown,
            hands: std::array::from_fn(|slot| self.hands[slot].as_ref().map(Hand::device)),
        });
        let targets = self.script.targets(t);
        std::array::from_fn(|slot| {
            let Some(target) = targets[slot] else {
                self.hands[slot] = None;
                return ToolInput::ABSENT;
            };
            let seed = self.seed.wrapping_mul(2).wrapping_add(slot as u64);
            let hand = self.hands[slot].get_or_insert_with(|| Hand::new(self.params, target, seed));
            let pose = hand.step(&target, &shown.wrenches[slot]);
            present(&pose)
        })
    }
}

/// A present tool at `pose`, rounded to f32 as on the wire.
pub fn present(pose: &Pose) -> ToolInput {
    ToolInput::at(pose)
}
