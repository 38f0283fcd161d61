//! Exercises as data: what is built in can be read, what is wrong is named, nothing panics.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use sulcus_core::tissue::gingiva::Site;
use sulcus_sessions::WrittenError;
use sulcus_sessions::exercise::{Exercise, Kind};

const PROBING: &str = include_str!("../../exercises/probing.toml");
const BIMANUAL: &str = include_str!("../../exercises/bimanual.toml");

#[test]
fn the_built_in_ones_are_all_there() {
    let all = Exercise::built_in();
    let names: Vec<&str> = all.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["crown", "probing", "retraction", "bimanual"]);
    for one in &all {
        assert!(!one.about.is_empty() && !one.task.is_empty() && !one.scene.is_empty());
    }
    let tour: Vec<(u8, Site)> = all[3].tour().collect();
    assert_eq!(tour.len(), 9);
    assert_eq!(tour[0], (36, Site::DistoBuccal));
    assert_eq!(tour[8], (37, Site::MesioLingual));
    assert_eq!(all[3].target.unwrap().tooth, 37);
    assert_eq!(all[0].probing, Default::default());
}

#[test]
fn a_definition_is_the_exercise_again_whatever_the_seed() {
    for one in Exercise::built_in() {
        for seed in [0, 7, u64::MAX] {
            let text = one.definition(seed).unwrap();
            let again = Exercise::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!(again.seed, Some(seed));
            assert_eq!(
                Exercise {
                    seed: None,
                    ..again.clone()
                },
                one
            );
            assert_eq!(Exercise::recorded(&text), again);
        }
    }
    assert_eq!(Exercise::recorded("seed = ").kind, Kind::Free);
    let free = Exercise::free("hard/wedge", 3.0);
    assert_eq!(
        Exercise::parse(&free.definition(1).unwrap()).unwrap().name,
        "hard/wedge"
    );
}

#[test]
fn what_is_wrong_is_named() {
    let told = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        match Exercise::parse(&text.replace(from, to)) {
            Err(error @ (WrittenError::Field { .. } | WrittenError::Syntax { .. })) => {
                error.to_string()
            }
            other => panic!("{other:?}"),
        }
    };
    for (text, from, to, words) in [
        (
            PROBING,
            "tooth = 36",
            "tooth = 39",
            &["zone[0].tooth is 39", "an FDI number, 11 to 48"][..],
        ),
        (PROBING, "tooth = 36", "tooth = 360", &["tooth"]),
        (
            PROBING,
            "\"buccal\"",
            "\"labial\"",
            &["`labial`", "mesiobuccal", "distolingual"],
        ),
        (
            PROBING,
            "duration_s = 40.0",
            "duration_s = nan",
            &["duration_s is NaN s", "0.1 to 86400 s"],
        ),
        (
            PROBING,
            "duration_s = 40.0",
            "duration_s = 40.0\nspeed = 3",
            &["unknown field `speed`", "duration_s"],
        ),
        (PROBING, "name = \"probing\"", "", &["missing field `name`"]),
        (
            PROBING,
            "name = \"probing\"",
            "name = \"../x\"",
            &["name is `../x`", "letters"],
        ),
        (
            PROBING,
            "kind = \"probing\"",
            "kind = \"scaling\"",
            &["unknown variant `scaling`", "probing"],
        ),
        (
            PROBING,
            "duration_s = 40.0",
            "duration_s = 40.0\nseed = -1",
            &["seed", "0 to 2^64"],
        ),
        (
            PROBING,
            "[[zone]]\ntooth = 36\nsites = [\"distobuccal\", \"buccal\", \"mesiobuccal\"]",
            "",
            &["zone is missing"],
        ),
        (
            BIMANUAL,
            "force_n = [0.2, 0.25]",
            "force_n = [0.25, 0.2]",
            &["probing.force_n is [0.25, 0.2]", "lower bound"],
        ),
        (
            BIMANUAL,
            "force_n = [0.2, 0.25]",
            "force_n = [0.2, 9.0]",
            &["probing.force_n is 9 N", "0.01 to 5 N"],
        ),
        (
            BIMANUAL,
            "[10.0, 32.0]",
            "[10.0, 32.0, 3.0]",
            &[
                "line 20",
                "probing.proximal_tilt_deg: 3 numbers found, 2 expected",
            ],
        ),
        (
            BIMANUAL,
            "eye_mm = [150.0, -250.0, 80.0]",
            "eye_mm = [150,0, -250,0, 80,0]",
            &[
                "target.eye_mm: 6 numbers found, 3 expected",
                "written with a point",
            ],
        ),
        (
            BIMANUAL,
            "eye_mm = [150.0, -250.0, 80.0]",
            "eye_mm = [150.0, -250.0]",
            &["target.eye_mm: 2 numbers found, 3 expected"],
        ),
        (
            BIMANUAL,
            "visible = 0.7",
            "visible = 1.5",
            &["target.visible is 1.5", "0.05 to 1"],
        ),
        (
            BIMANUAL,
            "[150.0, -250.0, 80.0]",
            "[150.0, -250.0, inf]",
            &["target.eye_mm is inf mm"],
        ),
    ] {
        let told = told(text, from, to);
        assert!(words.iter().all(|word| told.contains(word)), "{to}: {told}");
    }
    let long = format!("{PROBING}#{}", "x".repeat(70_000));
    assert!(
        Exercise::parse(&long)
            .unwrap_err()
            .to_string()
            .contains("at most 64 KiB")
    );
    let absent = Exercise::open(std::path::Path::new("no/such.toml"))
        .unwrap_err()
        .to_string();
    assert!(absent.contains("no/such.toml"), "{absent}");
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let text = String::from_utf8_lossy(&bytes);
        let _ = Exercise::parse(&text);
        prop_assert!(Exercise::recorded(&text).validate().is_ok());
    }

    #[test]
    fn damaged_exercises_are_valid_or_refused(at in 0usize..1200, with in any::<u8>(), cut in 0usize..1200) {
        let mut bytes = BIMANUAL.as_bytes().to_vec();
        let n = bytes.len();
        bytes[at % n] = with;
        bytes.truncate(n - cut % n);
        if let Ok(one) = Exercise::parse(&String::from_utf8_lossy(&bytes)) {
            prop_assert!(one.validate().is_ok());
            let again = Exercise::parse(&one.definition(3).unwrap()).unwrap();
            prop_assert_eq!(Exercise { seed: one.seed, ..again }, one);
        }
    }
}
