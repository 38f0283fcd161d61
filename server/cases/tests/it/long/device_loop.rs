//! Real devices in every hard case, with figures 30 % off.

use sulcus_cases::device_loop::sweep::corners;
use sulcus_cases::device_loop::{Rests, devices};
use sulcus_cases::{Case, TABLE};
use sulcus_support::long;

/// Runs every hard case with all corners of the figures of device number `device`, on two threads. Rest, delay and grip
/// rotate over the corners.
fn quiet_in_every_case(device: usize) {
    let model = &devices()[device];
    let of_case = |(number, case): (usize, &Case)| -> Vec<String> {
        let rests = Rests::of(case);
        let swept = corners(case, number as u32, &rests, model);
        let broken = swept.iter().filter(|one| one.found.buzzes());
        broken.map(|one| one.said(case)).collect()
    };
    let half = |begin: usize| {
        let cases = TABLE.iter().enumerate().skip(begin).step_by(2);
        cases.flat_map(of_case).collect::<Vec<_>>()
    };
    let broken = std::thread::scope(|scope| {
        let other = scope.spawn(|| half(1));
        let mut all = half(0);
        all.extend(other.join().expect("a half"));
        all
    });
    assert!(broken.is_empty(), "{} loops: {broken:#?}", broken.len());
}

#[test]
fn a_touch_is_quiet_in_every_case() {
    if long::selected("touch-in-every-case") {
        quiet_in_every_case(0);
    }
}

#[test]
fn a_touch_x_is_quiet_in_every_case() {
    if long::selected("touch-x-in-every-case") {
        quiet_in_every_case(1);
    }
}

#[test]
fn an_inverse3_is_quiet_in_every_case() {
    if long::selected("inverse3-in-every-case") {
        quiet_in_every_case(2);
    }
}

#[test]
fn a_premium_1_5_is_quiet_in_every_case() {
    if long::selected("premium-1.5-in-every-case") {
        quiet_in_every_case(3);
    }
}

#[test]
fn a_premium_3_0_is_quiet_in_every_case() {
    if long::selected("premium-3.0-in-every-case") {
        quiet_in_every_case(4);
    }
}
