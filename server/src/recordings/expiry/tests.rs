//! Old recordings: exactly the expected ones go, by a clock that can be believed, and their grades stay.

use sulcus_sessions::record::predecessor::Predecessor;
use sulcus_sessions::record::statement::SessionEnd;
use sulcus_sessions::{Mode, Recorder, SessionHeader, StationKey};

use super::super::norms::Norm;
use super::*;
use crate::state::classes::change::Target;
use crate::state::classes::task::Wanted;
use crate::state::date::now_s;
use crate::state::folder::fresh;

/// A school with a class that keeps recordings for 30 days, and a class that keeps them forever.
struct School {
    place: tempfile::TempDir,
    state: StateFolder,
    classes: Classes,
    recordings: PathBuf,
    now_s: u64,
}

impl School {
    fn new() -> Self {
        let (place, state) = fresh();
        let classes = Classes::of(&state, "t-1");
        let now_s = now_s();
        let roster = b"learner,class\ns-1,Year 4\ns-2,Year 4\ns-3,Year 5\n";
        classes.import(roster, "", None, now_s).expect("imports");
        classes.keep_recordings("c-1", Some(30)).expect("sets");
        let recordings = place.path().join("recordings");
        std::fs::create_dir(&recordings).expect("makes");
        Self {
            place,
            state,
            classes,
            recordings,
            now_s,
        }
    }

    fn days_ago(&self, days: u64) -> u64 {
        self.now_s - days * DAY_S
    }

    /// Finished recording of a session that began so many days ago; its name.
    fn recorded(&self, learner: &str, days: u64, mode: Mode) -> String {
        self.recorded_at(learner, self.days_ago(days), mode, None)
    }

    fn recorded_at(&self, learner: &str, began_s: u64, mode: Mode, before: Option<&str>) -> String {
        let mut header = SessionHeader::new(Vec::new());
        header.exercise_name = "probing".into();
        header.learner_id = learner.into();
        header.mode = Some(mode);
        header.started_unix_ns = began_s * 1_000_000_000;
        header.predecessor =
            before.map(|name| Predecessor::of(&self.recordings.join(name)).expect("a recording"));
        let key = StationKey::from_seed([7; 32]);
        let (recorder, path) =
            Recorder::create_in(&self.recordings, &header, &key).expect("creates");
        recorder.finish(SessionEnd::default()).expect("finishes");
        std::fs::write(sulcus_sessions::grade::revision::beside(&path), "{}").expect("writes");
        file_name(&path)
    }

    fn expiry(&self, open: &[&str]) -> Expiry<'_> {
        Expiry {
            state: &self.state,
            recordings: &self.recordings,
            by: "shell (uid 0)",
            open: open.iter().map(|name| (*name).to_owned()).collect(),
        }
    }

    /// Verdict of a recording.
    fn verdict(&self, open: &[&str], name: &str) -> Result<String, Kept> {
        let all = self.expiry(open).judged(self.now_s).expect("reads");
        let has = |one: &&Judged| one.files.iter().any(|file| file_name(file) == name);
        let one = all.iter().find(has).expect(name);
        one.verdict.clone().map(|(class, _)| class)
    }

    fn names(&self) -> BTreeSet<String> {
        let files = std::fs::read_dir(&self.recordings).expect("lists");
        let names = files.map(|file| file_name(&file.expect("a file").path()));
        names.filter(|name| name.ends_with(".mcap")).collect()
    }

    fn log(&self, action: &str) -> Vec<String> {
        let all = self
            .classes
            .audit()
            .newest(1000)
            .expect("reads")
            .into_iter();
        let own = all.filter(|one| one.action == action);
        own.map(|one| one.object).collect()
    }
}

fn gone() -> Result<String, Kept> {
    Ok("c-1".into())
}

#[test]
fn exactly_the_old_sessions_of_the_class_go_and_their_grades_stay() {
    let school = School::new();
    let old = school.recorded("s-1", 31, Mode::Practice);
    let young = school.recorded("s-1", 29, Mode::Practice);
    let forever = school.recorded("s-3", 900, Mode::Practice);
    let nobody = school.recorded("", 900, Mode::Practice);
    let unknown = school.recorded("s-9", 900, Mode::Practice);
    let norm = school.recorded("s-2", 40, Mode::Practice);
    let open = school.recorded("s-2", 41, Mode::Practice);
    std::fs::write(school.recordings.join("noise.mcap"), "noise").expect("writes");
    let grades = school.state.file(GRADES);
    let made = Norms::of(&grades).change(|norms| {
        norms.push(Norm {
            id: norm.trim_end_matches(".mcap").into(),
            by: "t-1".into(),
            at_unix_s: 1,
        });
    });
    made.expect("a norm");
    let id = old.trim_end_matches(".mcap");
    std::fs::write(grades.join(format!("{id}.json")), "{}").expect("writes");
    for (name, expected) in [
        (&old, gone()),
        (&young, Err(Kept::Young)),
        (&forever, Err(Kept::NoLimit)),
        (&nobody, Err(Kept::Unattributed)),
        (&unknown, Err(Kept::Unattributed)),
        (&norm, Err(Kept::Norm)),
        (&open, Err(Kept::Open)),
    ] {
        assert_eq!(school.verdict(&[&open], name), expected, "{name}");
    }
    let expiry = school.expiry(&[&open]);
    let judged = expiry.judged(school.now_s).expect("reads");
    let (before, log) = (school.names(), school.log("expire recording"));
    assert_eq!(
        (before.len(), log.len()),
        (8, 0),
        "a judgement changes nothing"
    );
    assert_eq!(expiry.remove(&judged, school.now_s).expect("removes"), 1);
    let left: BTreeSet<String> = before.into_iter().filter(|name| *name != old).collect();
    assert_eq!(school.names(), left);
    let log = school.log("expire recording");
    assert_eq!(log.len(), 1);
    assert!(
        log[0].contains(&old) && log[0].contains("class c-1"),
        "{log:?}"
    );
    assert_eq!(school.log("expire recordings"), ["1 removed"]);
    let beside = school.recordings.join(format!("{old}.grade.json"));
    assert!(beside.is_file(), "scores of persons");
    assert!(grades.join(format!("{id}.json")).is_file(), "the grade");
    assert!(
        expired::path(&grades, id).is_file(),
        "facts for the results"
    );
    // A second call has nothing to do.
    let judged = expiry.judged(school.now_s).expect("reads");
    assert_eq!(expiry.remove(&judged, school.now_s).expect("nothing"), 0);
}

#[test]
fn an_exam_stays_until_its_release_also_in_an_archived_class_and_for_another_learner() {
    let school = School::new();
    let class = Target::Class("c-1".into());
    let exam = Wanted {
        exercise: "probing".into(),
        case: None,
        mode: Mode::Exam,
        time_limit_s: None,
    };
    let assign = |wanted: Option<&Wanted>, days| {
        let assigned = school
            .classes
            .assign(&class, wanted, true, school.days_ago(days));
        assigned.expect("assigns");
    };
    assign(Some(&exam), 50);
    assign(None, 45);
    let sat = school.recorded("s-1", 48, Mode::Exam);
    let practice = school.recorded("s-2", 48, Mode::Practice);
    let alone = school.recorded("s-1", 60, Mode::Exam);
    assert_eq!(school.verdict(&[], &sat), Err(Kept::Exam));
    assert_eq!(school.verdict(&[], &practice), gone());
    assert_eq!(school.verdict(&[], &alone), Err(Kept::Exam), "of no class");
    // An entry about another learner opens nothing.
    school
        .classes
        .import(b"learner,class\ns-4,Year 4\n", "", None, school.now_s)
        .expect("imports");
    school
        .classes
        .reassign(&sat, "s-4", "wrong seat", school.now_s)
        .expect("an entry");
    assert_eq!(school.verdict(&[], &sat), Err(Kept::Exam));
    // A session of a class forever does not go by the class of another learner.
    school
        .classes
        .reassign(&practice, "s-3", "wrong seat", school.now_s)
        .expect("an entry");
    assert_eq!(school.verdict(&[], &practice), Err(Kept::NoLimit));
    school
        .classes
        .archive("c-1", school.now_s)
        .expect("archives");
    assert_eq!(school.verdict(&[], &sat), Err(Kept::Exam));
    school
        .classes
        .release("e-1", school.now_s)
        .expect("releases");
    assert_eq!(school.verdict(&[], &sat), gone());
}

#[test]
fn a_session_of_two_recordings_goes_whole_and_stays_whole() {
    let school = School::new();
    let first = school.recorded("s-1", 33, Mode::Practice);
    let began = school.days_ago(32);
    let second = school.recorded_at("s-1", began, Mode::Practice, Some(&first));
    assert_eq!(school.verdict(&[], &first), gone());
    assert_eq!(school.verdict(&[&second], &first), Err(Kept::Open));
    // Two sessions that continue one recording need it both.
    let fork = school.recorded_at("s-1", began + 60, Mode::Practice, Some(&first));
    assert_eq!(school.verdict(&[], &second), Err(Kept::Shared));
    std::fs::remove_file(school.recordings.join(&fork)).expect("removes");
    // A part of another learner makes the whole unclear.
    school
        .classes
        .reassign(&first, "s-2", "wrong seat", school.now_s)
        .expect("an entry");
    assert_eq!(school.verdict(&[], &second), Err(Kept::Unattributed));
    school
        .classes
        .reassign(&first, "s-1", "right seat", school.now_s)
        .expect("an entry");
    let expiry = school.expiry(&[]);
    let judged = expiry.judged(school.now_s).expect("reads");
    assert_eq!(expiry.remove(&judged, school.now_s).expect("removes"), 2);
    assert!(school.names().is_empty());
    assert_eq!(school.log("expire recording").len(), 2);
}

#[test]
fn a_wrong_clock_removes_nothing() {
    let school = School::new();
    let young = school.recorded("s-1", 1, Mode::Practice);
    let old = school.recorded("s-1", 300, Mode::Practice);
    let expiry = school.expiry(&[]);
    let refused = |now_s: u64, words: &str| {
        let judged = expiry.judged(now_s).expect("reads");
        let error = expiry.check_clock(&judged, now_s).expect_err(words);
        assert!(error.to_string().contains(words), "{error}");
        judged
    };
    // Set back by a year: recordings are from the future, and nothing is old.
    let judged = refused(school.days_ago(365), "the audit log has an entry of");
    assert!(judged.iter().all(|one| one.verdict == Err(Kept::Future)));
    // Set forward by three years: everything is old, and the clock is refused.
    let judged = refused(school.now_s + 3 * 365 * DAY_S, "more than a year before");
    assert!(judged.iter().all(|one| one.verdict.is_ok()));
    let judged = expiry.judged(school.now_s).expect("reads");
    expiry.check_clock(&judged, school.now_s).expect("right");
    // A recording from the time of a wrong clock.
    let future = school.recorded_at("s-1", school.now_s + 9 * DAY_S, Mode::Practice, None);
    let judged = refused(school.now_s, &future);
    assert_eq!(school.verdict(&[], &future), Err(Kept::Future));
    // A person who has checked the clock removes the old one alone.
    assert_eq!(expiry.remove(&judged, school.now_s).expect("removes"), 1);
    assert_eq!(school.names(), BTreeSet::from([young, future]));
    assert!(!school.place.path().join("recordings").join(old).exists());
}
