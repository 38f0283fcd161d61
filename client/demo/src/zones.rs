//! Entries of a hand into a heavier zone of force in a pocket, as lines for a person.

use sulcus_core::TickOutput;
use sulcus_core::output::{ForceZone, PocketReading};

/// Slots and readings of the tools that entered a heavier zone of force in this tick.
pub fn entered(output: &TickOutput) -> impl Iterator<Item = (usize, PocketReading)> + '_ {
    let readings = output.tools.iter().enumerate();
    readings.filter_map(|(tool, out)| {
        let reading = out.pocket.filter(|reading| reading.entered_zone)?;
        Some((tool, reading))
    })
}

/// Line for a person: time of the session, seconds, force on the floor, newtons, and meaning of the zone.
pub fn zone_line(seconds: f64, reading: &PocketReading) -> String {
    let what = match reading.zone {
        ForceZone::Light => "light again",
        ForceZone::TooHeavy => "too heavy: reads too deep",
        ForceZone::Trauma => "trauma: healthy tissue bleeds",
        ForceZone::Damage => "DAMAGE",
    };
    format!(
        "{:8.3} s  {:.2} N on the floor, {what}",
        seconds, reading.floor_force
    )
}
