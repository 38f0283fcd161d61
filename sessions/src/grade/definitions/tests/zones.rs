//! Values of the metrics of zones, computed by hand.

use super::*;

#[test]
fn calls_against_the_truth() {
    // Errors are 0, +1, -2 and -0.5 mm; a tie is exact. One zone is not called, and one is no zone of the exercise.
    let mut besides = zone(MesioLingual, 3.0, Some(3.0), Some(9));
    besides.asked = false;
    let by = By::hand(vec![
        zone(MesioBuccal, 3.0, Some(3.0), Some(3)),
        zone(Buccal, 2.0, Some(2.0), Some(3)),
        zone(DistoBuccal, 6.0, Some(4.0), Some(4)),
        zone(DistoLingual, 4.5, Some(4.4), Some(4)),
        SiteGrade {
            finding: Finding::NotCalled,
            ..zone(Lingual, 3.0, Some(3.0), None)
        },
        besides,
    ]);
    assert_eq!(by.value("called_exact"), Some(50.0));
    assert_eq!(by.value("called_within_1mm"), Some(75.0));
    assert_eq!(by.value("called_bias"), Some(-0.375));
    assert_eq!(by.value("zones_charted"), Some(80.0));
    // Of five probed zones, one with 4.0 of 6.0 mm is short.
    assert_eq!(by.value("floor_reached"), Some(80.0));
    // Of three called zones with a reached floor, the call 3 at a depth of 2.0 mm is a misreading.
    assert_eq!(by.value("misread"), Some(100.0 / 3.0));
}

#[test]
fn a_zone_in_passing_or_called_before_probing_is_not_charted() {
    let with = |probed, finding, called, measured| SiteGrade {
        probed,
        finding,
        ..zone(Buccal, 3.0, measured, called)
    };
    let by = By::hand(vec![
        with(false, Finding::Missed, None, None),
        with(false, Finding::NotProbed, Some(3), None),
        // Called before probing. The reached depth counts all the same.
        with(true, Finding::NotProbed, Some(3), Some(3.0)),
        with(true, Finding::NotCalled, None, None),
        with(true, Finding::NeverReachedFloor, Some(1), None),
    ]);
    assert_eq!(by.value("zones_charted"), Some(20.0));
    assert_eq!(by.value("floor_reached"), Some(100.0 / 3.0));
    assert_eq!(by.value("angle_mid"), Some(100.0));
    assert_eq!(by.value("misread"), None);
    assert_eq!(By::hand(vec![]).value("zones_charted"), None);
}

#[test]
fn a_reading_is_held_for_half_a_second() {
    let held = |finding, called, held_s| SiteGrade {
        finding,
        held_s,
        ..zone(Buccal, 3.0, Some(3.0), called)
    };
    let by = By::hand(vec![
        held(Finding::Right, Some(3), Some(0.5)),
        held(Finding::Misread, Some(5), Some(2.0)),
        held(Finding::Right, Some(3), Some(0.49)),
        held(Finding::NeverReachedFloor, Some(3), Some(0.0)),
        // Zones without a call, and with a call before probing.
        held(Finding::NotCalled, None, Some(1.0)),
        held(Finding::NotProbed, Some(3), None),
    ]);
    assert_eq!(by.value("readings_held"), Some(50.0));
    assert_eq!(By::hand(vec![]).value("readings_held"), None);
}

#[test]
fn a_reading_under_too_much_force_counts_however_light_the_walk_was() {
    let pressed = |pressed_s| SiteGrade {
        pressed_s,
        ..zone(Buccal, 3.0, Some(3.0), Some(3))
    };
    let mut by = By::hand(vec![
        pressed(Some(0.2)),
        pressed(Some(1.5)),
        pressed(Some(0.19)),
        pressed(Some(0.0)),
        SiteGrade {
            finding: Finding::NotCalled,
            ..pressed(Some(1.0))
        },
    ]);
    assert_eq!(by.value("readings_too_heavy"), Some(50.0));
    by.sites.clear();
    assert_eq!(by.value("readings_too_heavy"), None);
}

#[test]
fn a_force_that_stays_in_trauma_counts_every_second() {
    let mut by = By::hand(vec![]);
    let zone = serde_json::json!({"zone": "trauma"});
    let entered = crate::Occurrence {
        kind: "force_zone".into(),
        tick: 1,
        data: zone,
    };
    by.evidence.happened(&entered);
    let mut at = standing(36, Buccal, 90.0, 2.0, 0.6);
    at.zone = sulcus_core::output::ForceZone::Trauma;
    by.evidence.floor.observe(&at, 0.9, SET.force_n);
    assert_eq!(by.value("trauma_events"), Some(1.0));
    by.evidence.floor.observe(&at, 2.6, SET.force_n);
    assert_eq!(by.value("trauma_events"), Some(3.0));
}

#[test]
fn the_order_is_that_of_first_calls() {
    let sites = [DistoBuccal, Buccal, MesioBuccal, Lingual];
    let mut by = By::hand(sites.map(|site| zone(site, 3.0, None, None)).to_vec());
    assert_eq!(by.value("tour_order"), None);
    // Of third, first, second, first again and fourth, the calls of first, second and fourth are in order.
    by.calls = [MesioBuccal, DistoBuccal, Buccal, DistoBuccal, Lingual]
        .map(call)
        .to_vec();
    assert_eq!(by.value("tour_order"), Some(75.0));
}

#[test]
fn touches_by_their_peaks_and_steps() {
    let mut by = By::hand(vec![]);
    let touch = |tooth: u8, degrees: f64, peak: f64| Touch {
        tooth,
        buccal: true,
        around: degrees.to_radians(),
        from_axis: 4e-3,
        peak,
        way: 0.0,
    };
    by.touches = vec![
        touch(36, 60.0, 0.05),
        touch(36, 75.0, 0.2),
        touch(36, 90.0, 0.29),
        touch(36, 120.0, 0.31),
        // A tooth that is not in the exercise.
        touch(35, 60.0, 0.9),
    ];
    assert_eq!(by.value("touches_too_light"), Some(25.0));
    assert_eq!(by.value("touches_too_heavy"), Some(25.0));
    // Steps of 15, 15 and 30 degrees at 4 mm have the median 4 pi / 12 mm.
    let step = by.value("walking_step").expect("steps");
    assert!((step - std::f64::consts::FRAC_PI_3).abs() < 1e-9, "{step}");
}

#[test]
fn angles_apart_for_both_kinds_of_site() {
    let with = |site, right| SiteGrade {
        tilt_right: Some(right),
        ..zone(site, 3.0, None, Some(3))
    };
    let by = By::hand(vec![
        with(Buccal, true),
        with(Lingual, false),
        with(MesioBuccal, true),
        with(DistoBuccal, true),
        with(MesioLingual, true),
        with(DistoLingual, false),
    ]);
    assert_eq!(by.value("angle_mid"), Some(50.0));
    assert_eq!(by.value("angle_proximal"), Some(75.0));
}

#[test]
fn once_recession_and_bleeding_are_called_they_are_called_everywhere() {
    let with = |recession, bleeding, bled| SiteGrade {
        recession_called_mm: recession,
        bleeding_called: bleeding,
        bled,
        ..zone(Buccal, 3.0, None, Some(3))
    };
    let by = By::hand(vec![
        with(Some(-2), Some(true), true),
        with(Some(-1), Some(false), false),
        with(Some(0), Some(false), true), // 2 mm off, and bleeding missed
        with(Some(2), Some(true), false), // wrong sign, and bleeding called without bleeding
        with(None, None, true),           // probed, without a call
    ]);
    assert_eq!(by.value("recession_within_1mm"), Some(40.0));
    assert_eq!(by.value("bleeding_agreement"), Some(40.0));
    let with = |site, truth, furcation| SiteGrade {
        furcation_truth: truth,
        furcation_called: furcation,
        ..zone(site, 3.0, None, Some(3))
    };
    let by = By::hand(vec![
        with(Buccal, Some(1), Some(1)),
        with(Lingual, Some(0), Some(0)),
        with(Buccal, Some(2), Some(1)), // another grade
        with(Lingual, Some(0), None),   // without a call
        with(MesioBuccal, None, None),  // no furcation there
    ]);
    assert_eq!(by.value("furcation_agreement"), Some(50.0));
}

#[test]
fn without_any_call_a_finding_scores_zero_only_if_the_rubric_asks_for_it() {
    let mut by = By::hand(vec![
        SiteGrade {
            furcation_truth: Some(1),
            bled: true,
            ..zone(Buccal, 3.0, None, Some(3))
        },
        zone(MesioBuccal, 3.0, None, Some(3)),
    ]);
    let all = |by: &By| {
        [
            "recession_within_1mm",
            "bleeding_agreement",
            "furcation_agreement",
        ]
        .map(|name| by.value(name))
    };
    assert_eq!(all(&by), [None; 3]);
    by.set = Settings {
        ask_recession: true,
        ask_bleeding: true,
        ask_furcation: true,
        ..SET
    };
    assert_eq!(all(&by), [Some(0.0); 3]);
    // A recording without a patient has no truth of furcation.
    by.sites[0].furcation_truth = None;
    assert_eq!(by.value("furcation_agreement"), None);
}
