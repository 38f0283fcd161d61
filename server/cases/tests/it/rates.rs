//! The rate is a parameter: the same scenes under the same hands at 1, 2 and 4 kHz.

use sulcus_cases::{find, run_at};
use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, Params};

/// Asserts that every bound of these cases holds at these rates, and that no force clicks.
pub fn hold(cases: &[&str], rates_hz: &[u16]) {
    let mut broken = Vec::new();
    for name in cases {
        let case = find(name).expect("in the table");
        for &rate_hz in rates_hz {
            let limit = Params::default().max_settle_step * 1e3 / f64::from(rate_hz);
            let report = run_at(case, rate_hz, |_| (), |_| ());
            let m = &report.measures;
            println!(
                "{name:18} {rate_hz} Hz: residual {:.3} um, click {:.2} mN, buzz {:.4} N, exhausted {} of {}, raw {:.2} N",
                m.residual * 1e6,
                m.slow_force_step * 1e3,
                m.buzz,
                m.exhausted,
                m.ticks,
                m.max_raw_force,
            );
            let said = report.broken.into_iter();
            broken.extend(said.map(|what| format!("{name} at {rate_hz} Hz: {what}")));
            if m.slow_force_step > limit + 1e-9 {
                broken.push(format!(
                    "{name} at {rate_hz} Hz: clicks by {} N",
                    m.slow_force_step
                ));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn every_bound_of_a_rigid_and_a_soft_case_holds_at_4_khz() {
    hold(&["thin-plate-2", "pocket-0.4"], &[4000]);
}

/// Force on the hands at every millisecond, newtons.
fn forces(name: &str, rate_hz: u16) -> Vec<[f64; MAX_TOOLS]> {
    let case = find(name).expect("in the table");
    let mut forces = Vec::new();
    let every = u64::from(rate_hz / 1000);
    run_at(
        case,
        rate_hz,
        |_| (),
        |seen| {
            if seen.output.tick.is_multiple_of(every) {
                let tools = &seen.output.tools;
                forces.push(std::array::from_fn(|t| norm(&tools[t].wrench.force)));
            }
        },
    );
    forces
}

/// Asserts that a press gives the same forces at these rates as at 1 kHz, to 2 % of the largest.
pub fn feels_the_same(name: &str, rates_hz: &[u16]) {
    // A closed loop, pressed slowly: the rest of the difference is the tremor's and the loop's own.
    let slow = forces(name, 1000);
    let scale = slow.iter().flatten().fold(0.0, |a: f64, b| a.max(*b));
    for &rate_hz in rates_hz {
        let fast = forces(name, rate_hz);
        let pairs = slow.iter().flatten().zip(fast.iter().flatten());
        let squares: f64 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
        let off = (squares / slow.len() as f64).sqrt() / scale;
        println!(
            "{name} at {rate_hz} Hz: {:.3} % of {scale:.2} N",
            off * 100.0
        );
        assert!(scale > 0.05 && off < 0.02, "{name} at {rate_hz} Hz: {off}");
    }
}

#[test]
fn a_press_feels_the_same_at_2_khz() {
    feels_the_same("pocket-0.5", &[2000]);
}
