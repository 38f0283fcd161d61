//! A hand that presses a probe three times as hard as is taught: it reads too deep, and every zone of force that
//! it enters is an event of the recording.

use std::sync::Arc;

use sulcus_connection::progress::Steps;
use sulcus_core::tissue::gingiva::Site;
use sulcus_demo::exercise::{self, Prepared};
use sulcus_demo::{check, lockstep};
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_operator::{HandParams, Operator};
use sulcus_scene::BuiltIn;
use sulcus_sessions::record::occurrence::FORCE_ZONE;
use sulcus_sessions::{Message, Occurrence, Recording, StationKey};

/// Performs with `force` newtons; returns what the check found and the events of the recording.
fn perform(force: f64) -> (check::Checked, Vec<Occurrence>) {
    let scene = exercise::compile(None, BuiltIn::Pocket, None, &Steps)
        .expect("built in")
        .scene;
    let params = TourParams {
        duration: 18.0,
        force,
        turn_force: 0.65 * force,
        ..TourParams::default()
    };
    // (The distal midline of this scene lies deeper than its distobuccal site.)
    let tour = [Visit {
        tooth: 36,
        sites: vec![Site::MesioBuccal, Site::Buccal],
    }];
    let script = Tour::new(&scene, &tour, params).expect("a pocket");
    let operator = Operator::new(Box::new(script), HandParams::default(), 5);
    let mut prepared = Prepared {
        exercise: exercise::find("probing").expect("built in"),
        scene_bytes: Arc::new(scene.to_bytes().expect("bytes")),
        scene: Arc::new(scene),
        patient: String::new(),
        ticks: operator.ticks(),
        until_done: false,
        mode: sulcus_sessions::Mode::default(),
        learner: String::new(),
        operator,
        case: None,
        warnings: Vec::new(),
    };
    let folder = tempfile::tempdir().expect("a folder");
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, 5, folder.path(), key, &Steps).expect("runs");
    let checked = check::check(&ran.recording, &Steps).expect("replays");
    let recording = Recording::open(&ran.recording).expect("opens");
    let events = recording.messages().filter_map(|message| {
        let Message::Event(event) = message.expect("sound") else {
            return None;
        };
        Occurrence::parse(&event.text).filter(|said| said.kind == FORCE_ZONE)
    });
    (checked, events.collect())
}

#[test]
fn a_heavy_hand_reads_too_deep_and_the_record_says_so() {
    let (checked, events) = perform(0.6);
    assert!(checked.report.identical, "{:?}", checked.report);
    let pocket = checked.pocket().expect("it was in the pocket");
    assert!(pocket.too_heavy >= 1 && pocket.trauma >= 1, "{pocket:?}");
    assert_eq!(pocket.damage, 0, "{pocket:?}");
    let count = |zone: &str| {
        let of = |said: &&Occurrence| said.data["zone"] == zone;
        events.iter().filter(of).count() as u64
    };
    assert_eq!(
        [count("too_heavy"), count("trauma"), count("damage")],
        [pocket.too_heavy, pocket.trauma, pocket.damage]
    );
    // Each event is in the row's tick, in order.
    assert!(events.windows(2).all(|pair| pair[0].tick <= pair[1].tick));
    assert!(events.iter().all(|said| {
        let force = said.data["floor_force_n"].as_f64().expect("newtons");
        force >= 0.25 && said.data["tool"] == 0
    }));
    let deepest = pocket
        .sites
        .iter()
        .map(|site| site.deepest_mm - site.truth_mm)
        .fold(f64::NEG_INFINITY, f64::max);
    // (0.6 - 0.225) N on a floor of 0.5 N/mm.
    assert!((0.4..=1.1).contains(&deepest), "{pocket:?}");
}

#[test]
fn a_light_hand_damages_nothing() {
    let (checked, events) = perform(0.2);
    assert!(checked.report.identical);
    let pocket = checked.pocket().expect("it was in the pocket");
    assert_eq!((pocket.trauma, pocket.damage), (0, 0), "{pocket:?}");
    assert_eq!(events.len() as u64, pocket.too_heavy);
}
