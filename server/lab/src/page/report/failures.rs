//! Bounds that do not hold, in words.

use crate::report::Report;

/// All bounds that do not hold: of hard cases, random poses, links, the hour at rest, real devices, and ratios to other
/// engines.
pub(crate) fn failures(report: &Report) -> Vec<String> {
    let rows = report.rows.iter().filter(|row| row.status == "broken");
    let rows = rows.map(|row| {
        let what = row.broken.first().map_or("", String::as_str);
        format!("{} ({}): {what}", row.case, row.solver)
    });
    let rough = report.random_poses.iter().filter(|r| !r.holds());
    let rough = rough.map(|r| {
        format!(
            "random poses, {}: {} not finite, {} faults, residual {:.2} µm, click {:.3} N, {:.1} % outrun, {:.0} µm deep meanwhile",
            r.scene,
            r.not_finite,
            r.faults,
            r.residual_um,
            r.slow_force_step_n,
            r.exhausted_percent,
            r.exhausted_residual_um
        )
    });
    let loops = report.passivity.loops.iter().filter(|l| !l.passive);
    let loops = loops.map(|l| {
        format!(
            "{} over a link of {} ms puts out {:.2} mJ",
            l.case, l.delay_ms, l.energy_controlled_mj
        )
    });
    let hours = report.passivity.hours.iter().filter(|hour| !hour.holds());
    let hours =
        hours.map(|hour| format!("{} drifts by {:.2} µm at rest", hour.case, hour.drift_um));
    let devices = report.devices.iter().filter(|one| !one.holds());
    let devices = devices.map(|one| {
        format!(
            "{} in the hand swings by {:.3} N above 20 Hz at rest in {}",
            one.device, one.buzz_n, one.case
        )
    });
    let peers = report.peers.iter().flat_map(|peers| {
        let ratios = peers["ratios"].as_array().cloned().unwrap_or_default();
        ratios.into_iter().filter(|ratio| ratio["holds"] == false)
    });
    let peers = peers.map(|ratio| {
        let name = ratio["name"].as_str().unwrap_or_default();
        format!(
            "beside its peers, {name}: {:.2}, asked {:.2} at least",
            ratio["value"].as_f64().unwrap_or(f64::NAN),
            ratio["at_least"].as_f64().unwrap_or(f64::NAN)
        )
    });
    let all = rows.chain(rough).chain(loops).chain(hours).chain(devices);
    all.chain(peers).collect()
}
