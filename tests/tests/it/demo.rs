//! The main job from outside: demo, recording, replay.

use sulcus_sessions::Recording;
use sulcus_tests::{Place, Program, rows};

const FIELDS: [&str; 10] = [
    "recording",
    "ticks",
    "deadline_misses",
    "tick_us",
    "rtt_us",
    "max_residual_um",
    "exhausted",
    "lost",
    "late",
    "grade",
];

#[test]
fn the_virtual_demo_is_recorded_and_replays_bit_for_bit() {
    let place = Place::new();
    let demo = place
        .run(
            Program::Client,
            &[
                "demo",
                "--virtual",
                "--exercise",
                "crown",
                "--duration",
                "5",
                "--json",
            ],
        )
        .ok()
        .json();
    for field in FIELDS {
        assert!(demo.get(field).is_some(), "`{field}` is missing in {demo}");
    }
    assert_eq!(demo["ticks"], 5000);
    assert!(demo["rtt_us"].is_null());
    let score = demo["grade"]["score"].as_f64().expect("a score");
    assert!((0.0..=100.0).contains(&score), "{demo}");
    assert_eq!(demo["identical"], true);
    assert!(
        demo["max_residual_um"].as_f64().expect("a number") <= 1.0,
        "{demo}"
    );
    assert!(
        demo["max_force_n"].as_f64().expect("a number") > 0.05,
        "it never touched: {demo}"
    );

    let file = place.recording();
    let file = file.to_str().expect("a plain path");
    let replay = place
        .run(Program::Sessions, &["replay", "--audit", "--json", file])
        .ok()
        .json();
    assert_eq!(
        (&replay["ticks"], &replay["identical"]),
        (&5000.into(), &true.into()),
        "{replay}"
    );
    assert!(replay["first_divergent_tick"].is_null(), "{replay}");
    let info = place.run(Program::Sessions, &["info", file]).ok();
    assert!(info.stdout.contains("crown"), "{info:#?}");
}

#[test]
fn depths_and_grade_are_not_shown_before_an_own_score_is_given() {
    let place = Place::new();
    let demo = [
        "demo",
        "--virtual",
        "--exercise",
        "probing",
        "--duration",
        "12",
        "--json",
    ];
    let own = [&demo[..], &["--mode", "self-assessment"]].concat();
    let shown = place.run(Program::Client, &own).ok().json();
    assert_eq!(shown["mode"], "self-assessment", "{shown}");
    assert!(
        shown["pocket"].is_null() && shown["grade"].is_null(),
        "{shown}"
    );
    assert_eq!(shown["events"]["calls"], serde_json::json!([]), "{shown}");
    let file = place.recording();
    let file = file.to_str().expect("plain");
    let sessions = Program::Sessions;
    place
        .run(sessions, &["grade", file])
        .refused(&["--self-score is missing", "expected 0 to 100"]);
    let grade = ["grade", file, "--self-score", "40", "--json"];
    let grade = place.run(sessions, &grade).ok().json();
    assert_eq!(grade["self_score"], 40.0, "{grade}");
    // There was something to be withheld.
    let sites = grade["sites"].as_array().expect("sites");
    assert!(
        sites.iter().any(|site| site["called_mm"].is_u64()),
        "{grade}"
    );
    assert!(grade["score"].is_f64(), "{grade}");
}

#[test]
fn the_same_seed_gives_the_same_session_and_another_seed_another() {
    let hashes = |seed: &str| {
        let place = Place::new();
        place
            .run(
                Program::Client,
                &["demo", "--virtual", "--duration", "2", "--seed", seed],
            )
            .ok();
        let recording = Recording::open(&place.recording()).expect("opens");
        let rows = rows(&recording);
        rows.iter().map(|row| row.hash).collect::<Vec<u64>>()
    };
    let (a, b, c) = (hashes("7"), hashes("7"), hashes("8"));
    assert_eq!(a.len(), 2000);
    assert!(a == b, "the same seed must give the same hashes");
    assert!(a != c, "another seed must give others");
}

/// The rate is a parameter of the scene: it travels in the recording, and server and client keep it.
#[test]
fn a_session_at_another_rate_is_recorded_and_replays() {
    for how in [&["--virtual"][..], &[]] {
        let place = Place::new();
        let rest = [
            "--duration",
            "2",
            "--exercise",
            "crown",
            "--rate-hz",
            "4000",
            "--json",
        ];
        let args: Vec<&str> = ["demo"].iter().chain(how).chain(&rest).copied().collect();
        let demo = place.run(Program::Client, &args).ok().json();
        let of = |field: &str| demo[field].as_u64().expect("a number");
        assert_eq!(
            (of("rate_hz"), &demo["identical"]),
            (4000, &true.into()),
            "{demo}"
        );
        if how.is_empty() {
            lies_on_a_grid_of(250_000, &place);
        } else {
            assert_eq!(of("ticks"), 8000, "{demo}");
        }
    }
    let place = Place::new();
    let slow = [
        "demo",
        "--virtual",
        "--exercise",
        "crown",
        "--rate-hz",
        "100",
    ];
    let refused = place.run(Program::Client, &slow);
    refused.refused(&["rate_hz", "100", "250 to 8000"]);
}

/// Asserts that the ticks of the live recording lie on a grid of the clock, whatever the machine has skipped: a tick
/// begins after its point and before the next one.
fn lies_on_a_grid_of(period_ns: u64, place: &Place) {
    let rows = rows(&Recording::open(&place.recording()).expect("opens"));
    let (first, last) = (rows.first().expect("rows"), rows.last().expect("rows"));
    assert!(first.tick < last.tick, "{} rows", rows.len());
    let by_number_ns = (last.tick - first.tick) * period_ns;
    let by_clock_ns = last.time_unix_ns - first.time_unix_ns;
    assert!(
        by_number_ns.abs_diff(by_clock_ns) <= period_ns,
        "{by_number_ns} ns by the numbers of the ticks, {by_clock_ns} ns by the clock"
    );
}

#[test]
fn the_judge_in_the_tick_replays_too() {
    let place = Place::new();
    let demo = [
        "demo",
        "--virtual",
        "--duration",
        "2",
        "--solver",
        "clarabel",
        "--json",
    ];
    let demo = place.run(Program::Client, &demo).ok().json();
    assert_eq!(demo["identical"], true, "{demo}");
    assert!(
        demo["max_residual_um"].as_f64().expect("a number") <= 1.0,
        "{demo}"
    );
}

#[test]
fn a_debug_build_replays_what_a_release_build_recorded_with_either_solver() {
    let place = Place::new();
    for solver in ["active-set", "clarabel"] {
        let folder = format!("recordings/{solver}");
        let demo = [
            "demo",
            "--virtual",
            "--duration",
            "3",
            "--solver",
            solver,
            "--recordings",
            &folder,
            "--json",
        ];
        let demo = place.run(Program::Client, &demo).ok().json();
        assert_eq!(demo["identical"], true, "{demo}");
        let file = place.path(demo["recording"].as_str().expect("a path"));
        let replay = place
            .run(
                Program::Sessions,
                &["replay", "--json", file.to_str().expect("plain")],
            )
            .ok()
            .json();
        assert_eq!(
            (&replay["ticks"], &replay["identical"]),
            (&3000.into(), &true.into()),
            "{solver}: {replay}"
        );
    }
}

#[test]
fn a_hard_case_can_be_performed() {
    let place = Place::new();
    let demo = place
        .run(
            Program::Client,
            &["demo", "--virtual", "--exercise", "hard/wedge", "--json"],
        )
        .ok()
        .json();
    assert_eq!(demo["identical"], true, "{demo}");
    assert!(
        demo["max_residual_um"].as_f64().expect("a number") <= 1.0,
        "{demo}"
    );
}

#[test]
fn the_live_demo_loses_nothing_silently_and_replays() {
    let place = Place::new();
    let demo = place
        .run(Program::Client, &["demo", "--duration", "4", "--json"])
        .ok()
        .json();
    let (ticks, skipped) = (
        demo["ticks"].as_u64().expect("ticks"),
        demo["skipped"].as_u64().expect("skipped"),
    );
    assert!(ticks > 0, "{demo}");
    // On a busy machine ticks are missed; what matters is that each is accounted for.
    let recorded = rows(&Recording::open(&place.recording()).expect("opens"));
    assert_eq!(recorded.len() as u64, ticks, "{demo}");
    let mut tick = 0;
    for row in &recorded {
        tick += 1 + u64::from(row.input.skipped);
        assert_eq!(row.tick, tick, "{demo}");
    }
    assert_eq!(tick, ticks + skipped, "{demo}");
    assert!(
        demo["deadline_misses"].as_u64().expect("misses") >= skipped,
        "{demo}"
    );
    assert_eq!(demo["identical"], true, "{demo}");
    assert!(
        demo["rtt_us"]["p50"].as_f64().expect("a time") > 0.0,
        "{demo}"
    );
    assert!(
        demo["max_residual_um"].as_f64().expect("a number") <= 1.0,
        "{demo}"
    );

    let replay = place.run(
        Program::Sessions,
        &[
            "replay",
            "--json",
            place.recording().to_str().expect("plain"),
        ],
    );
    assert_eq!(replay.ok().json()["ticks"], demo["ticks"]);
}

#[test]
fn a_real_tooth_runs_through_the_demo() {
    let Some(mesh) = sulcus_support::data("meshes/tooth_36_first_molar.stl") else {
        return;
    };
    let place = Place::new();
    let scene = format!(
        "name = \"real tooth\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\nlevel = 3\nlevels = 4\n\
         park_mm = [3.0, 21.0, 125.0]\n[[object]]\nname = \"tooth 36\"\nfdi = 36\nmesh = {mesh:?}\nunit = \"mm\"\n\
         level = 3\nlevels = 4\ntissue = \"rigid\"\n"
    );
    std::fs::write(place.path("real.toml"), scene).expect("writes");
    let demo = [
        "demo",
        "--virtual",
        "--exercise",
        "crown",
        "--duration",
        "5",
        "--scene",
        "real.toml",
        "--json",
    ];
    let demo = place.run(Program::Client, &demo).ok().json();
    assert_eq!(
        (&demo["identical"], &demo["scene"]),
        (&true.into(), &"real tooth".into()),
        "{demo}"
    );
    assert!(
        demo["max_residual_um"].as_f64().expect("a number") <= 1.0,
        "{demo}"
    );
    assert!(
        demo["max_force_n"].as_f64().expect("a number") > 0.05,
        "{demo}"
    );
}

/// The first command ended in numbers alone; the page with chart and advice took another command.
#[test]
fn a_demo_writes_the_students_page_and_says_how_to_look_at_the_session() {
    let place = Place::new();
    let demo = [
        "demo",
        "--virtual",
        "--exercise",
        "probing",
        "--duration",
        "3",
    ];
    let ended = place.run(Program::Client, &demo).ok();
    let recording = place.recording();
    let page = recording.with_extension("html");
    let last: Vec<&str> = ended.stdout.lines().rev().take(12).collect();
    let named = format!("{}", page.file_name().expect("a name").display());
    assert!(last.iter().any(|line| line.contains(&named)), "{ended:#?}");
    assert!(
        last.iter().any(|line| line.contains("--bin sulcus-review")),
        "{ended:#?}"
    );
    // The page of `grade --html`, byte for byte.
    let file = recording.to_str().expect("plain");
    let grade = ["grade", file, "--html", "pages"];
    place.run(Program::Sessions, &grade).ok();
    let other = place.path("pages").join(&named);
    let [ours, other] = [page, other].map(|path| std::fs::read_to_string(path).expect("a page"));
    assert!(ours.contains("<svg") && ours == other);

    // What is not shown after an exam is not on a page either.
    let place = Place::new();
    let exam = [&demo[..], &["--mode", "exam", "--json"]].concat();
    let said = place.run(Program::Client, &exam).ok().json();
    assert!(said["page"].is_null() && said["page_error"].is_null());
    assert!(!place.recording().with_extension("html").exists());
    let place = Place::new();
    let said = place
        .run(Program::Client, &[&demo[..], &["--json"]].concat())
        .ok()
        .json();
    assert!(place.path(said["page"].as_str().expect("a page")).is_file());
}
