//! What if: a comparison, which says that it is one.
#![allow(clippy::unwrap_used)]

mod common;

use common::*;
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
        "tissue is rigid, expected a scene in which something yields"
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
        "level is 4, expected 0 to 1, the levels that the recorded trees hold"
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
