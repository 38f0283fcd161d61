//! Pocket reading of a tool, and its force zone on the floor.

use super::{Gingiva, GingivaParams, MEMORY};
use crate::MAX_TOOLS;
use crate::math::{Vec3, fmax};
use crate::output::{ForceZone, PocketReading};
use crate::scene::params::within;
use crate::tissue::Hands;

/// Length of the memory of one tool: floor force (N), force zone (0 to 3), flag of an entry into the zone in this tick.
const PER_TOOL: usize = MEMORY / MAX_TOOLS;

/// Returns the zone at a floor force of `newtons`, given the zone `before`. A zone is entered at its threshold and left
/// below `rearm` times the threshold.
pub fn zone_after(params: &GingivaParams, before: ForceZone, newtons: f64) -> ForceZone {
    let zones = ForceZone::ALL[1..].iter().zip(params.thresholds());
    zones.fold(ForceZone::Light, |zone, (&heavier, threshold)| {
        let held = before >= heavier && newtons >= params.rearm * threshold;
        if newtons >= threshold || held {
            heavier
        } else {
            zone
        }
    })
}

fn zone_of(number: f64) -> ForceZone {
    ForceZone::ALL
        .into_iter()
        .find(|zone| f64::from(*zone as u8) == number)
        .unwrap_or_default()
}

/// Writes the `memory` of all tools after a tick: floor force, zone and entry flag. `pressed` is the force of each tool
/// on the floor, newtons; a negative force counts as 0.
pub fn remember(params: &GingivaParams, pressed: &[f64; MAX_TOOLS], memory: &mut [f64]) {
    for (memory, pressed) in memory.chunks_exact_mut(PER_TOOL).zip(pressed) {
        let force = fmax(0.0, *pressed);
        let before = zone_of(memory[1]);
        let after = zone_after(params, before, force);
        memory[0] = force;
        memory[1] = f64::from(after as u8);
        memory[2] = f64::from(u8::from(after > before));
    }
}

/// Tip of a tool below the gingival margin.
pub struct Tip {
    /// Position of the tip, world axes, metres.
    pub point: Vec3,
    /// Angle about the tooth, radians from mesial over buccal, -pi to pi.
    pub around: f64,
    depth: f64,
}

/// Returns position, angle and depth of the tip of the tool in `slot` at the graphic pose. Returns `None` if the tip is
/// not below the margin, or outside the ball (centre and radius, metres) that bounds the gingiva at rest.
pub fn tip_below_margin(
    model: &Gingiva,
    slot: usize,
    hands: &Hands<'_>,
    (centre, radius): (&Vec3, f64),
) -> Option<Tip> {
    let hand = hands.tools.get(slot)?.as_ref()?;
    let point = hand.graphic.transform(&hand.tool.tip);
    let from = point - centre;
    // A NaN counts as outside the ball.
    if !within(from.dot(&from), 0.0, radius * radius) {
        return None;
    }
    let (around, height) = model.tooth.cylindrical(&point);
    let depth = model.margin_at(around) - height;
    (depth > 0.0).then_some(Tip {
        point,
        around,
        depth,
    })
}

/// Returns the reading of the tool in `slot`, whose tip is in the pocket. `memory` holds the numbers of all tools. The
/// object's index is 0 until the tick writes it.
pub fn reading(tip: &Tip, slot: usize, memory: &[f64]) -> PocketReading {
    let memory = &memory[slot * PER_TOOL..(slot + 1) * PER_TOOL];
    PocketReading {
        // The tick writes the index of the object.
        object: 0,
        around: tip.around,
        depth: tip.depth,
        floor_force: memory[0],
        zone: zone_of(memory[1]),
        entered_zone: memory[2] == 1.0,
    }
}
