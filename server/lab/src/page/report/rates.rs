//! The rates that the shipped scenes hold, in words.

use crate::report::Rate;

/// The rates tried, kilohertz.
pub(super) fn tried(rates: &[Rate]) -> String {
    let mut all: Vec<u16> = rates.iter().map(|rate| rate.rate_hz).collect();
    all.sort_unstable();
    all.dedup();
    let each: Vec<String> = all
        .iter()
        .map(|hz| format!("{}", f64::from(*hz) / 1e3))
        .collect();
    match each.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => each.concat(),
    }
}

/// Each shipped scene with the highest rate that it holds, kilohertz.
pub(super) fn held(rates: &[Rate]) -> String {
    let each = highest(rates)
        .into_iter()
        .map(|(scene, rate_hz)| match rate_hz {
            0 => format!("{scene} none"),
            _ => format!("{scene} {}", rate_hz / 1000),
        });
    each.collect::<Vec<_>>().join(", ")
}

/// Highest of the rates tried that each scene holds, hertz; 0 for none.
fn highest(rates: &[Rate]) -> Vec<(&'static str, u16)> {
    let mut held: Vec<(&'static str, u16)> = Vec::new();
    for rate in rates {
        let this = if rate.holds { rate.rate_hz } else { 0 };
        match held.iter_mut().find(|(scene, _)| *scene == rate.scene) {
            Some((_, most)) => *most = this.max(*most),
            None => held.push((rate.scene, this)),
        }
    }
    held
}
