//! Coupling at which a loop begins to buzz.

use sulcus_haptics::{DeviceModel, PassivityParams};

use super::figures::Grip;
use super::{Looped, Rests, Setup, run};
use crate::table::Case;

/// Largest factor of the chosen coupling that is tried.
pub const LARGEST: f64 = 40.0;
/// Ratio of successive factors of the search from below.
const RATIO: f64 = 1.4;
/// Relative width at which the bisection ends.
const WIDTH: f64 = 0.05;

/// Begin of a buzz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// Loop at the chosen coupling.
    pub chosen: Looped,
    /// Smallest factor of the chosen coupling with a buzz, to 5 %; `None` for none up to [`LARGEST`].
    pub factor: Option<f64>,
    /// Loop at this factor, or at the largest factor without a buzz.
    pub at: Looped,
}

/// Searches the coupling at which `case` begins to buzz in the hand of a device, for a light and a firm grip and all
/// moments of rest, on a link without delay. Factors rise from 1 by a ratio of 1.4 up to the first buzz; a bisection
/// follows. A rest of one kind would not do: friction holds a handle at a place without a contact, and nothing swings.
///
/// `controlled` tells whether the door has its passivity controller. A door with the controller keeps a coupling quiet
/// that the device cannot display, and takes the force instead.
pub fn onset(case: &Case, model: &DeviceModel, controlled: bool) -> Onset {
    let rests = Rests::of(case);
    let at = |factor: f64| loudest(case, (model, controlled), &rests, factor);
    let chosen = at(1.0);
    let (mut quiet, mut factor, mut found) = (0.0, 1.0, chosen);
    while !found.buzzes() {
        if factor >= LARGEST {
            return Onset {
                chosen,
                factor: None,
                at: found,
            };
        }
        quiet = factor;
        factor = (factor * RATIO).min(LARGEST);
        found = at(factor);
    }
    while quiet > 0.0 && factor > quiet * (1.0 + WIDTH) {
        let middle = (quiet * factor).sqrt();
        let there = at(middle);
        if there.buzzes() {
            (factor, found) = (middle, there);
        } else {
            quiet = middle;
        }
    }
    Onset {
        chosen,
        factor: Some(factor),
        at: found,
    }
}

/// Loudest loop at `factor`, or the first loop with a buzz. Without a buzz this is the loop with the largest force, which
/// shows that the loop was closed.
fn loudest(
    case: &Case,
    (model, controlled): (&DeviceModel, bool),
    rests: &Rests,
    factor: f64,
) -> Looped {
    let observing = PassivityParams {
        period_s: 1.0 / model.rate_hz.value,
        ..PassivityParams::observing()
    };
    let mut most = Looped::default();
    for grip in [Grip::Firm, Grip::Light] {
        for rest in 0..3 {
            let setup = Setup {
                factor,
                grip,
                passivity: (!controlled).then_some(observing),
                ..Setup::nominal(model)
            };
            let found = run(case, &setup, rests.nth(rest));
            if found.buzzes() {
                return found;
            }
            let buzz_n = most.buzz_n.max(found.buzz_n);
            if found.force_n >= most.force_n {
                most = found;
            }
            most.buzz_n = buzz_n;
        }
    }
    most
}
