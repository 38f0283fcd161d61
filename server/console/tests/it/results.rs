//! Recorded sessions: own results of a student, sealed exams, revisions, norms, the class page, erasure.

use std::path::PathBuf;
use std::sync::Arc;

use axum::http::{Method, StatusCode, header};
use serde_json::{Value, json};
use sulcus_console::house::{Erased, Grades, Grading, Recorded, Revised};
use sulcus_proto::control::Instruction;

use crate::house::{Fake, request, router, run, send, sign_in, text};

/// Sessions of the server of a test: learner `s-1` at station `a`, `s-2` at station `b`, and an exam of `s-1`.
pub fn sessions() -> Vec<Recorded> {
    let one = |id: &str, learner: &str, station: &str, mode: &str, score: f64| Recorded {
        id: id.into(),
        learner: learner.into(),
        station: station.into(),
        mode: mode.into(),
        exercise: "probing".into(),
        scene: "00".into(),
        started: "2026-11-26 04:20 UTC".into(),
        seconds: Some(75.0),
        grading: Grading::Graded,
        score: Some(score),
        passed: Some(score >= 70.0),
        ..Recorded::default()
    };
    vec![
        one("one", "s-1", "a", "self-assessment", 61.5),
        one("two", "s-2", "b", "practice", 83.25),
        one("three", "s-1", "a", "exam", 47.75),
    ]
}

/// Sessions with which every request of a permitted role to a route succeeds.
pub fn for_each_route(path: &str) -> Vec<Recorded> {
    let mut all = sessions();
    all.truncate(1);
    if !path.ends_with("/own-score") {
        all[0].mode = "practice".into();
    }
    all
}

fn grade(id: &str) -> Value {
    json!({
        "pass_mark": 70.0,
        "failures": ["<b>late</b>"],
        "metrics": [{ "name": "within", "title": "called within 1 mm", "value": 80.0, "unit": "%", "target": 90.0,
            "weight": 1.0, "score": 61.5, "definition": "share" }],
        "sites": [
            { "tooth": 36, "site": "buccal", "asked": true, "truth_mm": 5.25, "called_mm": if id == "one" { 5 } else { 7 },
              "finding": "right" },
            { "tooth": 36, "site": "lingual", "asked": true, "truth_mm": 3.0, "called_mm": 3, "finding": "right" },
        ],
        "moments": [{ "tick": 9, "at_s": 75.2, "kind": "flag", "text": "<script>x</script>", "by": "t04" }],
    })
}

impl Fake {
    fn change(&self, id: &str, how: impl FnOnce(&mut Recorded)) -> Result<(), String> {
        let mut all = self.recorded.lock().unwrap();
        let one = all.iter_mut().find(|one| one.id == id);
        how(one.ok_or("no such recording")?);
        Ok(())
    }
}

impl Grades for Fake {
    fn all(&self) -> Arc<Vec<Recorded>> {
        Arc::new(self.recorded.lock().unwrap().clone())
    }

    fn grade(&self, id: &str) -> Option<Arc<Value>> {
        Some(Arc::new(grade(id)))
    }

    fn sheet(&self, id: &str) -> Option<String> {
        Some(format!(
            "<html><head><style>p{{}}</style></head><body>sheet of {id}</body></html>"
        ))
    }

    fn file(&self, _: &str) -> Option<PathBuf> {
        Some(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml").into())
    }

    fn replay(&self, id: &str, at_ms: u64) -> Result<Vec<u8>, String> {
        Ok(format!("{id} at {at_ms} ms").into_bytes())
    }

    fn revise(&self, id: &str, revised: Revised) -> Result<(), String> {
        self.change(id, |one| one.revised.push(revised))
    }

    fn assess(&self, id: &str, own: f64) -> Result<(), String> {
        self.change(id, |one| one.own_score = Some(own))
    }

    fn again(&self, id: &str) -> Result<(), String> {
        self.change(id, |one| one.grading = Grading::Waiting)
    }

    fn set_norm(&self, id: &str, is_norm: bool, _: &str) -> Result<(), String> {
        self.change(id, |one| one.is_norm = is_norm)
    }

    fn table(&self, rows: &[Recorded], _: &dyn Fn(&str) -> String) -> Result<String, String> {
        let ids: Vec<&str> = rows.iter().map(|one| one.id.as_str()).collect();
        Ok(ids.join("\n"))
    }

    fn export(&self, ids: &[String]) -> Result<PathBuf, String> {
        let path = std::env::temp_dir().join(format!(
            "sulcus-test-export-{}-{:p}",
            std::process::id(),
            self
        ));
        std::fs::write(&path, ids.join("\n")).map_err(|error| error.to_string())?;
        Ok(path)
    }

    fn erase(&self, _: &str, ids: &[String]) -> Result<Erased, String> {
        let mut all = self.recorded.lock().unwrap();
        let before = all.len();
        all.retain(|one| !ids.contains(&one.id));
        Ok(Erased {
            recordings: before - all.len(),
            files: 0,
        })
    }
}

/// Answer to a request of a signed-in role: status and text.
async fn ask(
    house: &Arc<Fake>,
    role: &str,
    method: Method,
    path: &str,
    body: &str,
) -> (StatusCode, String) {
    let router = router(house);
    let cookie = sign_in(&router, role).await;
    let answer = send(&router, request(&method, path, Some(&cookie), body)).await;
    (answer.status(), text(answer).await)
}

async fn get(house: &Arc<Fake>, role: &str, path: &str) -> (StatusCode, String) {
    ask(house, role, Method::GET, path, "").await
}

#[test]
fn a_student_gives_the_own_score_first_and_sees_no_other_learner() {
    run(async {
        let house = Fake::new();
        let (status, page) = get(&house, "student", "/home").await;
        assert_eq!(status, StatusCode::OK);
        assert!(
            page.contains("own score first") && !page.contains("sealed"),
            "{page}"
        );
        assert!(!page.contains("61.5") && !page.contains("47.75") && !page.contains("s-2"));
        let path = "/results/session/one";
        let (_, page) = get(&house, "student", path).await;
        assert!(
            page.contains("Your own score") && !page.contains("61.5"),
            "{page}"
        );
        let sheet = get(&house, "student", "/results/session/one/sheet").await;
        assert_eq!(sheet.0, StatusCode::FORBIDDEN);
        for (score, status) in [
            ("170", StatusCode::BAD_REQUEST),
            ("70", StatusCode::SEE_OTHER),
        ] {
            let own = format!("{path}/own-score");
            let body = format!("score={score}");
            let found = ask(&house, "student", Method::POST, &own, &body).await;
            assert_eq!(found.0, status, "{score}");
        }
        let (_, page) = get(&house, "student", path).await;
        assert!(page.contains("61.5") && page.contains("70.0"), "{page}");
        // A prescribed depth is for teachers.
        assert!(
            !page.contains("True, mm") && !page.contains("5.2"),
            "{page}"
        );
        let (status, sheet) = get(&house, "student", "/results/session/one/sheet").await;
        assert_eq!(
            (status, sheet.contains("sheet of one")),
            (StatusCode::OK, true)
        );
        for other in [
            "/results/session/two",
            "/results/session/two/sheet",
            "/results/session/none",
        ] {
            assert_eq!(get(&house, "student", other).await.0, StatusCode::NOT_FOUND);
        }
    });
}

#[test]
fn an_exam_is_sealed_for_an_instructor_and_open_for_an_examiner() {
    run(async {
        let house = Fake::new();
        let path = "/results/session/three";
        let (_, page) = get(&house, "instructor", path).await;
        assert!(page.contains("sealed") && !page.contains("47.8"), "{page}");
        let (_, list) = get(&house, "instructor", "/results").await;
        assert!(list.contains("sealed") && !list.contains("47.8"), "{list}");
        let revise = format!("{path}/revise");
        let body = "score=72&passed=yes&reason=x";
        let found = ask(&house, "instructor", Method::POST, &revise, body).await;
        assert_eq!(found.0, StatusCode::FORBIDDEN);
        let file = get(&house, "instructor", "/results/session/three/recording").await;
        assert_eq!(file.0, StatusCode::FORBIDDEN);
        let (_, page) = get(&house, "examiner", path).await;
        assert!(page.contains("47.8"), "{page}");
        let (_, csv) = get(&house, "instructor", "/results/table.csv").await;
        assert_eq!(csv, "one");
    });
}

#[test]
fn a_teacher_of_one_station_sees_that_station() {
    run(async {
        let house = Fake::new();
        let (_, list) = get(&house, "instructor", "/results").await;
        assert!(list.contains("s-1") && !list.contains("s-2"), "{list}");
        let found = get(&house, "instructor", "/results/session/two").await;
        assert_eq!(found.0, StatusCode::NOT_FOUND);
        let (_, list) = get(&house, "admin", "/results?learner=s-2").await;
        assert!(list.contains("83.2") && !list.contains("61.5"), "{list}");
    });
}

#[test]
fn a_revision_stands_beside_the_proposal_and_its_text_stays_text() {
    run(async {
        let house = Fake::new();
        let path = "/results/session/one/revise";
        let body = "score=72.5&passed=yes&reason=%3Cb%3Efinger+rest%3C%2Fb%3E";
        let (status, _) = ask(&house, "instructor", Method::POST, path, body).await;
        assert_eq!(status, StatusCode::SEE_OTHER);
        let (_, page) = get(&house, "instructor", "/results/session/one").await;
        for words in [
            "72.5",
            "61.5",
            "t-instructor",
            "&#60;b&#62;finger rest",
            "&#60;script&#62;",
        ] {
            assert!(page.contains(words), "{words}: {page}");
        }
        assert!(
            !page.contains("<script>x") && !page.contains("<b>late"),
            "{page}"
        );
        for (body, words) in [
            ("score=x&passed=yes&reason=y", "score is `x`"),
            ("score=70&passed=yes&reason=", "reason is empty"),
        ] {
            let (status, page) = ask(&house, "instructor", Method::POST, path, body).await;
            assert_eq!(status, StatusCode::BAD_REQUEST);
            assert!(page.contains(words), "{page}");
        }
        assert_eq!(house.recorded.lock().unwrap()[0].revised.len(), 1);
    });
}

#[test]
fn norms_stand_beside_the_values_of_others() {
    run(async {
        let house = Fake::new();
        let (_, before) = get(&house, "admin", "/results/session/one").await;
        assert!(!before.contains("Experts"));
        let path = "/results/session/two/norm";
        let (status, _) = ask(&house, "admin", Method::POST, path, "norm=yes").await;
        assert_eq!(status, StatusCode::SEE_OTHER);
        let (_, page) = get(&house, "admin", "/results/session/one").await;
        assert!(
            page.contains("Experts (1)") && page.contains("80.00"),
            "{page}"
        );
    });
}

#[test]
fn the_ghost_of_an_exercise_is_its_newest_norm() {
    run(async {
        let house = Fake::new();
        let exercise = house.recorded.lock().unwrap()[1].exercise.clone();
        house.behind[0]
            .status
            .send_modify(|at| at.exercise = exercise);
        let path = "/api/stations/a/instruct";
        let body = r#"{"do":"show_ghost"}"#;
        let (status, why) = ask(&house, "instructor", Method::POST, path, body).await;
        assert_eq!(status, StatusCode::CONFLICT);
        assert!(why.contains("make an expert's session a norm"), "{why}");
        for id in ["one", "two"] {
            house.change(id, |one| one.is_norm = true).unwrap();
        }
        let asked = [
            (body, "two.mcap"),
            (r#"{"do":"show_ghost","text":"other.mcap"}"#, "other.mcap"),
            (r#"{"do":"hide_ghost"}"#, ""),
        ];
        house.recorded.lock().unwrap()[0].mode = "exam".into();
        for (body, file) in asked {
            let (status, why) = ask(&house, "instructor", Method::POST, path, body).await;
            assert_eq!(status, StatusCode::OK, "{why}");
            let given = house.instructed.lock().unwrap().pop().unwrap();
            assert_eq!(given.instruction, Instruction::Ghost(file.into()));
        }
        // Another station's norms are no answer.
        let path = "/api/stations/b/instruct";
        let (status, _) = ask(&house, "instructor", Method::POST, path, body).await;
        assert_eq!(status, StatusCode::NOT_FOUND);
        assert!(house.instructed.lock().unwrap().is_empty());
    });
}

#[test]
fn the_class_page_and_the_comparison_have_the_agreement() {
    run(async {
        let house = Fake::new();
        let (status, page) = get(&house, "admin", "/results/class?exercise=probing").await;
        assert_eq!(status, StatusCode::OK);
        // Readings 5, 7 of 5.25 mm, and 3, 3 of 3 mm: three of four within 1 mm.
        for words in ["75 %", "s-1", "s-2", "<th scope=\"row\">36</th>"] {
            assert!(page.contains(words), "{words}: {page}");
        }
        let (_, choice) = get(&house, "admin", "/results/compare").await;
        assert!(choice.contains("first=one"), "{choice}");
        let (_, page) = get(&house, "admin", "/results/compare?first=one&second=two").await;
        assert!(
            page.contains("more than 1 mm") && page.contains("50 %"),
            "{page}"
        );
        let found = get(&house, "admin", "/results/compare?first=one&second=none").await;
        assert_eq!(found.0, StatusCode::NOT_FOUND);
        house.change("two", |one| one.scene = "11".into()).unwrap();
        let found = get(&house, "admin", "/results/compare?first=one&second=two").await;
        assert_eq!(found.0, StatusCode::BAD_REQUEST);
    });
}

#[test]
fn a_printed_class_has_a_sheet_for_each_session() {
    run(async {
        let house = Fake::new();
        let (_, page) = get(&house, "admin", "/results/print").await;
        for id in ["one", "two", "three"] {
            assert!(page.contains(&format!("sheet of {id}")), "{page}");
        }
        assert_eq!(page.matches("<html").count(), 1);
    });
}

#[test]
fn a_learner_is_exported_whole_and_erased_by_an_administrator_who_types_the_id() {
    run(async {
        let house = Fake::new();
        // The instructor may not see the exam of the learner.
        let (status, page) = get(&house, "instructor", "/learners/s-1/export").await;
        assert_eq!(status, StatusCode::FORBIDDEN, "{page}");
        let (status, bytes) = get(&house, "admin", "/learners/s-1/export").await;
        assert_eq!((status, bytes.as_str()), (StatusCode::OK, "one\nthree"));
        let path = "/learners/s-1/erase";
        let (status, _) = ask(&house, "admin", Method::POST, path, "confirm=s-2").await;
        assert_eq!(status, StatusCode::BAD_REQUEST);
        let (status, _) = ask(&house, "examiner", Method::POST, path, "confirm=s-1").await;
        assert_eq!(status, StatusCode::FORBIDDEN);
        assert_eq!(house.recorded.lock().unwrap().len(), 3);
        let (status, _) = ask(&house, "admin", Method::POST, path, "confirm=s-1").await;
        assert_eq!(status, StatusCode::SEE_OTHER);
        assert_eq!(house.recorded.lock().unwrap().len(), 1);
    });
}

#[test]
fn a_replay_is_opened_once_by_a_path_of_its_own() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let ask = async |method: Method, path: &str, cookie: Option<&str>| {
            let answer = send(&router, request(&method, path, cookie, "")).await;
            (answer.status(), text(answer).await)
        };
        let page = "/results/session/one/replay?at=75.2";
        let (status, shown) = ask(Method::GET, page, Some(&cookie)).await;
        assert_eq!(status, StatusCode::OK);
        assert!(shown.contains("75.2"), "{shown}");
        let open = "/api/results/one/replay?at=75.2";
        let (_, told) = ask(Method::POST, open, Some(&cookie)).await;
        let told: Value = serde_json::from_str(&told).unwrap();
        let path = told["path"].as_str().unwrap();
        let (status, bytes) = ask(Method::GET, path, None).await;
        assert_eq!(
            (status, bytes.as_str()),
            (StatusCode::OK, "one at 75200 ms")
        );
        assert_eq!(ask(Method::GET, path, None).await.0, StatusCode::NOT_FOUND);
        // An exam is sealed, another station's session is not there, and no time is absurd.
        for (path, expected) in [
            ("/api/results/three/replay?at=1", StatusCode::FORBIDDEN),
            ("/api/results/two/replay?at=1", StatusCode::NOT_FOUND),
            ("/api/results/one/replay?at=-1", StatusCode::BAD_REQUEST),
            ("/api/results/one/replay?at=1e300", StatusCode::BAD_REQUEST),
            ("/api/results/one/replay?at=x", StatusCode::BAD_REQUEST),
        ] {
            assert_eq!(
                ask(Method::POST, path, Some(&cookie)).await.0,
                expected,
                "{path}"
            );
        }
    });
}

#[test]
fn a_recording_is_downloaded_under_its_name() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let path = "/results/session/one/recording";
        let answer = send(&router, request(&Method::GET, path, Some(&cookie), "")).await;
        let name = answer.headers()[header::CONTENT_DISPOSITION]
            .to_str()
            .unwrap();
        assert_eq!(name, "attachment; filename=\"one.mcap\"");
        assert!(text(answer).await.contains("sulcus-console"));
    });
}
