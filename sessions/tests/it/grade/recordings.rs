//! What gets a grade and what gets none: recordings forged, cut off and incomplete; rubrics; what an instructor says.

use sulcus_sessions::grade::report::Source;
use sulcus_sessions::grade::revision::{Proposal, Revision, Sidecar, beside};
use sulcus_sessions::grade::{Grade, Options};
use sulcus_sessions::{Exercise, Row, Rubric, StationKey};

use super::place::{Place, of, plain, record, record_with};
use crate::common::{key, with_messages};

#[test]
fn a_sound_session_is_graded_by_what_the_replay_felt() {
    let place = Place::new();
    let path = place.session();
    let grade = plain(std::fs::read(&path).unwrap());
    assert!(grade.gradable, "{:?}", grade.reason);
    // The rod presses 1 to 2 mm with 500 N/m: far too heavy for a light hand.
    let force = grade.metric("contact_force").unwrap();
    assert!((0.3..2.0).contains(&force.value.unwrap()), "{force:?}");
    assert_eq!(grade.rubric.as_ref().unwrap().source, Source::Recording);
    // By hand: the score is the mean by weight of the metrics' scores, less what essentials cost.
    let weights = grade.metrics.iter().filter(|m| m.score.is_some());
    let (sum, all) = weights.fold((0.0, 0.0), |(sum, all), m| {
        (sum + m.weight * m.score.unwrap(), all + m.weight)
    });
    let less: f64 = grade.metrics.iter().map(|metric| metric.deducted).sum();
    assert!((grade.score.unwrap() - (sum / all - less).max(0.0)).abs() < 0.11);
}

#[test]
fn a_forged_wrench_buys_no_grade() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    let honest = plain(bytes.clone());
    // Every wrench in the file made as good as none; nobody can sign that but the station.
    let forged = with_messages(&bytes, |topic, data| {
        if topic == "/exact/ticks"
            && let Some(mut row) = Row::from_bytes(data)
        {
            row.wrench = row.wrench.map(|wrench| wrench.map(|x| x * 0.01));
            *data = row.to_bytes().to_vec();
        }
        true
    });
    let grade = plain(forged);
    assert!(honest.score.is_some());
    assert_eq!(
        (grade.gradable, grade.score, grade.passed),
        (false, None, None)
    );
    assert!(
        grade
            .reason
            .unwrap()
            .contains("the replay differs from tick")
    );
    assert!(grade.metrics.is_empty() && grade.sites.is_empty());
}

#[test]
fn what_is_cut_off_incomplete_or_signed_by_another_gets_none_and_says_why() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    let cut = plain(bytes[..bytes.len() * 2 / 3].to_vec());
    assert!(cut.score.is_none());
    assert!(cut.reason.unwrap().contains("cut off"));
    let lost = place.path("lost.mcap");
    record(&lost, 500, key(), 3);
    let lost = plain(std::fs::read(&lost).unwrap());
    assert!(lost.reason.unwrap().contains("3 rows were dropped"));
    let trusted = Options {
        trust: Some(key().public()),
        ..Options::default()
    };
    assert!(of(bytes.clone(), &trusted).score.is_some());
    let other = Options {
        trust: Some(StationKey::from_seed([1; 32]).public()),
        ..Options::default()
    };
    let refused = of(bytes, &other);
    assert!(refused.score.is_none());
    assert!(refused.reason.unwrap().contains("not the trusted key"));
    // It was asked for, and is not the one.
    assert!(!refused.signer_trusted);
}

#[test]
fn another_rubric_is_used_when_given_and_the_output_says_so() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    let exercise = Exercise::built_in().remove(0);
    let mut strict = Rubric::of(&exercise).unwrap();
    strict.version = 9;
    strict.pass_mark = 100.0;
    let options = Options {
        rubric: Some(strict),
        ..Options::default()
    };
    let grade = of(bytes, &options);
    let used = grade.rubric.clone().unwrap();
    assert_eq!((used.version, used.source), (9, Source::File));
    assert!(grade.text(true, false).contains("GIVEN INSTEAD"));
    assert_eq!(grade.passed, Some(false));
}

#[test]
fn an_instructors_word_is_added_and_the_proposal_stays() {
    let place = Place::new();
    let path = place.session();
    let grade = plain(std::fs::read(&path).unwrap());
    let said = |score: f64, reason: &str| Revision {
        score,
        passed: score >= 70.0,
        by: "t04".into(),
        at: "2026-11-23".into(),
        reason: reason.into(),
    };
    assert_eq!(Sidecar::read(&path).unwrap(), None);
    // The printed grade has the same proposal.
    let printed = Proposal::of_json(&grade.to_json());
    assert_eq!(printed, Some(Proposal::of(&grade)));
    let first = Sidecar::add(&path, &Proposal::of(&grade), said(80.0, "device slipped")).unwrap();
    let second = Sidecar::add(&path, &Proposal::of(&grade), said(75.0, "seen again")).unwrap();
    assert_eq!(first.proposal, second.proposal);
    assert_eq!(second.proposal.score, grade.score);
    assert_eq!(second.revisions[..1], first.revisions);
    assert_eq!(second.latest().unwrap().score, 75.0);
    assert_eq!(Sidecar::read(&path).unwrap(), Some(second.clone()));
    for (revision, words) in [
        (said(101.0, "x"), "score is 101, expected 0 to 100"),
        (said(50.0, " "), "reason is 1 bytes long"),
    ] {
        let told = Sidecar::add(&path, &Proposal::of(&grade), revision)
            .unwrap_err()
            .to_string();
        assert!(told.contains(words), "{told}");
    }
    let other = Grade {
        learner_id: "b1".into(),
        ..grade.clone()
    };
    let told = Sidecar::add(&path, &Proposal::of(&other), said(50.0, "x")).unwrap_err();
    assert!(told.to_string().contains("of learner `a7f3`"), "{told}");
    assert_eq!(Sidecar::read(&path).unwrap(), Some(second));
    std::fs::write(beside(&path), "{}").unwrap();
    assert!(Sidecar::read(&path).is_err());
}

/// A client that was cut off got a grade that said nothing of it.
#[test]
fn a_session_that_ended_early_says_so_in_its_grade() {
    let place = Place::new();
    let path = place.path("lost.mcap");
    record_with(&path, 3000, key(), 0, |_, log| {
        log.push("session ended: ConnectionLost".into());
    });
    let grade = plain(std::fs::read(&path).unwrap());
    assert_eq!(
        grade.ended_early,
        Some("the connection to the client was lost, or closed by the client")
    );
    assert!(grade.score.is_some());
    let (_, table, _) = place.run(&["grade", "lost.mcap", "--html", "pages"]);
    assert!(
        table.contains("WARNING    ended early: the connection"),
        "{table}"
    );
    let page = std::fs::read_to_string(place.path("pages/lost.html")).unwrap();
    assert!(page.contains("ended early: the connection"));
}

/// One metric that a later program calls otherwise took the whole grade of a recording.
#[test]
fn a_recorded_rubric_is_graded_by_as_far_as_its_metrics_are_known() {
    let place = Place::new();
    let path = place.path("old.mcap");
    record_with(&path, 3000, key(), 0, |header, _| {
        let text = header.rubric.replace("\"probe_peak\"", "\"probe_push\"");
        let was = "Largest mean of the force on the probe";
        assert!(text != header.rubric && text.contains(was));
        // And another one that was defined otherwise.
        header.rubric = text.replace("Share of twelve sectors", "Share of six sectors");
    });
    let grade = plain(std::fs::read(&path).unwrap());
    assert!(grade.score.is_some(), "{:?}", grade.reason);
    let used = grade.rubric.clone().unwrap();
    assert_eq!(
        (used.unknown, used.redefined),
        (
            vec!["probe_push".to_owned()],
            vec!["crown_covered".to_owned()]
        )
    );
    let covered = grade.metric("crown_covered").unwrap();
    assert!(covered.definition.contains("twelve sectors"));
    assert!(
        covered
            .recorded_definition
            .as_ref()
            .unwrap()
            .contains("six sectors")
    );
    let text = grade.text(false, false);
    for words in [
        "unknown to this program, without value and critical error: probe_push",
        "definition differs from the recorded one: crown_covered",
    ] {
        assert!(text.contains(words), "{text}");
    }
}
