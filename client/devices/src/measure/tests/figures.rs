use sulcus_core::Vec3;
use sulcus_haptics::model::Source;

use super::device::{Hand, Truth, stiffest, truth};
use super::person::{Bench, plan};
use crate::measure::{Measured, Prompt, Value};

fn near(name: &str, found: f64, expected: f64, share: f64, truth: &Truth) {
    assert!(
        (found - expected).abs() <= share * expected.abs(),
        "{name} {found}, expected {expected}: {truth:?}"
    );
}

fn measure(seed: u64) -> (Truth, Measured) {
    let truth = truth(seed);
    let mut bench = Bench::new(&truth, plan(&truth));
    let report = bench.run();
    assert!(bench.most_n <= 1.0 + 1e-12, "{}", bench.most_n);
    assert!(
        bench.device.most_n <= 2.0 + 1e-12,
        "{}",
        bench.device.most_n
    );
    assert_eq!(bench.end.sample().counts.trips, 0);
    assert_eq!(
        bench
            .prompts
            .iter()
            .filter(|p| **p == Prompt::PressButton)
            .count(),
        1
    );
    (truth, report)
}

fn judge(seed: u64) {
    let (truth, report) = measure(seed);
    let period_ms = truth.period_ns as f64 * 1e-6;
    let rate = report.rate.measured().expect("rate");
    near("rate", rate.rate_hz, 1e3 / period_ms, 1e-6, &truth);
    near(
        "longest interval",
        rate.interval_most_us,
        period_ms * 1e3,
        1e-6,
        &truth,
    );
    let step = report
        .resolution_mm
        .measured()
        .unwrap_or_else(|| panic!("{report:?} {truth:?}"));
    near("resolution", step.value, truth.step * 1e3, 0.02, &truth);
    let friction = report
        .friction
        .measured()
        .unwrap_or_else(|| panic!("{report:?} {truth:?}"));
    near(
        "friction",
        friction.friction_n.value,
        truth.friction,
        0.15,
        &truth,
    );
    assert_eq!(friction.friction_n.count, 9);
    for axis in 0..3 {
        near(
            "friction of an axis",
            friction.axes_n[axis].value,
            truth.friction,
            0.15,
            &truth,
        );
        let off = friction.bias_n[axis].value - truth.bias[axis];
        assert!(
            off.abs() < 0.1 * truth.friction,
            "bias off by {off}: {truth:?}"
        );
    }
    let steps = report
        .steps
        .measured()
        .unwrap_or_else(|| panic!("{report:?} {truth:?}"));
    let late = truth.late as f64 * period_ms;
    let Value { value, count, .. } = steps.latency_ms;
    // The loop reads a sample per millisecond.
    assert!(
        (value - late).abs() < period_ms.max(1.0),
        "latency {value}, expected {late}: {truth:?}"
    );
    assert!(count >= 10 && steps.first_motion_ms.value >= value - 1.0);
    near("mass", steps.mass_g.value, truth.mass * 1e3, 0.25, &truth);
    let here = Vec3::zeros();
    let grips = [
        (&report.light_grip, Hand::light(here)),
        (&report.firm_grip, Hand::firm(here)),
    ];
    for (found, hand) in grips {
        let found = found
            .measured()
            .unwrap_or_else(|| panic!("{report:?} {truth:?}"));
        // The ramp of the test ends at 8 N/mm.
        let expected = stiffest(&truth, &hand).min(7.9e3) * 1e-3;
        println!(
            "{seed}: stiffness {}, expected {expected}",
            found.stable_n_per_mm
        );
        near("stiffness", found.stable_n_per_mm, expected, 0.2, &truth);
    }
    println!(
        "{seed}: friction {:.4} of {:.4} N, latency {value:.2} of {late:.2} ms, mass {:.0} of {:.0} g",
        friction.friction_n.value,
        truth.friction,
        steps.mass_g.value,
        truth.mass * 1e3
    );
    let scale = report
        .scale
        .measured()
        .unwrap_or_else(|| panic!("{report:?} {truth:?}"));
    assert_eq!(
        scale.iter().map(|point| point.asked_n).collect::<Vec<_>>(),
        [0.5, 1.0, 2.0]
    );
    for point in scale {
        assert!(
            point.error_n.abs() < 2.0 * truth.friction + 0.02,
            "{point:?}: {truth:?}"
        );
    }
    let before = plan(&truth).model;
    let model = report.model(&before).expect("a model");
    assert_eq!(model.serial, "TEST-7");
    for figure in [
        &model.rate_hz,
        &model.latency_ms,
        &model.friction_n,
        &model.mass_g,
        &model.resolution_mm,
        &model.stiffness_n_per_mm,
    ] {
        assert_eq!(figure.source, Source::Measured);
    }
    assert_eq!(model.peak_force_n, before.peak_force_n);
    assert_eq!(model.damping_n_s_per_m, before.damping_n_s_per_m);
    assert!(model.to_toml().is_ok() && serde_json::to_string(&report).is_ok());
}

macro_rules! seeds {
    ($($name:ident $seed:literal),*) => { $(#[test] fn $name() { judge($seed); })* };
}

seeds!(
    device_1 1, device_2 2, device_3 3, device_4 4, device_5 5, device_6 6, device_7 7, device_8 8,
    device_9 9, device_10 10, device_11 11, device_12 12, device_13 13, device_14 14, device_15 15, device_16 16
);
