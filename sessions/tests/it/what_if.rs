//! What if: a comparison, which says that it is one.
#![allow(clippy::unwrap_used)]

use crate::common::*;
use sulcus_core::Scene;
use sulcus_core::optimise::SolverKind;
use sulcus_sessions::*;

fn compared(bytes: &[u8], what_if: WhatIf) -> ComparisonReport {
    let recording = Recording::from_bytes(bytes.to_vec()).unwrap();
    compare(&recording, &what_if, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

#[test]
fn another_solver_differs_in_bits_and_hardly_in_newtons() {
    let bytes = recorded(1500);
    let solver = Some(SolverKind::Clarabel);
    let report = compared(
        &bytes,
        WhatIf {
            solver,
            ..WhatIf::default()
        },
    );
    assert!(report.comparison && !report.identical && report.recorded_side_identical);
    assert_eq!(report.changed, ["solver clarabel"]);
    assert_eq!(report.ticks, 1500);
    assert!(report.first_divergent_tick.is_some());
    let force = report.apart.max_force_n;
    assert!(force > 0.0 && force < 0.05, "{report:?}");
    assert!(report.apart.max_force_tick >= report.first_divergent_tick);
    assert!(
        report.apart.max_tip_mm > 0.0 && report.apart.max_tip_mm < 0.05,
        "{report:?}"
    );
    for side in [report.recorded, report.what_if] {
        assert!(
            side.contact_ticks > 500 && side.max_residual_um <= 0.5,
            "{side:?}"
        );
    }
    assert!(
        !report.is_finding(),
        "that they differ is what was asked for"
    );
}

#[test]
fn the_scenes_own_solver_named_changes_nothing_and_is_a_comparison_all_the_same() {
    let bytes = recorded(800);
    let solver = Some(SolverKind::ActiveSet);
    let report = compared(
        &bytes,
        WhatIf {
            solver,
            ..WhatIf::default()
        },
    );
    assert!(report.comparison && !report.identical);
    assert_eq!(report.first_divergent_tick, None);
    assert_eq!(report.apart, Apart::default());
    assert_eq!(report.recorded.contact_ticks, report.what_if.contact_ticks);
}

#[test]
fn a_coarser_level_is_felt() {
    let bytes = recorded(1500);
    // The balls' tree: a ball of all three at level 0.
    let report = compared(
        &bytes,
        WhatIf {
            level: Some(0),
            ..WhatIf::default()
        },
    );
    assert_eq!(report.changed, ["1 rigid objects at level 0"]);
    assert!(report.apart.max_force_n > 0.1, "{report:?}");
    assert!(report.what_if.max_force_n > report.recorded.max_force_n);
}

#[test]
fn an_edited_recording_is_found_out_in_a_comparison_too() {
    let mut k = 0;
    let bad = with_messages(&recorded(600), |topic, data| {
        k += u64::from(topic == "/exact/ticks");
        if topic == "/exact/ticks" && k == 300 {
            data[30] ^= 1;
        }
        true
    });
    let report = compared(
        &bad,
        WhatIf {
            level: Some(0),
            ..WhatIf::default()
        },
    );
    assert!(!report.recorded_side_identical && report.is_finding());
    assert!(matches!(report.signature, Signature::Invalid { .. }));
}

#[test]
fn what_the_scene_has_not_is_refused_with_what_it_has() {
    let scene = scene();
    let refused = |what_if: WhatIf| what_if.applied_to(&scene).unwrap_err().to_string();
    let tissue = |choice| WhatIf {
        tissue: Some(choice),
        ..WhatIf::default()
    };
    assert_eq!(
        refused(tissue(TissueChoice::Rigid)),
        "tissue is rigid, expected a scene with soft tissue"
    );
    assert_eq!(
        refused(tissue(TissueChoice::Printed)),
        "tissue is as printed, expected a scene with springs or gingivae"
    );
    assert_eq!(
        refused(WhatIf {
            level: Some(4),
            ..WhatIf::default()
        }),
        "level is 4, expected 0 to 1, the levels of the recorded trees"
    );
    assert_eq!(
        refused(WhatIf {
            detail: Some(2),
            ..WhatIf::default()
        }),
        "level of detail is 2, expected 0 to 1"
    );
    assert!(!WhatIf::default().is_asked());
}

#[test]
fn what_changes_nothing_is_refused() {
    let mut scene = scene();
    let refused =
        |scene: &Scene, what_if: WhatIf| what_if.applied_to(scene).unwrap_err().to_string();
    let level = |level| WhatIf {
        level: Some(level),
        ..WhatIf::default()
    };
    let blend = |on| WhatIf {
        blend: Some(on),
        ..WhatIf::default()
    };
    scene.objects[0].level = 1;
    assert_eq!(
        refused(&scene, level(1)),
        "level is 1, expected another level than that of the recorded rigid objects"
    );
    assert!(level(0).applied_to(&scene).is_ok());
    // No tree of these is calibrated; those of a crown are, and blended.
    let off = "blend is off, expected a scene with blended surfaces";
    let on = "blend is on, expected a scene with calibrated trees as bare spheres";
    assert_eq!(refused(&scene, blend(false)), off);
    assert_eq!(refused(&scene, blend(true)), on);
    let crown = of_the_corpus("crown", true).scene().unwrap();
    assert_eq!(refused(&crown, blend(true)), on);
    let (bare, said) = blend(false).applied_to(&crown).unwrap();
    assert_eq!(said, ["bare spheres"]);
    assert_eq!(refused(&bare, blend(false)), off);
    assert!(blend(true).applied_to(&bare).is_ok());
}

/// A corpus recording; `later` with its snapshots after the first, or without.
fn of_the_corpus(name: &str, later: bool) -> Recording {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let bytes = std::fs::read(folder.join(format!("{name}.mcap"))).unwrap();
    let mut snapshots = 0;
    let bytes = with_messages(&bytes, |topic, _| {
        snapshots += u32::from(topic == "/exact/snapshots");
        later || topic != "/exact/snapshots" || snapshots == 1
    });
    Recording::from_bytes(bytes).unwrap()
}

#[test]
fn a_part_of_what_if_is_that_part_of_the_whole_and_begins_inside_of_nothing() {
    for (name, what_if) in [
        (
            "retraction",
            WhatIf {
                tissue: Some(TissueChoice::Rigid),
                ..WhatIf::default()
            },
        ),
        (
            "probing",
            WhatIf {
                tissue: Some(TissueChoice::Printed),
                ..WhatIf::default()
            },
        ),
        (
            "crown",
            WhatIf {
                level: Some(1),
                ..WhatIf::default()
            },
        ),
    ] {
        let (with, without) = (of_the_corpus(name, true), of_the_corpus(name, false));
        let (first, last) = with.facts().ticks.unwrap();
        let late = last - (last - first) / 4;
        let span = Span {
            from_s: Some(late as f64 * with.scene().unwrap().tick_s()),
            to_s: None,
        };
        let compared = |recording: &Recording| {
            let options = ReplayOptions {
                span,
                ..ReplayOptions::default()
            };
            compare(recording, &what_if, &options, &mut |_| {}).unwrap()
        };
        let (part, linear) = (compared(&with), compared(&without));
        // The recorded side goes on from the snapshot, the changed one comes from the beginning.
        let began = part.part.unwrap().snapshot_tick;
        assert!(
            began > first && part.ticks < linear.ticks,
            "{name}: {part:?}"
        );
        assert_eq!(part.what_if_snapshot_tick, linear.what_if_snapshot_tick);
        assert!(part.what_if_snapshot_tick < first, "{name}: {part:?}");
        let untimed = |side: Side| Side {
            tick_us: 0.0,
            ..side
        };
        assert_eq!(untimed(part.what_if), untimed(linear.what_if), "{name}");
        assert_eq!(untimed(part.recorded), untimed(linear.recorded), "{name}");
        assert_eq!(part.apart, linear.apart, "{name}");
        assert!(part.apart.max_force_n > 0.0, "{name}: {part:?}");
    }
}

#[test]
fn another_solver_goes_on_from_the_parts_own_snapshot() {
    let recording = of_the_corpus("probing", true);
    let (first, last) = recording.facts().ticks.unwrap();
    let options = ReplayOptions {
        span: Span {
            from_s: Some((last - 20) as f64 * recording.scene().unwrap().tick_s()),
            to_s: None,
        },
        ..ReplayOptions::default()
    };
    let what_if = WhatIf {
        solver: Some(SolverKind::Clarabel),
        ..WhatIf::default()
    };
    let report = compare(&recording, &what_if, &options, &mut |_| {}).unwrap();
    assert!(report.what_if_snapshot_tick > first, "{report:?}");
    assert_eq!(
        report.part.unwrap().snapshot_tick,
        report.what_if_snapshot_tick
    );
    assert!(report.apart.max_force_n < 0.05, "{report:?}");
}
