//! Values of the metrics of tools and of whole sessions, computed by hand.

use super::*;

#[test]
fn a_force_too_brief_for_a_value_can_be_critical() {
    let mut by = By::hand(vec![]);
    by.evidence.mirror.observe(7.905, 4.5, 0.05);
    let measured = |by: &By, name: &str| {
        let metric = find(name).expect("a metric");
        let session = by.measured();
        (metric.value(&session), metric.critical_value(&session))
    };
    // A knock is no critical error.
    by.evidence.probe.observe(7.905, 0.9, 0.05);
    assert_eq!(measured(&by, "contact_force"), (None, None));
    let (value, critical) = measured(&by, "mirror_force");
    assert_eq!(value, None);
    assert!((critical.expect("pressed") - 7.91).abs() < 1e-9);
    assert_eq!(measured(&by, "damage_events"), (Some(0.0), Some(0.0)));
}

#[test]
fn counts_and_sums_are_those_of_the_evidence() {
    let mut by = By::hand(vec![]);
    let said = |kind: &str, data| crate::Occurrence {
        kind: kind.into(),
        tick: 1,
        data,
    };
    // 0.25 s on the floor feel a zone, 0.15 s do not.
    let mut bears = |site, seconds: f64| {
        let at = standing(36, site, 90.0, 3.0, 0.2);
        for _ in 0..(seconds * 1e3) as u32 {
            by.evidence.stays(Some(&at), 1e-3, SET.force_n[0]);
        }
    };
    bears(Buccal, 0.25);
    bears(MesioBuccal, 0.15);
    for (kind, data) in [
        (
            "withdrawn",
            serde_json::json!({"tooth": 36, "to": "mesiobuccal"}),
        ),
        // A return to a felt zone is no withdrawal.
        (
            "withdrawn",
            serde_json::json!({"tooth": 36, "to": "buccal"}),
        ),
        ("force_zone", serde_json::json!({"zone": "trauma"})),
        ("force_zone", serde_json::json!({"zone": "trauma"})),
        ("force_zone", serde_json::json!({"zone": "damage"})),
        ("force_zone", serde_json::json!({"zone": "too_heavy"})),
    ] {
        by.evidence.happened(&said(kind, data));
    }
    assert_eq!(by.value("withdrawals"), Some(1.0));
    assert_eq!(by.value("trauma_events"), Some(2.0));
    assert_eq!(by.value("damage_events"), Some(1.0));
    assert_eq!(by.value("smoothness"), Some(-1.75));
    assert_eq!(by.value("path_length"), Some(0.0));
    assert_eq!(by.value("time"), None);
    let at: Standing = standing(36, Buccal, 90.0, 2.0, 0.2);
    by.evidence.floor.observe(&at, 3.0, SET.force_n);
    by.evidence
        .floor
        .observe(&standing(36, Buccal, 90.0, 2.0, 0.05), 1.0, SET.force_n);
    assert_eq!(by.value("force_in_band"), Some(75.0));
    for _ in 0..10 {
        by.evidence.mirror.observe(0.805, 0.5, 0.5);
        by.evidence.probe.observe(0.305, 0.5, 0.5);
    }
    assert!((by.value("mirror_force").expect("pressed") - 0.81).abs() < 1e-9);
    assert!((by.value("contact_force").expect("pressed") - 0.31).abs() < 1e-9);
    assert_eq!(by.value("charm"), None);
    assert_eq!(by.value("target_visible"), None);
    assert_eq!(by.value("coordination"), None);
}

#[test]
fn both_hands_are_measured_over_the_working_time() {
    let mut by = By::hand(vec![]);
    let mut all = |in_pocket, visible, holds, seconds| {
        let now = Moment {
            in_pocket: Some(in_pocket),
            held: true,
            visible,
            holds,
        };
        by.evidence.hands.observe(&now, seconds);
    };
    all(true, true, true, 3.0);
    all(false, true, true, 1.0); // from one pocket to the next
    all(true, true, false, 2.0);
    all(true, false, true, 4.0);
    all(false, true, true, 5.0); // after the work
    // Ten seconds of work, six with the target visible. Nine seconds in pockets, three with both.
    assert_eq!(by.value("time"), Some(10.0));
    assert_eq!(by.value("target_visible"), Some(60.0));
    assert_eq!(by.value("coordination"), Some(100.0 / 3.0));
}

#[test]
fn a_short_look_has_no_value() {
    let mut by = By::hand(vec![]);
    by.exercise.zones.clear();
    by.exercise.duration_s = 12.0;
    let look = |by: &mut By, visible, seconds| {
        let now = Moment {
            in_pocket: None,
            held: true,
            visible,
            holds: true,
        };
        by.evidence.hands.observe(&now, seconds);
    };
    // A quarter of twelve seconds is needed.
    look(&mut by, true, 2.875);
    assert_eq!(by.value("target_visible"), None);
    look(&mut by, false, 0.125);
    assert_eq!(by.value("target_visible"), Some(100.0 * 2.875 / 3.0));
    // Five seconds of a longer exercise are needed.
    by.exercise.duration_s = 60.0;
    assert_eq!(by.value("target_visible"), None);
    look(&mut by, false, 2.75);
    assert_eq!(by.value("target_visible"), Some(50.0));
    // The same holds for the force on a tool. Its peak counts all the same.
    by.evidence.mirror.observe(0.5, 4.5, 0.05);
    assert_eq!(by.value("mirror_force"), None);
    assert_eq!(by.value("mirror_peak"), Some(0.5));
    by.evidence.mirror.observe(0.5, 0.5, 0.05);
    assert!((by.value("mirror_force").expect("pressed") - 0.51).abs() < 1e-9);
}

#[test]
fn the_hardest_push_is_a_mean_over_fifty_milliseconds() {
    let mut by = By::hand(vec![]);
    assert_eq!(by.value("probe_peak"), None);
    // Five ticks of 10 ms make 50 ms. The mean of 1, 1, 1, 4 and 4 N is 2.2 N.
    for force in [1.0, 1.0, 1.0, 1.0, 1.0, 4.0, 4.0] {
        by.evidence.probe.observe(force, 0.01, 0.01);
    }
    let peak = by.value("probe_peak").expect("pressed");
    assert!((peak - 2.2).abs() < 1e-12, "{peak}");
    assert_eq!(by.value("mirror_peak"), None);
}

#[test]
fn a_crown_is_covered_by_twelfths() {
    let mut by = By::hand(vec![]);
    assert_eq!(by.value("crown_covered"), None);
    let mut crown = Crown::about(Vec3::zeros(), Vec3::repeat(6e-3));
    let mut touch = |degrees: f64, away: f64, force: f64| {
        let (y, x) = libm::sincos(degrees.to_radians());
        let tip = Vec3::new(x, y, 0.0) * away;
        (0..20).for_each(|_| crown.observe(&tip, force, 1e-3));
    };
    // Three sectors of twelve. A second touch of the first, and touches on top, far out and without force add none.
    touch(15.0, 5e-3, 0.2);
    touch(45.0, 5e-3, 0.2);
    touch(195.0, 5e-3, 0.2);
    touch(20.0, 4e-3, 0.2);
    touch(75.0, 1e-3, 0.2);
    touch(105.0, 10e-3, 0.2);
    touch(135.0, 5e-3, 0.0);
    by.evidence.crown = Some(crown);
    assert_eq!(by.value("crown_covered"), Some(25.0));
}
