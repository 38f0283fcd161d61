use sulcus_core::Vec3;
use sulcus_haptics::{Stage, Trip};

use super::device::{Truth, truth};
use super::person::{Bench, plan};
use crate::measure::{Answer, Outcome, Part, Plan, Prompt};

fn with(parts: &[Part]) -> (Truth, Plan) {
    let truth = truth(3);
    let plan = Plan {
        parts: parts.to_vec(),
        ..plan(&truth)
    };
    (truth, plan)
}

/// Runs until `part` is at work, and half a second more.
fn into(bench: &mut Bench, part: Part) {
    let mut left = 200_000;
    while !(bench.measurement.report().rate.measured().is_some() || part == Part::Rate)
        || left > 199_000
    {
        left -= 1;
        assert!(left > 0);
        bench.step();
    }
    (0..3000).for_each(|_| {
        bench.step();
    });
}

#[test]
fn a_trip_ends_the_stage_and_the_next_one_waits_for_a_button() {
    let (truth, plan) = with(&[Part::Rate, Part::Resolution, Part::Scale]);
    let mut bench = Bench::new(&truth, plan);
    into(&mut bench, Part::Resolution);
    bench.device.port.trip(Trip::Driver);
    let forces = (0..20).map(|_| bench.step().wanted.wrench.force.norm());
    assert_eq!(forces.last(), Some(0.0));
    assert!(matches!(bench.device.port.stage(), Stage::Tripped(_)));
    let report = bench.run();
    let Outcome::NotMeasured(reason) = &report.resolution_mm else {
        panic!("{report:?}");
    };
    assert!(reason.contains("force off by the driver"), "{reason}");
    assert!(report.rate.measured().is_some() && report.scale.measured().is_some());
    assert_eq!(
        bench
            .prompts
            .iter()
            .filter(|p| **p == Prompt::PressButton)
            .count(),
        2
    );
}

#[test]
fn a_stopped_measurement_orders_no_force_and_keeps_its_results() {
    let (truth, plan) = with(&Part::ALL);
    let mut bench = Bench::new(&truth, plan);
    into(&mut bench, Part::Resolution);
    bench.measurement.answer(Answer::Stop);
    let order = bench.step();
    assert!(order.is_done && order.wanted.leaving);
    assert_eq!(order.wanted.wrench.force, Vec3::zeros());
    let report = bench.measurement.report();
    assert!(report.rate.measured().is_some());
    assert_eq!(
        report.friction,
        Outcome::NotMeasured("the measurement was ended".into())
    );
    let before = bench
        .measurement
        .report()
        .model(&super::person::plan(&truth).model)
        .expect("a model");
    assert_eq!(before.friction_n.value, 0.26);
}

#[test]
fn nobody_at_the_device_ends_the_measurement_by_its_counts() {
    let (truth, plan) = with(&Part::ALL);
    let mut bench = Bench::new(&truth, plan);
    let mut steps = 0;
    loop {
        let order = bench
            .measurement
            .step(bench.device.now_ns, &sulcus_haptics::Sample::NOTHING);
        steps += 1;
        assert!(steps < 200_000);
        if order.is_done {
            break;
        }
    }
    assert!(matches!(
        &bench.measurement.report().rate,
        Outcome::NotMeasured(_)
    ));
}

#[test]
fn a_handle_that_is_too_heavy_a_left_out_stage_and_a_lifted_tip_have_reasons() {
    let (truth, plan) = with(&[
        Part::Rate,
        Part::Friction,
        Part::Steps,
        Part::LightGrip,
        Part::Scale,
    ]);
    let heavy = Truth {
        bias: Vec3::new(0.0, 2.0, 0.0),
        ..truth
    };
    let mut bench = Bench::new(&heavy, plan);
    bench.refuses = Some(Part::LightGrip);
    let mut lifted = false;
    let report = loop {
        let order = bench.step();
        if order.is_done {
            break bench.measurement.report().clone();
        }
        if matches!(order.prompt, Some(Prompt::ReadScale { newtons }) if newtons > 0.9) && !lifted {
            lifted = true;
            bench.device.plant.x.y += 0.004;
            bench.device.plant.hand = Some(super::device::Hand::firm(
                bench.device.plant.x + Vec3::new(0.0, 0.05, 0.0),
            ));
        }
    };
    let reason = |text: &str, outcome: &str| assert!(outcome.contains(text), "{outcome}");
    reason("left its place", &format!("{:?}", report.rate));
    reason("NotMeasured", &format!("{:?}", report.friction));
    reason("friction is not known", &format!("{:?}", report.steps));
    reason("left out", &format!("{:?}", report.light_grip));
    reason("left the scale", &format!("{:?}", report.scale));
}
