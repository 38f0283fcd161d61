//! Hand-computed values of the metrics.

use super::*;
use crate::exercise::events::Standing;
use crate::grade::hands::Moment;
use crate::grade::sites::Finding;
use crate::grade::test_help::{SET, empty_scene, standing, zone};
use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::tissue::gingiva::Site::*;

/// Values of a session made by hand.
struct By {
    exercise: Exercise,
    evidence: Evidence,
    sites: Vec<SiteGrade>,
    calls: Vec<Call>,
    touches: Vec<Touch>,
    set: Settings,
}

impl By {
    fn hand(sites: Vec<SiteGrade>) -> Self {
        let exercise = Exercise::built_in()
            .into_iter()
            .find(|one| one.name == "bimanual")
            .expect("built in");
        Self {
            evidence: Evidence::new(&empty_scene(), &exercise),
            exercise,
            sites,
            calls: Vec::new(),
            touches: Vec::new(),
            set: SET,
        }
    }

    fn value(&self, name: &str) -> Option<f64> {
        let measured = Measured {
            exercise: &self.exercise,
            evidence: &self.evidence,
            sites: &self.sites,
            calls: &self.calls,
            touches: &self.touches,
            smoothness: Some(-1.75),
            set: &self.set,
        };
        measured.value(name)
    }
}

fn call(site: Site) -> Call {
    Call {
        tooth: 36,
        site,
        depth_mm: 3,
        recession_mm: None,
        bleeding: None,
        furcation: None,
    }
}

#[test]
fn calls_against_the_truth() {
    // Errors: 0, +1, -2, -0.5 (a tie is exact), and one not called; one called besides, which nobody asked for.
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
    // All five were probed; 4.0 of 6.0 is short.
    assert_eq!(by.value("floor_reached"), Some(80.0));
    // Called and on the floor: three; 3 where the tip was at 2.0 is a millimetre off.
    assert_eq!(by.value("misread"), Some(100.0 / 3.0));
}

#[test]
fn a_zone_in_passing_or_from_hearsay_is_not_charted() {
    let with = |probed, finding, called, measured| SiteGrade {
        probed,
        finding,
        ..zone(Buccal, 3.0, measured, called)
    };
    let by = By::hand(vec![
        with(false, Finding::Missed, None, None),
        with(false, Finding::NotProbed, Some(3), None),
        // Called before the tip was there: what the tip did then counts all the same.
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
        // Not read at all, or from hearsay.
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
fn who_stays_in_trauma_made_one_for_every_second() {
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
fn what_was_too_brief_to_be_graded_can_be_critical() {
    let mut by = By::hand(vec![]);
    by.evidence.mirror.observe(7.905, 4.5, 0.05);
    let measured = |by: &By, name: &str| {
        let measured = Measured {
            exercise: &by.exercise,
            evidence: &by.evidence,
            sites: &by.sites,
            calls: &by.calls,
            touches: &by.touches,
            smoothness: None,
            set: &by.set,
        };
        (measured.value(name), measured.critical(name))
    };
    // A knock is none.
    by.evidence.probe.observe(7.905, 0.9, 0.05);
    assert_eq!(measured(&by, "contact_force"), (None, None));
    let (value, critical) = measured(&by, "mirror_force");
    assert_eq!(value, None);
    assert!((critical.expect("pressed") - 7.91).abs() < 1e-9);
    assert_eq!(measured(&by, "damage_events"), (Some(0.0), Some(0.0)));
}

#[test]
fn the_order_is_that_of_first_calls() {
    let sites = [DistoBuccal, Buccal, MesioBuccal, Lingual];
    let mut by = By::hand(sites.map(|site| zone(site, 3.0, None, None)).to_vec());
    assert_eq!(by.value("tour_order"), None);
    // Third, first, second, first again, fourth: first, second, fourth are in order.
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
        // A tooth that nobody asked about.
        touch(35, 60.0, 0.9),
    ];
    assert_eq!(by.value("touches_too_light"), Some(25.0));
    assert_eq!(by.value("touches_too_heavy"), Some(25.0));
    // 15, 15 and 30 degrees at 4 mm: the median is 4 pi / 12 mm.
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
        with(Some(0), Some(false), true), // 2 mm off, and missed
        with(Some(2), Some(true), false), // the sign trap, and seen where nothing was
        with(None, None, true),           // probed, and nothing said of it
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
        with(Buccal, Some(2), Some(1)), // another class
        with(Lingual, Some(0), None),   // nothing said of it
        with(MesioBuccal, None, None),  // no furcation there
    ]);
    assert_eq!(by.value("furcation_agreement"), Some(50.0));
}

#[test]
fn who_calls_none_at_all_has_none_right_only_where_it_is_asked_for() {
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

#[test]
fn what_is_counted_or_gathered_is_said_as_it_is() {
    let mut by = By::hand(vec![]);
    let said = |kind: &str, data| crate::Occurrence {
        kind: kind.into(),
        tick: 1,
        data,
    };
    // A short touch on the way is no stay; a quarter of a second on the floor is.
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
        // To look again is no withdrawal.
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
fn what_hands_do_together_is_measured_over_the_work() {
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
    // Ten seconds of work, six of them with the target in sight; nine in pockets, three of them with both.
    assert_eq!(by.value("time"), Some(10.0));
    assert_eq!(by.value("target_visible"), Some(60.0));
    assert_eq!(by.value("coordination"), Some(100.0 / 3.0));
}

#[test]
fn a_look_that_is_over_at_once_was_not_done() {
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
    // A quarter of twelve seconds is asked for.
    look(&mut by, true, 2.875);
    assert_eq!(by.value("target_visible"), None);
    look(&mut by, false, 0.125);
    assert_eq!(by.value("target_visible"), Some(100.0 * 2.875 / 3.0));
    // Of a longer one five seconds.
    by.exercise.duration_s = 60.0;
    assert_eq!(by.value("target_visible"), None);
    look(&mut by, false, 2.75);
    assert_eq!(by.value("target_visible"), Some(50.0));
    // So with a tool that hardly touches anything; its hardest push counts all the same.
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
    // Ticks of 10 ms: five make a push. 1, 1, 1, 4, 4 N: 2.2 N in the mean.
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
    // Three of twelve; a second touch in the first, one on top, one from far and one without force are none.
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

#[test]
fn every_metric_of_the_table_has_a_value_here() {
    use crate::grade::definitions::METRICS;
    let text = include_str!("../values.rs");
    for metric in METRICS {
        assert!(
            text.contains(&format!("\"{}\" =>", metric.name)),
            "{}",
            metric.name
        );
    }
}
