//! Which patient a session was with is in its recording.
#![allow(clippy::unwrap_used)]

use sulcus_connection::progress::Steps;
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::{check, lockstep};
use sulcus_scene::anatomy::patient::{Condition, generate};
use sulcus_sessions::{Recording, StationKey};

#[test]
fn the_seed_makes_the_patient_and_the_recording_names_it() {
    let asked = Asked {
        duration_s: Some(1.0),
        patient_seed: Some(7),
        ..Asked::of("bimanual")
    };
    let mut prepared = exercise::prepare(&asked, &Steps).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, 1, folder.path(), key, &Steps).unwrap();
    // Too short for either hand to get to work: recorded and replayed all the same.
    assert_eq!(ran.ticks, 1000);
    assert!(
        check::check(&ran.recording, &Steps)
            .unwrap()
            .report
            .identical
    );
    let recording = Recording::open(&ran.recording).unwrap();
    let seventh = generate(7, Condition::Periodontitis);
    assert_eq!(recording.header().patient, seventh.to_toml());
    assert_ne!(
        recording.header().patient,
        generate(1, Condition::Periodontitis).to_toml()
    );
}

#[test]
fn what_a_patient_lacks_is_left_out_and_said() {
    // The thirty-ninth has lost 36, which the exercise begins with.
    assert!(generate(39, Condition::Periodontitis).missing.contains(&36));
    let asked = Asked {
        duration_s: Some(1.0),
        patient_seed: Some(39),
        ..Asked::of("bimanual")
    };
    let prepared = exercise::prepare(&asked, &Steps).unwrap();
    let told = prepared.warnings.join("\n");
    assert!(told.contains("a pocket at tooth 36"), "{told}");
    assert!(!told.contains("tooth 37"), "{told}");
}
