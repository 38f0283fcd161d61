//! The simulated hand: used by the demo, the hard cases and the tests.
//!
//! A *script* says where the hand means to be. The *hand* holds a *device* (mass, damping) by a
//! spring and a damper, trembles at 8 to 12 Hz, and feels the wrench: so the loop of hand, device
//! and simulation is closed, and an unstable simulation shows. Everything depends on the seed and
//! the wrenches alone.
//!
//! SI units, world axes.

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

/// A person with up to two hands, performing a script.
pub struct Operator {
    script: Box<dyn Script + Send>,
    hands: [Option<Hand>; MAX_TOOLS],
    params: HandParams,
    seed: u64,
    tick: u64,
}

impl Operator {
    /// An operator who performs `script`; the tremor comes from `seed`.
    pub fn new(script: Box<dyn Script + Send>, params: HandParams, seed: u64) -> Self {
        Self {
            script,
            hands: [const { None }; MAX_TOOLS],
            params,
            seed,
            tick: 0,
        }
    }

    /// Length of the script in ticks.
    pub fn ticks(&self) -> u64 {
        (self.script.duration_s() * (1.0 / self.params.period_s)) as u64
    }

    /// The depths called since this was last asked.
    pub fn calls(&mut self) -> Vec<Call> {
        self.script.calls()
    }

    /// Whether the script has nothing left to do before its time is up.
    pub fn is_done(&self) -> bool {
        self.script.is_done()
    }

    /// Advances one period of the device under what the simulation shows, and returns the poses that the devices report.
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

/// A present tool at `pose`, as the wire would carry it.
pub fn present(pose: &Pose) -> ToolInput {
    ToolInput::at(pose)
}
