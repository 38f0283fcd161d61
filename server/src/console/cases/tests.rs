use super::*;
use crate::plan::PlanChange;
use crate::state::folder::fresh;

fn generated(condition: &str) -> Origin {
    Origin::Generated {
        condition: condition.into(),
        seed: 7,
    }
}

#[test]
fn a_case_is_made_changed_by_the_form_and_removed() {
    let (_place, state) = fresh();
    let cases = OwnCases::of(Some(&state));
    cases
        .create("a", &generated("periodontitis"), "t-1")
        .expect("creates");
    cases
        .create("b", &Origin::Copy("a".into()), "t-1")
        .expect("copies");
    let first = cases.load("a").expect("loads");
    assert_eq!(first.case.state, "new");
    let mut chart = first.case.chart.clone().expect("a chart");
    chart.teeth[0].depth_mm.buccal[0] = 6.0;
    let saved = cases
        .save("a", &first.version, &chart, "t-1")
        .expect("saves");
    assert_eq!(saved.case.chart.as_ref(), Some(&chart));
    assert_ne!(saved.version, first.version);
    // A second instructor with the former version.
    let error = cases
        .save("a", &first.version, &chart, "t-2")
        .expect_err("a conflict");
    assert!(matches!(error, Refused::Conflict(_)), "{error}");
    let names = |cases: &OwnCases| -> Vec<String> {
        let all = cases.list().expect("a list");
        all.into_iter().map(|case| case.name).collect()
    };
    assert_eq!(names(&cases), ["a", "b"]);
    cases.remove("a", "t-1").expect("removes");
    assert_eq!(names(&cases), ["b"]);
    assert!(matches!(cases.load("a"), Err(Refused::Unknown(_))));
}

#[test]
fn a_fault_is_at_its_field_and_stops_a_compilation() {
    let (_place, state) = fresh();
    let cases = OwnCases::of(Some(&state));
    cases
        .create("a", &generated("healthy"), "t-1")
        .expect("creates");
    let loaded = cases.load("a").expect("loads");
    let mut chart = loaded.case.chart.expect("a chart");
    assert_eq!(cases.check(&chart), []);
    let at = chart.teeth.iter().position(|tooth| tooth.fdi == 36);
    let tooth = &mut chart.teeth[at.expect("a molar")];
    tooth.depth_mm.lingual[2] = 11.0;
    tooth.mobility = 5;
    // A papilla above the contact point.
    chart.teeth[0].recession_mm.buccal[0] = -4.0;
    let found = cases.check(&chart);
    let place = |fault: &FieldFault| (fault.fdi, fault.site, fault.key.clone());
    let places: Vec<_> = found.iter().map(place).collect();
    let expected = [
        (Some(36), Some(("lingual", 2)), "depth_mm".to_owned()),
        (Some(36), None, "mobility".to_owned()),
        (Some(47), Some(("buccal", 0)), "recession_mm".to_owned()),
    ];
    assert_eq!(places, expected, "{found:?}");
    let saved = cases.save("a", &loaded.version, &chart, "t-1");
    assert_eq!(saved.expect("saves").case.state, "faulty");
    let error = cases.compile("a", "t-1").expect_err("a fault");
    assert!(error.to_string().contains("depth_mm"), "{error}");
    assert_eq!(cases.work(), Work::default());
}

#[test]
fn comments_of_a_teacher_survive_the_form() {
    let (_place, state) = fresh();
    let cases = OwnCases::of(Some(&state));
    let store = CaseStore::open(&state).expect("a store");
    let text = "# Second year, autumn.\nname = \"one\"\n[[tooth]]\nfdi = 36 # the exercise\n";
    store.create("a", text).expect("creates");
    let loaded = cases.load("a").expect("loads");
    let mut chart = loaded.case.chart.expect("a chart");
    chart.missing.push(37);
    chart.teeth.retain(|tooth| tooth.fdi != 37);
    cases
        .save("a", &loaded.version, &chart, "t-1")
        .expect("saves");
    let text = store.text("a").expect("text");
    assert!(
        text.contains("# Second year, autumn.") && text.contains("# the exercise"),
        "{text}"
    );
    assert!(text.contains("missing = [37]"), "{text}");
}

#[test]
fn the_plan_of_a_case_is_one_that_stations_read() {
    let (_place, state) = fresh();
    let cases = OwnCases::of(Some(&state));
    cases
        .create("a", &generated("healthy"), "t-1")
        .expect("creates");
    let error = cases.plan("a", "bimanual").expect_err("not compiled");
    assert!(matches!(error, Refused::Conflict(_)), "{error}");
    let store = CaseStore::open(&state).expect("a store");
    crate::cases::store::test_scene(&store, "a");
    let text = cases.plan("a", "bimanual").expect("a plan");
    let change = PlanChange::parse(&text, std::path::Path::new("plan")).expect("a change");
    assert_eq!(change.exercise.as_deref(), Some("bimanual"));
    assert_eq!(change.scene, Some(store.scene("a")));
    let error = cases.plan("a", "crown").expect_err("another scene");
    assert!(matches!(error, Refused::Bad("exercise", _)), "{error}");
    assert!(exercises().len() >= 3, "{:?}", exercises());
}

#[test]
fn without_a_state_folder_a_sentence_says_so() {
    let cases = OwnCases::of(None);
    assert!(matches!(cases.list(), Err(Refused::Fault(_))));
    assert!(matches!(
        cases.create("a", &generated("healthy"), "t"),
        Err(Refused::Fault(_))
    ));
    assert!(!cases.model().conditions.is_empty());
}

#[test]
fn names_and_conditions_are_refused_with_their_field() {
    let (_place, state) = fresh();
    let cases = OwnCases::of(Some(&state));
    for (name, condition, field) in [("../a", "healthy", "name"), ("a", "severe", "condition")] {
        let error = cases.create(name, &generated(condition), "t-1");
        let error = error.expect_err(name);
        assert!(
            matches!(error, Refused::Bad(found, _) if found == field),
            "{error}"
        );
    }
}
