//! Devices that do not display a force, and what their sessions are graded by.

use sulcus_sessions::exercise::events::may_a_client_say;
use sulcus_sessions::grade::{Grade, Lack, Options};
use sulcus_sessions::{
    DeviceFacts, Exercise, Mode, Occurrence, Recording, Rubric, SessionHeader, info,
};

use super::place::{Place, of, plain, record_with};
use crate::common::key;

/// The session of the crown exercise with a device, in a mode.
fn graded(device: DeviceFacts, mode: Mode) -> Grade {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    record_with(&path, 3000, key(), 0, with(device, mode));
    plain(std::fs::read(path).unwrap())
}

fn with(device: DeviceFacts, mode: Mode) -> impl Fn(&mut SessionHeader, &mut Vec<String>) {
    move |header, _| {
        header.devices = vec![device.clone()];
        header.mode = Some(mode);
    }
}

fn stylus() -> DeviceFacts {
    DeviceFacts {
        name: "stylus".into(),
        library: "haply".into(),
        motion_axes: 6,
        force_axes: 3,
        torque_axes: 3,
        force_dof: 6,
        friction_n: 0.05,
        ..DeviceFacts::default()
    }
}

fn mouse() -> DeviceFacts {
    DeviceFacts {
        name: "mouse".into(),
        library: "mouse".into(),
        motion_axes: 6,
        ..DeviceFacts::default()
    }
}

#[test]
fn a_device_with_force_and_torque_leaves_no_trace_in_a_grade() {
    let grade = graded(stylus(), Mode::Practice);
    let old = graded(
        DeviceFacts {
            name: "stylus".into(),
            ..DeviceFacts::default()
        },
        Mode::Practice,
    );
    assert!(grade.unfelt.is_empty() && grade.score.is_some());
    assert_eq!(grade.to_json(), old.to_json());
    let text = grade.to_json().to_string();
    assert!(!text.contains("unfelt") && !text.contains("not_judged"));
}

#[test]
fn a_session_by_mouse_is_not_judged_by_force() {
    let felt = graded(stylus(), Mode::Practice);
    let grade = graded(mouse(), Mode::Practice);
    assert!(grade.gradable && grade.score.is_some());
    for name in ["contact_force", "probe_peak"] {
        let (metric, judged) = (grade.metric(name).unwrap(), felt.metric(name).unwrap());
        assert_eq!((metric.score, metric.deducted), (None, 0.0), "{name}");
        assert!(judged.score.is_some() && judged.not_judged.is_none());
        // The value is that of the replay.
        assert_eq!(metric.value, judged.value);
        assert_eq!(
            metric.not_judged.as_deref(),
            Some("device `mouse` of the rod displays no force")
        );
    }
    let covered = grade.metric("crown_covered").unwrap();
    assert!(covered.score.is_some() && covered.not_judged.is_none());
    assert!(!grade.failures.iter().any(|why| why.contains("force")));
    assert_eq!(grade.unfelt.len(), 1);
    assert_eq!(grade.unfelt[0].lacks, Lack::Force);
    assert_eq!(grade.unfelt[0].metrics, ["contact_force", "probe_peak"]);
    let text = grade.text(false, false);
    assert!(
        text.contains("WARNING    not felt by the hand: device `mouse`"),
        "{text}"
    );
    assert!(text.contains("not judged"), "{text}");
    let last = grade.advice.last().unwrap();
    assert_eq!(last.metric, "contact_force");
    assert!(last.text.starts_with("Not judged: "), "{}", last.text);
    let json = grade.to_json();
    assert_eq!(json["unfelt"][0]["lacks"], "force");
    assert_eq!(json, graded(mouse(), Mode::Practice).to_json());
}

#[test]
fn friction_and_missing_torque_are_named() {
    let touch = |friction_n| DeviceFacts {
        torque_axes: 0,
        friction_n,
        ..stylus()
    };
    // The rubric asks for 0.6 N at the crown.
    let grade = graded(touch(0.26), Mode::Practice);
    assert_eq!(grade.unfelt.len(), 1);
    assert_eq!(grade.unfelt[0].lacks, Lack::Torque);
    assert!(grade.unfelt[0].metrics.is_empty());
    assert!(grade.metric("contact_force").unwrap().score.is_some());
    let grade = graded(touch(0.7), Mode::Practice);
    let lacks: Vec<Lack> = grade.unfelt.iter().map(|one| one.lacks).collect();
    assert_eq!(lacks, [Lack::Torque, Lack::Friction]);
    assert_eq!(grade.unfelt[1].metrics, ["contact_force"]);
    let why = grade.metric("contact_force").unwrap().not_judged.clone();
    assert_eq!(
        why.as_deref(),
        Some(
            "device `stylus` of the rod has a friction of 0.7 N in free space, expected at most the 0.6 N that the hand must feel"
        )
    );
}

/// A rubric by which any session passes, but for critical errors.
fn easy() -> Options {
    let mut rubric = Rubric::of(&Exercise::built_in()[0]).unwrap();
    rubric.pass_mark = 0.0;
    for metric in &mut rubric.metrics {
        (metric.pass, metric.deduct) = (None, None);
    }
    Options {
        rubric: Some(rubric),
        ..Options::default()
    }
}

#[test]
fn an_exam_without_force_is_neither_passed_nor_failed_by_what_is_left() {
    let graded = |device: DeviceFacts, mode| {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.mcap");
        record_with(&path, 3000, key(), 0, with(device, mode));
        of(std::fs::read(path).unwrap(), &easy())
    };
    let (practice, exam) = (graded(mouse(), Mode::Practice), graded(mouse(), Mode::Exam));
    assert_eq!(exam.score, practice.score);
    assert_eq!(practice.passed, Some(true), "{:?}", practice.failures);
    assert_eq!((exam.passed, exam.verdict()), (None, Some("not decided")));
    assert!(exam.text(true, false).contains("NOT DECIDED"));
    assert_eq!(graded(stylus(), Mode::Exam).passed, Some(true));
}

/// A session that begins with a stylus and goes on with a mouse.
#[test]
fn another_device_after_a_gap_counts_too() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    record_with(&path, 3000, key(), 0, |header, log| {
        header.devices = vec![stylus()];
        log.push(Occurrence::devices_changed(100, &[mouse()]).to_string());
    });
    let recording = Recording::open(&path).unwrap();
    let told = info(&path, &recording).unwrap();
    assert_eq!(told.later_devices, [mouse()]);
    assert!(
        told.to_string().contains("  later      tool 0: mouse"),
        "{told}"
    );
    drop(recording);
    let grade = plain(std::fs::read(path).unwrap());
    assert_eq!(grade.unfelt.len(), 1, "{:?}", grade.unfelt);
    assert!(grade.metric("contact_force").unwrap().score.is_none());
    // Only a station may say so.
    assert!(!may_a_client_say("devices_changed"));
}

#[test]
fn the_page_names_what_is_not_judged() {
    let place = Place::new();
    let path = place.path("a.mcap");
    record_with(&path, 3000, key(), 0, with(mouse(), Mode::Practice));
    let (code, _, said) = place.run(&["grade", "a.mcap", "--html", "pages"]);
    assert_eq!(code, 0, "{said}");
    let pages = std::fs::read_dir(place.path("pages")).unwrap();
    let pages = pages.map(|page| page.unwrap().path());
    let pages = pages.filter(|page| page.extension().is_some_and(|is| is == "html"));
    let text: String = pages
        .map(|page| std::fs::read_to_string(page).unwrap())
        .collect();
    for words in [
        "not felt by the hand: device `mouse` of the rod displays no force",
        "Not judged, because the hand did not feel the force: probe force at the crown; peak force on the probe.",
        "Repeat the exercise with a device",
    ] {
        assert!(text.contains(words), "{words}");
    }
}
