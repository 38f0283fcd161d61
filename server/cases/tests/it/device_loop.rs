//! Closed loop with the dynamics of real devices: no limit cycle in a hand at rest.

use sulcus_cases::device_loop::figures::{ASSUMED, Grip, Variation};
use sulcus_cases::device_loop::sweep::loop_of;
use sulcus_cases::device_loop::{LIMIT_N, Rests, Setup, devices, run};
use sulcus_cases::find;
use sulcus_haptics::{DeviceModel, PassivityParams};

/// Cases of every run of the tests: rigid plate, two teeth, wedge, slot, pocket, tongue.
const FEW: [&str; 6] = [
    "thin-plate-0.5",
    "teeth-gap-0.02",
    "wedge",
    "opposed-0",
    "pocket-0.65",
    "tongue-10-k2",
];

#[test]
fn no_device_swings_in_a_hand_at_rest() {
    let (mut felt, mut runs) = (0, 0);
    let mut broken = Vec::new();
    for name in FEW {
        let case = find(name).expect("in the table");
        let rests = Rests::of(case);
        for (d, model) in devices().iter().enumerate() {
            // All rests and both grips of a device occur over the cases, nominal and in the worst corner.
            for (k, variation) in [Variation::NOMINAL, Variation::WORST]
                .into_iter()
                .enumerate()
            {
                let k = (d + 5 * k + runs) as u32;
                let one = loop_of(case, &rests, model, variation, k);
                assert!(one.found.live, "{}", one.said(case));
                felt += u32::from(one.found.force_n > LIMIT_N);
                runs += 1;
                broken.extend(one.found.buzzes().then(|| one.said(case)));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
    // A loop without a force proves nothing.
    assert!(felt * 2 > runs as u32, "{felt} of {runs} with a force");
}

/// Loudest of three rests with `grip`, newtons. `passivity` changes the controller of the device.
fn loudest(
    name: &str,
    model: &DeviceModel,
    (factor, grip): (f64, Grip),
    passivity: fn(PassivityParams) -> PassivityParams,
) -> f64 {
    let case = find(name).expect("in the table");
    let rests = Rests::of(case);
    let own = model.passivity(1.0 / model.rate_hz.value, 1e-3);
    let runs = (0..3).map(|rest| {
        let setup = Setup {
            factor,
            grip,
            passivity: Some(passivity(own)),
            ..Setup::nominal(model)
        };
        run(case, &setup, rests.nth(rest)).buzz_n
    });
    runs.fold(0.0, f64::max)
}

/// The test of limit cycles can fail: without the controller twenty times the coupling swings with every device.
#[test]
fn a_coupling_that_is_too_stiff_is_found() {
    let observing = |own| PassivityParams {
        max_damping: 0.0,
        ..own
    };
    for model in devices() {
        let at = |factor: f64| {
            // A firm hand damps a light device, and a light hand lets a heavy one slip out of the contact.
            let of = |grip| loudest("wedge", &model, (factor, grip), observing);
            of(Grip::Light).max(of(Grip::Firm))
        };
        let (chosen, stiff) = (at(1.0), at(20.0));
        assert!(chosen <= LIMIT_N, "{}: {chosen} N", model.name);
        assert!(stiff > 2.0 * LIMIT_N, "{}: {stiff} N", model.name);
    }
}

/// Regression test: a controller with the damping of 30 N s/m for every device swung by 0.6 N at 150 Hz.
#[test]
fn damping_beyond_the_device_is_found() {
    let before = |own: PassivityParams| PassivityParams {
        period_s: own.period_s,
        ..PassivityParams::default()
    };
    let touch = &devices()[0];
    let old = loudest("wedge", touch, (1.0, Grip::Firm), before);
    let new = loudest("wedge", touch, (1.0, Grip::Firm), |own| own);
    assert!(old > 2.0 * LIMIT_N && new <= LIMIT_N, "{old} N, {new} N");
}

#[test]
fn every_figure_has_a_source() {
    for figure in ASSUMED {
        assert!(figure.value > 0.0 && figure.source == "guess", "{figure:?}");
        assert!(!figure.from.is_empty() && !figure.unit.is_empty());
    }
    let corners: Vec<Variation> = (0..Variation::CORNERS).map(Variation::corner).collect();
    assert!(corners.contains(&Variation::WORST));
    for (k, corner) in corners.iter().enumerate() {
        assert!(!corners[..k].contains(corner), "{corner:?} occurs twice");
    }
}
