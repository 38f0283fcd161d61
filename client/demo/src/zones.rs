//! Hands that become too heavy in a pocket, as a line for people.

use sulcus_core::TickOutput;
use sulcus_core::output::{ForceZone, PocketReading};

/// The readings of tools that entered a heavier zone of force in this tick.
pub fn entered(output: &TickOutput) -> impl Iterator<Item = (usize, PocketReading)> + '_ {
    let readings = output.tools.iter().enumerate();
    readings.filter_map(|(tool, out)| {
        let reading = out.pocket.filter(|reading| reading.entered_zone)?;
        Some((tool, reading))
    })
}

/// One line for people.
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
