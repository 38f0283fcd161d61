//! Layouts of whole panels, over sizes, scales and states.

use super::*;
use crate::handed::Person;
use crate::readings::{Key, Readings, Site, Stop};
use crate::strings::ENGLISH;
use proptest::prelude::*;

fn tour(keys: &str) -> Tour {
    let stops = Site::ALL.map(|site| Stop { tooth: 36, site });
    let mut readings = Readings::new(stops.to_vec());
    for key in keys.chars().filter_map(Key::from_char) {
        readings.press(key);
    }
    Tour::of(&readings, Some(crate::readings::Wrong::Proximal))
}

/// State in which every part of the panel has something to say.
fn full(mode: Mode) -> PanelState {
    let mut probe = ToolForce {
        name: "UNC-15 probe".into(),
        force_n: 0.3172,
        zone_n: Some([0.2, 0.25]),
        trace: Trace::default(),
    };
    for k in 0..VALUES {
        probe.trace.push(0.002 * k as f32);
    }
    let mirror = ToolForce {
        name: "Mirror".into(),
        force_n: 1.0441,
        ..ToolForce::default()
    };
    PanelState {
        mode,
        clock: Clock {
            elapsed_s: 83.0,
            length_s: Some(180.0),
        },
        tour: Some(tour("5br-2\r3f2sr10")),
        status: Status {
            link: Link::Up(Some(12)),
            recording: Recording::On,
            paused_by_student: true,
            paused_by_station: true,
            force_limit_n: Some(2.75),
            person: Some(Person::default()),
            message: Some("A little flatter, please, and rest the finger on the crown.".into()),
            warnings: vec![
                Warning::NoForce("mouse".into()),
                Warning::SlowPicture,
                Warning::Other("The disk of the station is nearly full".into()),
                Warning::Other("Fourth".into()),
            ],
        },
        help: Help {
            title: "bimanual".into(),
            task: "Hold the tongue aside with the mirror, and walk the probe round the tooth."
                .into(),
            tools: vec![probe, mirror],
            depth_mm: Some(7.43),
            detail: Detail::Low,
        },
    }
}

fn texts(panel: &Panel) -> Vec<String> {
    let text = |one: &Primitive| match one {
        Primitive::Glyphs { text, .. } => Some(text.clone()),
        Primitive::Rect { .. } => None,
    };
    panel.list.iter().filter_map(text).collect()
}

/// Panics if a primitive leaves the window or two texts overlap.
fn check(panel: &Panel, window: [u32; 2], what: &str) {
    let [width, height] = window.map(|pixels| pixels as f32);
    let is_text = |one: &&Primitive| matches!(one, Primitive::Glyphs { .. });
    for one in &panel.list {
        let [min, max] = one.bounds();
        let inside = min[0] >= 0.0 && min[1] >= 0.0 && max[0] <= width && max[1] <= height;
        assert!(
            inside && min[0] < max[0] && min[1] < max[1],
            "{what}: {one:?}"
        );
    }
    let texts: Vec<&Primitive> = panel.list.iter().filter(is_text).collect();
    for (k, a) in texts.iter().enumerate() {
        let [a_min, a_max] = a.bounds();
        for b in &texts[k + 1..] {
            let [b_min, b_max] = b.bounds();
            let apart = |axis: usize| a_max[axis] <= b_min[axis] || b_max[axis] <= a_min[axis];
            assert!(apart(0) || apart(1), "{what}: {a:?} {b:?}");
        }
    }
}

const WINDOWS: [[u32; 2]; 8] = [
    [640, 360],
    [800, 600],
    [1024, 768],
    [1280, 720],
    [1920, 1080],
    [2560, 1440],
    [1080, 1920],
    [3840, 2160],
];

#[test]
fn every_window_and_scale_holds_the_panel() {
    for window in WINDOWS {
        for scale in [1.0, 1.25, 1.5, 2.0, 2.5, 3.0] {
            for mode in [Mode::Practice, Mode::Exam] {
                let what = format!("{window:?} {scale} {mode:?}");
                let panel = layout(&full(mode), window, scale, &ENGLISH);
                check(&panel, window, &what);
                let all = texts(&panel).join("\n");
                for always in [
                    "Link 12 ms",
                    "Recording",
                    "Paused",
                    "Limit 2.75 N",
                    "Paused by you",
                    "mouse",
                    "Time 1:23 of 3:00",
                    "Tooth 36 buccal",
                ] {
                    assert!(all.contains(always), "{what}: {always} in {all}");
                }
                // The gauge of the mirror may find no room, but shows in an exam never.
                assert!(
                    mode == Mode::Practice || !all.contains("1.04 N"),
                    "{what}: {all}"
                );
                for practice in ["0.32 N 32 g", "heavy", "Depth 7.4 mm", "The session"] {
                    assert_eq!(
                        all.contains(practice),
                        mode == Mode::Practice,
                        "{what}: {practice} in {all}"
                    );
                }
            }
        }
    }
}

/// A clinic's paper has no force and no measured depth.
#[test]
fn an_exam_does_not_depend_on_any_help() {
    let with = full(Mode::Exam);
    let without = PanelState {
        help: Help::default(),
        ..with.clone()
    };
    for window in WINDOWS {
        let panel = |state| layout(state, window, 1.0, &ENGLISH);
        assert_eq!(panel(&with), panel(&without), "{window:?}");
    }
    let practice = full(Mode::Practice);
    let window = [1280, 720];
    let bare = PanelState {
        help: Help::default(),
        ..practice.clone()
    };
    assert_ne!(
        layout(&practice, window, 1.0, &ENGLISH),
        layout(&bare, window, 1.0, &ENGLISH)
    );
}

#[test]
fn an_exam_shows_time_and_site_and_own_findings_alone() {
    let mut state = full(Mode::Exam);
    state.status = Status {
        link: Link::Up(None),
        recording: Recording::On,
        ..Status::default()
    };
    state.tour = Some(Tour {
        wrong: None,
        ..tour("")
    });
    let panel = layout(&state, [1280, 720], 1.0, &ENGLISH);
    let expected = [
        "Link",
        "Recording",
        "Running",
        "Limit of the scene",
        "Time 1:23 of 3:00",
        "Tooth 36 mesiobuccal",
        "Entered: nothing yet",
    ];
    assert_eq!(texts(&panel), expected);
}

#[test]
fn states_have_words_of_their_own() {
    let shown = |change: fn(&mut Status)| {
        let mut state = full(Mode::Exam);
        change(&mut state.status);
        texts(&layout(&state, [1920, 1080], 1.0, &ENGLISH)).join("\n")
    };
    for (change, words) in [
        (
            (|s| s.link = Link::Returning) as fn(&mut Status),
            "Link lost, trying again",
        ),
        (|s| s.link = Link::Lost, "No link"),
        (|s| s.recording = Recording::Off, "Not recorded"),
        (|s| s.recording = Recording::Failed, "Recording failed"),
        (|s| s.paused_by_student = false, "Paused by the instructor"),
        (|s| s.paused_by_station = false, "Paused by you"),
        (|s| s.force_limit_n = None, "Limit of the scene"),
    ] {
        assert!(shown(change).contains(words), "{words}");
        assert!(!shown(|_| {}).lines().any(|line| line == words), "{words}");
    }
}

#[test]
fn the_picture_keeps_most_of_the_window() {
    for window in WINDOWS {
        let [width, height] = window.map(|pixels| pixels as f32);
        for mode in [Mode::Practice, Mode::Exam] {
            let free = layout(&full(mode), window, 1.0, &ENGLISH).free;
            let share = free.width() * free.height() / (width * height);
            assert!(share > 0.5, "{window:?} {mode:?} {share}");
        }
    }
}

/// Words of other languages are longer. German has about a third more letters.
#[test]
fn longer_words_find_room() {
    let mut long = ENGLISH.clone();
    long.sites = ["mesial-vestibulär (zur Wange hin)"; 6];
    long.steps.press_less =
        "Deutlich zu fest aufgedrückt: bitte sofort nachlassen, auf weniger als {0} N.";
    long.ratings = ["kein Kontakt", "zu leicht", "richtig", "viel zu schwer"];
    long.status.link = "Verbindung zum Server, {0} ms";
    long.status.recording = "Aufzeichnung der Sitzung läuft";
    long.status.limit = "Höchste Kraft an der Hand {0} N";
    for window in WINDOWS {
        for mode in [Mode::Practice, Mode::Exam] {
            let panel = layout(&full(mode), window, 1.0, &long);
            check(&panel, window, "long words");
            let all = texts(&panel).join("\n");
            assert!(
                all.contains("12 ms") && all.contains("2.75 N"),
                "{window:?} {all}"
            );
        }
    }
}

/// Lesson of three tasks on a probe with marks at each millimetre, answered `off` millimetres from the right number.
fn answered(off: &[i16]) -> crate::trainer::Lesson {
    use crate::trainer::{Lesson, Rule};
    let mark = |k: u8| sulcus_proto::display::DisplayBand {
        from: f32::from(k) * 1e-3,
        to: f32::from(k + 1) * 1e-3,
        dark: k == 4,
    };
    let bands: Vec<_> = (3..10).map(mark).collect();
    let mut lesson = Lesson::new(&bands, Rule::default(), 4, 3).expect("bands");
    for off in off {
        let right = lesson
            .task()
            .map(|task| Rule::default().whole_mm(task.tenths));
        let said = i16::from(right.expect("a task")) + off;
        lesson.answer(u8::try_from(said).expect("a depth"));
    }
    lesson
}

#[test]
fn a_lesson_asks_and_in_practice_says_what_was_right() {
    for window in WINDOWS {
        for scale in [1.0, 2.0, 3.0] {
            let all = |off: &[i16], mode| {
                let panel = lesson(&answered(off), mode, window, scale, &ENGLISH);
                check(&panel, window, "a lesson");
                texts(&panel).join(" ")
            };
            let first = all(&[], Mode::Practice);
            assert!(first.starts_with("Task 1 of 3 Which depth"), "{first}");
            assert_eq!(first, all(&[], Mode::Exam));
            let wrong = all(&[1], Mode::Practice);
            assert!(wrong.contains("would be right"), "{wrong}");
            assert!(all(&[0], Mode::Practice).contains("Right:"));
            assert_eq!(all(&[1], Mode::Exam), all(&[0], Mode::Exam));
            let end = all(&[0, 2, 0], Mode::Practice);
            assert!(
                end.contains("67 % right, 67 %") && end.contains("+0.7 mm"),
                "{end}"
            );
            assert!(end.contains("too deep"), "{end}");
            assert_eq!(all(&[0, 2, 0], Mode::Exam), "The lesson is over.");
        }
    }
}

proptest! {
    #[test]
    fn any_window_and_any_numbers_stay_inside(
        width in 0u32..4000, height in 0u32..2400, scale in 0.1f32..4.0, exam in any::<bool>(),
        force_n in any::<f64>(), depth in any::<f64>(), zone in any::<[f64; 2]>(), elapsed_s in any::<f64>(),
        name in ".{0,60}", values in proptest::collection::vec(any::<f32>(), 0..200),
    ) {
        let mut state = full(if exam { Mode::Exam } else { Mode::Practice });
        state.clock.elapsed_s = elapsed_s;
        state.help.depth_mm = Some(depth);
        state.status.warnings[0] = Warning::NoForce(name.clone());
        state.help.task = name.clone();
        let tool = &mut state.help.tools[0];
        (tool.force_n, tool.zone_n, tool.name) = (force_n, Some(zone), name);
        for value in values {
            tool.trace.push(value);
        }
        let panel = layout(&state, [width, height], scale, &ENGLISH);
        check(&panel, [width, height], "any");
    }
}
