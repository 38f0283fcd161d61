//! Loops of a case with figures that are 30 % off.

use sulcus_haptics::DeviceModel;

use super::figures::{Grip, Variation};
use super::{Looped, Rests, Setup, run};
use crate::table::Case;

/// One loop of a sweep.
#[derive(Clone, Copy, Debug)]
pub struct Swept<'a> {
    /// Loop.
    pub setup: Setup<'a>,
    /// Moment of the rest: 0 hardest, 1 working, 2 light.
    pub rest: u32,
    /// Result.
    pub found: Looped,
}

impl Swept<'_> {
    /// The loop in words.
    pub fn said(&self, case: &Case) -> String {
        let Self { setup, rest, found } = self;
        format!(
            "{} in {}, rest {rest}, {:?}, {} ticks, {:?}: {:.4} N at {:.0} Hz, {found:?}",
            setup.model.name,
            case.name,
            setup.grip,
            setup.delay_ticks,
            setup.variation,
            found.buzz_n,
            found.hertz
        )
    }
}

/// Runs loop `k` of a sweep. Moment of rest, delay of the link and grip rotate with `k`, with periods of 3, 9 and 2: each
/// combination occurs once in 18 loops.
pub fn loop_of<'a>(
    case: &Case,
    rests: &Rests,
    model: &'a DeviceModel,
    variation: Variation,
    k: u32,
) -> Swept<'a> {
    let grip = if k.is_multiple_of(2) {
        Grip::Light
    } else {
        Grip::Firm
    };
    let setup = Setup {
        variation,
        grip,
        delay_ticks: k / 3 % 3,
        ..Setup::nominal(model)
    };
    let rest = k % 3;
    Swept {
        setup,
        rest,
        found: run(case, &setup, rests.nth(rest)),
    }
}

/// Runs all 16 corners of mass, damping, latency and friction, each off by 30 %. `number` is that of the case: it turns
/// the rotation of rest, delay and grip, so that a corner meets each of them over the cases.
pub fn corners<'a>(
    case: &Case,
    number: u32,
    rests: &Rests,
    model: &'a DeviceModel,
) -> Vec<Swept<'a>> {
    (0..Variation::CORNERS)
        .map(|bits| {
            loop_of(
                case,
                rests,
                model,
                Variation::corner(bits),
                bits + 5 * number,
            )
        })
        .collect()
}
