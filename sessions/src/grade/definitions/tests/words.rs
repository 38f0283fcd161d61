//! Table of the metrics: names, words, numbers in definitions, needs.

use super::*;

#[test]
fn every_metric_has_a_name_of_its_own_and_words() {
    for (k, metric) in METRICS.iter().enumerate() {
        assert_eq!(METRICS.iter().position(|m| m.name == metric.name), Some(k));
        for words in [
            metric.title,
            metric.definition,
            metric.source,
            metric.advice,
        ] {
            assert!(words.len() > 3, "{}: `{words}`", metric.name);
        }
        assert_eq!(find(metric.name).map(|found| found.name), Some(metric.name));
    }
    assert!(find("charm").is_none());
}

#[test]
fn numbers_in_definitions_are_those_of_the_code() {
    use crate::grade::motion::moves;
    use crate::grade::tolerances::{
        CRITICAL_S, EXACT_MM, LEAST_S, PROBED_S, TOUCH_N, TREMOR_N, WITHIN_MM,
    };
    use crate::grade::{crown, pressed, sites, touches, zones};
    let says = |name: &str, what: String| {
        let text = find(name).map_or("", |metric| metric.definition);
        assert!(text.contains(&what), "{name}: `{what}` in `{text}`");
    };
    let mm = |metres: f64| format!("{} mm", (metres * 1e5).round() / 1e2);
    let ms = |seconds: f64| format!("{} ms", seconds * 1e3);
    let most = |mm: f64| format!("at most {} mm from", (mm * 1e3).round() / 1e3);
    says("zones_charted", format!("for {PROBED_S} s or more"));
    says("withdrawals", format!("stay of {PROBED_S} s"));
    says("withdrawals", format!("above for {PROBED_S} s"));
    says(
        "floor_reached",
        format!("no more than {} below", mm(zones::BEYOND)),
    );
    says(
        "misread",
        format!("second is {} mm more than the mean", sites::READ_MM),
    );
    says("called_exact", most(EXACT_MM));
    says("called_within_1mm", most(WITHIN_MM));
    says("recession_within_1mm", most(WITHIN_MM));
    says(
        "angle_mid",
        format!("within {} of the reached", mm(zones::AT_FLOOR)),
    );
    says("touches_too_light", format!("begins at {TOUCH_N} N on"));
    says(
        "touches_too_light",
        format!("for {}", ms(touches::LET_GO_S)),
    );
    says(
        "walking_step",
        format!("moves {} or more along", mm(touches::DRAGGED)),
    );
    says(
        "walking_step",
        format!("less than {} apart", mm(touches::ONE)),
    );
    says("readings_held", format!("for {} s or more", sites::HELD_S));
    says("readings_held", format!("for {} or less", ms(zones::LAPSE)));
    says(
        "readings_too_heavy",
        format!("for {} s or more", sites::PRESSED_S),
    );
    says(
        "readings_too_heavy",
        format!("for {} or less", ms(zones::LAPSE)),
    );
    for name in ["readings_too_heavy", "touches_too_heavy"] {
        says(name, format!("{TREMOR_N} N above"));
    }
    for name in ["mirror_peak", "probe_peak"] {
        says(name, format!("over {}", ms(pressed::PEAK_S)));
        says(name, format!("contact of {TOUCH_N} N or more"));
    }
    for name in ["contact_force", "mirror_force"] {
        says(name, format!("in contact: {TOUCH_N} N or more"));
        says(name, format!("Contact of {LEAST_S} s or of a quarter"));
        says(name, format!("needs {CRITICAL_S} s of contact"));
    }
    says("target_visible", format!("{LEAST_S} s or a quarter"));
    for name in ["force_in_band", "coordination", "crown_covered"] {
        says(name, format!("{TOUCH_N} N or more"));
    }
    says(
        "crown_covered",
        format!("{} or more from the middle", mm(crown::OFF_AXIS)),
    );
    says(
        "crown_covered",
        format!("{} or more in total", ms(crown::LEAST_S)),
    );
    says("crown_covered", format!("highest {}", mm(crown::CROWN)));
    says(
        "crown_covered",
        format!("at most {} outside", mm(crown::BESIDE)),
    );
    says("smoothness", format!("below {TOUCH_N} N"));
    says("smoothness", format!("speed of {}/s", mm(moves::START)));
    says(
        "smoothness",
        format!("after {} s below {}/s", moves::RESTS, mm(moves::STOP)),
    );
    says(
        "smoothness",
        format!(
            "{} s and {} or more",
            moves::LEAST_TIME,
            mm(moves::LEAST_WAY)
        ),
    );
    for name in ["smoothness", "path_length"] {
        says(name, format!("{} Hz", moves::CUT_OFF_HZ));
    }
}

/// A title fits into a column of a page, and no sentence is longer than 30 words.
#[test]
fn titles_are_short_and_sentences_too() {
    for metric in METRICS {
        assert!(metric.title.chars().count() <= 30, "{}", metric.title);
        for text in [metric.definition, metric.advice] {
            for sentence in text.split(['.', ':', ';']) {
                let words = sentence.split_whitespace().count();
                assert!(words <= 30, "{}: {words} words: {sentence}", metric.name);
            }
            assert!(!text.contains("  "), "{}: {text}", metric.name);
            assert!(text.ends_with('.'), "{}: {text}", metric.name);
        }
    }
}

#[test]
fn metrics_apply_where_the_exercise_has_what_they_need() {
    let names = |exercise: &str| -> Vec<&str> {
        let all = Exercise::built_in();
        let exercise = all.iter().find(|one| one.name == exercise);
        let exercise = exercise.unwrap_or_else(|| panic!("built in"));
        let apply = METRICS.iter().filter(|m| m.needs.are_met(exercise));
        apply.map(|m| m.name).collect()
    };
    assert_eq!(
        names("retraction"),
        [
            "target_visible",
            "mirror_force",
            "mirror_peak",
            "smoothness",
            "path_length",
            "time"
        ]
    );
    assert_eq!(
        names("crown"),
        [
            "probe_peak",
            "crown_covered",
            "contact_force",
            "smoothness",
            "path_length",
            "time"
        ]
    );
    assert!(!names("probing").contains(&"coordination"));
    assert_eq!(names("bimanual").len(), METRICS.len() - 2);
}

/// Versions of titles, definitions, sources and advice, with their hashes. A change of words appends the next version.
const WORDS: &[(u32, &str)] = &[(1, "2d16dc6fa59a7ff2"), (2, "907facb04ea99434")];

#[test]
fn the_words_of_all_metrics_are_those_of_the_last_version() {
    let mut hasher = blake3::Hasher::new();
    for metric in METRICS {
        for words in [
            metric.title,
            metric.definition,
            metric.source,
            metric.advice,
        ] {
            hasher.update(&(words.len() as u64).to_le_bytes());
            hasher.update(words.as_bytes());
        }
    }
    let (version, known) = WORDS[WORDS.len() - 1];
    let found = &hasher.finalize().to_hex()[..16];
    assert_eq!(
        found,
        known,
        "the words changed: append the row ({}, \"{found}\") to `WORDS`",
        version + 1
    );
    let versions = WORDS.iter().map(|(version, _)| *version);
    assert!(versions.eq(1..=WORDS.len() as u32));
}
