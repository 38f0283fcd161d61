//! Grade of an invented session, and its depth and force over time.

use sulcus_core::tissue::gingiva::Site;

use super::Kind;
use crate::Rubric;
use crate::grade::motion::series::{Point, Series};
use crate::grade::report::{
    Advice, CriticalError, Grade, MetricGrade, Migrated, RubricUsed, ShownBy, Source, Thresholds,
};
use crate::grade::rubric::Bound;
use crate::grade::sites::{Finding, SiteGrade};
use crate::record::format::Migration;

/// The grade of a session.
pub fn grade(text: &str, kind: Kind, attempt: usize) -> Grade {
    let score = kind.graded.then_some(91.25 - 17.0 * attempt as f64);
    let rubric = Rubric::built_in().remove(0);
    Grade {
        learner_id: text.into(),
        exercise: text.into(),
        station: text.into(),
        seed: attempt as u64,
        started_unix_ns: 1_790_000_000_000_000_000 + attempt as u64,
        signer: "0123456789abcdef0123456789abcdef".into(),
        signer_trusted: attempt == 1,
        gradable: kind.graded,
        reason: (!kind.graded).then(|| text.into()),
        migrated: (attempt == 2).then_some(Migrated {
            migration: Migration {
                from: "3",
                to: "5",
                what: "other filters",
            },
            rms_force_n: 0.001,
            max_force_n: 0.01,
            max_pose_mm: 0.002,
        }),
        rubric: Some(RubricUsed {
            name: text.into(),
            version: 7,
            blake3: "0123456789abcdef".into(),
            source: Source::Recording,
            redefined: vec![text.into()],
            unknown: vec![text.into(), text.into()],
        }),
        score,
        pass_mark: score.map(|_| 70.0),
        passed: score.map(|score| score >= 70.0),
        failures: vec![text.into(), text.into()],
        critical: vec![CriticalError {
            metric: text.into(),
            why: text.into(),
            cap: Some(40.0),
        }],
        metrics: metrics(text),
        sites: if kind.probed { sites() } else { Vec::new() },
        force_band_n: Some([0.1, 0.25]),
        thresholds: Some(Thresholds {
            settings: rubric.settings,
            mid_tilt_deg: 10.0,
            proximal_tilt_deg: [5.0, 30.0],
        }),
        floor_time: Default::default(),
        advice: vec![Advice {
            metric: "floor_reached",
            title: "floor reached",
            text: text.into(),
            sites: vec![
                ShownBy {
                    tooth: 36,
                    says: text.into(),
                },
                ShownBy {
                    tooth: 16,
                    says: text.into(),
                },
            ],
        }],
        missing: vec![text.into()],
        ended_early: (attempt == 1).then_some("the connection was lost"),
        gaps: None,
        unfelt: Vec::new(),
        felt: None,
        parts: Vec::new(),
    }
}

fn metrics(text: &str) -> Vec<MetricGrade> {
    let metric = |name, title, unit, target, value, weight, score| MetricGrade {
        name,
        title,
        value,
        unit,
        target,
        zero: Bound::One(-3.5),
        weight,
        score,
        not_judged: None,
        pass: None,
        deducted: 1.5,
        definition: "share of <all> zones & \"more\"",
        recorded_definition: Some(text.into()),
        source: "a book",
    };
    let band = Bound::Band([-0.4, 0.4]);
    let one = Bound::One(90.0);
    vec![
        metric(
            "floor_reached",
            "floor reached",
            "%",
            one,
            Some(33.3),
            20.0,
            Some(12.6),
        ),
        metric(
            "call_bias",
            "mean error of calls",
            "mm",
            band,
            Some(-0.1),
            3.0,
            Some(100.0),
        ),
        metric(
            "order",
            "order of the tour",
            "%",
            one,
            Some(3.0),
            2.5,
            Some(50.0),
        ),
        metric("sparc", "smoothness (SPARC)", "", one, None, 3.0, None),
        metric("time", "time", "s", one, Some(1.2), 0.0, Some(80.0)),
    ]
}

fn sites() -> Vec<SiteGrade> {
    const FINDINGS: [Finding; 9] = [
        Finding::Right,
        Finding::Missed,
        Finding::NotProbed,
        Finding::NotCalled,
        Finding::NeverReachedFloor,
        Finding::Misread,
        Finding::ReadTooHeavy,
        Finding::ReadTilted,
        Finding::Off,
    ];
    let teeth = [36, 46, 16];
    let places = teeth
        .iter()
        .flat_map(|tooth| Site::ALL.map(|site| (*tooth, site)));
    let site = |(k, (tooth, site)): (usize, (u8, Site))| SiteGrade {
        tooth,
        site,
        asked: k < 12,
        probed: k % 4 != 1,
        truth_mm: (k % 7 != 6).then_some(2.0 + 0.5 * k as f64),
        measured_mm: (k % 3 != 2).then_some(1.75 + 0.4 * k as f64),
        called_mm: (k % 5 != 3).then_some(2 + (k % 6) as u8),
        deepest_mm: None,
        shown_mm: None,
        max_force_n: (k % 4 != 1).then_some(0.123 * k as f64),
        held_s: None,
        pressed_s: None,
        tilt_deg: None,
        into_col_deg: None,
        tilt_right: None,
        recession_truth_mm: Some(-1.5 + 0.3 * k as f64),
        recession_called_mm: (k % 4 != 2).then_some(k as i8 % 6 - 3),
        bled: k % 2 == 0,
        bleeding_called: (k % 3 != 0).then_some(k % 2 == 1),
        furcation_truth: None,
        furcation_called: (k % 6 == 1).then_some(k as u8 % 4),
        finding: FINDINGS[k % FINDINGS.len()],
    };
    places.enumerate().map(site).collect()
}

/// Depth and force over time.
pub fn series(probed: bool) -> Series {
    let point = |k: usize| {
        let at = k as f64 * 0.05;
        let zone = (probed && k % 90 > 20).then(|| ([36, 16][k / 400 % 2], Site::ALL[k / 90 % 6]));
        Point {
            zone,
            tick: if zone.is_some() { 50 * k as u64 + 1 } else { 0 },
            depth: if zone.is_some() {
                2.5e-3 * (1.0 + libm::sin(at))
            } else {
                0.0
            },
            force: if zone.is_some() {
                0.2 * (1.0 + libm::cos(0.7 * at))
            } else {
                0.0
            },
            push: 0.25 * (1.0 + libm::sin(0.3 * at)),
            visible: (k > 100).then_some(k % 200 < 150),
        }
    };
    Series((0..2000).map(point).collect())
}
