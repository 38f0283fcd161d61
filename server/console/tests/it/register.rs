//! Classes, seats, exams and the audit log from outside: every action, wrong values, wrong roles, names as text.

mod fake;

use axum::http::{Method, StatusCode, header};
use sulcus_console::house::register::{Change, Denied, NewLearner, Target, Task};
use sulcus_proto::control::Instruction;

use fake::task;
pub use fake::{Calls, NAME};

use crate::house::{Fake, request, router, run, send, sign_in, text};

/// Body with which a permitted request of a path succeeds.
pub fn body(path: &str) -> &'static str {
    match path {
        "/classes" => "name=Autumn",
        "/classes/import" => "roster=sourcedId%0A1&class=B&hash=h",
        "/classes/{class}/name" => "name=Winter",
        "/classes/{class}/remove" | "/classes/{class}/learners/{learner}/remove" => "sure=yes",
        "/classes/{class}/plan" | "/classes/{class}/learners/{learner}/plan" => {
            "task=case%3Acase3&mode=practice"
        }
        "/classes/{class}/codes" | "/classes/{class}/learners/{learner}/code" => "hours=4",
        "/classes/{class}/learners" => "given=Ada&family=Lovelace&username=ada",
        "/seats" => "station=a&learner=s-1",
        "/seats/reassign" => "recording=a.mcap&learner=s-1&why=wrong+seat",
        "/exams/{exam}/seal" => "until=2026-12-01",
        "/exams/{exam}/release" => "sure=yes",
        _ => "",
    }
}

#[test]
fn each_form_makes_its_change_in_the_name_of_the_person() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "examiner").await;
        let (class, learner) = ("c-1".to_owned(), "s-1".to_owned());
        let case = Task {
            time_limit_s: None,
            ..task("practice")
        };
        let assign = |target: Target, task: Option<Task>| Change::Assign { target, task };
        let forms: [(&str, &str, &str, Change); 14] = [
            (
                "/classes",
                "name=A%26B",
                "/classes/c-1",
                Change::Make { name: "A&B".into() },
            ),
            (
                "/classes/c-1/name",
                "name=C",
                "/classes/c-1",
                Change::Rename {
                    class: class.clone(),
                    name: "C".into(),
                },
            ),
            (
                "/classes/c-1/plan",
                "task=case%3Acase3&from=list",
                "/classes",
                assign(Target::Class(class.clone()), Some(case)),
            ),
            (
                "/classes/c-1/plan",
                "task=",
                "/classes/c-1",
                assign(Target::Class(class.clone()), None),
            ),
            (
                "/classes/c-1/learners/s-1/plan",
                "task=case%3Acase3&exercise=probing&mode=exam&minutes=30",
                "/classes/c-1",
                assign(Target::Learner(learner.clone()), Some(task("exam"))),
            ),
            (
                "/classes/c-1/learners",
                "given=+Ada+&username=ada",
                "/classes/c-1",
                Change::Add {
                    class: class.clone(),
                    learner: NewLearner {
                        given: "Ada".into(),
                        username: "ada".into(),
                        ..NewLearner::default()
                    },
                },
            ),
            (
                "/classes/c-1/learners",
                "learner=s-9",
                "/classes/c-1",
                Change::Add {
                    class: class.clone(),
                    learner: NewLearner {
                        id: "s-9".into(),
                        ..NewLearner::default()
                    },
                },
            ),
            (
                "/classes/c-1/learners/s-1/remove",
                "sure=yes",
                "/classes/c-1",
                Change::Drop {
                    class: class.clone(),
                    learner: learner.clone(),
                },
            ),
            (
                "/classes/c-1/remove",
                "sure=yes",
                "/classes",
                Change::Remove { class },
            ),
            (
                "/seats",
                "station=a&learner=s-1",
                "/seats",
                Change::Seated {
                    station: "a".into(),
                    learner: learner.clone(),
                },
            ),
            (
                "/seats/reassign",
                "recording=a.mcap&learner=s-1&why=x",
                "/seats",
                Change::Reassign {
                    recording: "a.mcap".into(),
                    learner,
                    why: "x".into(),
                },
            ),
            (
                "/exams/e-1/seal",
                "until=2026-12-01",
                "/exams",
                Change::Seal {
                    exam: "e-1".into(),
                    until: "2026-12-01".into(),
                },
            ),
            (
                "/exams/e-1/seal",
                "",
                "/exams",
                Change::Seal {
                    exam: "e-1".into(),
                    until: String::new(),
                },
            ),
            (
                "/exams/e-1/release",
                "sure=yes",
                "/exams",
                Change::Release { exam: "e-1".into() },
            ),
        ];
        for (path, body, to, expected) in forms {
            let answer = send(&router, request(&Method::POST, path, Some(&cookie), body)).await;
            assert_eq!(answer.status(), StatusCode::SEE_OTHER, "{path} {body}");
            assert_eq!(answer.headers()[header::LOCATION], to, "{path}");
            let made = house.registered.changes.lock().unwrap().pop();
            assert_eq!(
                made,
                Some(("t-examiner".to_owned(), true, expected)),
                "{path} {body}"
            );
        }
    });
}

#[test]
fn a_refused_change_shows_its_page_with_the_reason() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let why = || "name is `<b>`, expected another".to_owned();
        for (denied, status) in [
            (Denied::Unknown(why()), StatusCode::NOT_FOUND),
            (Denied::Invalid(why()), StatusCode::BAD_REQUEST),
            (Denied::Forbidden(why()), StatusCode::FORBIDDEN),
            (Denied::Changed(why()), StatusCode::CONFLICT),
            (Denied::Fault(why()), StatusCode::INTERNAL_SERVER_ERROR),
        ] {
            for (path, body, shown) in [
                ("/classes", "name=x", "New class"),
                ("/classes/c-1/name", "name=x", "Plan of the class"),
                (
                    "/classes/c-1/plan",
                    "task=exercise%3Acrown",
                    "Plan of the class",
                ),
                (
                    "/classes/c-1/plan",
                    "task=exercise%3Acrown&from=list",
                    "New class",
                ),
                (
                    "/seats/reassign",
                    "recording=a&learner=s-1&why=x",
                    "another learner",
                ),
            ] {
                *house.registered.denies.lock().unwrap() = Some(denied.clone());
                let answer = send(&router, request(&Method::POST, path, Some(&cookie), body)).await;
                assert_eq!(answer.status(), status, "{path}");
                let page = text(answer).await;
                assert!(
                    page.contains("name is `&#60;b&#62;`") && page.contains(shown),
                    "{path}: {page}"
                );
            }
        }
        assert!(house.registered.changes.lock().unwrap().is_empty());
    });
}

#[test]
fn wrong_forms_change_nothing_and_say_why() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        for (path, body, status, named) in [
            (
                "/classes",
                "",
                StatusCode::UNPROCESSABLE_ENTITY,
                "missing field `name`",
            ),
            (
                "/classes/c-1/plan",
                "task=crown",
                StatusCode::BAD_REQUEST,
                "task is `crown`",
            ),
            (
                "/classes/c-1/plan",
                "task=case%3Ax&minutes=0",
                StatusCode::BAD_REQUEST,
                "`0`, expected 1 to 1440",
            ),
            (
                "/classes/c-1/remove",
                "",
                StatusCode::BAD_REQUEST,
                "tick the box",
            ),
            (
                "/classes/c-1/learners/s-1/remove",
                "sure=no",
                StatusCode::BAD_REQUEST,
                "tick the box",
            ),
            (
                "/exams/e-1/release",
                "",
                StatusCode::BAD_REQUEST,
                "tick the box",
            ),
            (
                "/classes/c-1/codes",
                "hours=x",
                StatusCode::UNPROCESSABLE_ENTITY,
                "hours",
            ),
            (
                "/classes/c-1/codes",
                "hours=0",
                StatusCode::BAD_REQUEST,
                "hours is 0",
            ),
            (
                "/classes/c-2/codes",
                "hours=1",
                StatusCode::NOT_FOUND,
                "`c-2`",
            ),
            (
                "/seats",
                "station=a&learner=s-2",
                StatusCode::NOT_FOUND,
                "`s-2`",
            ),
            (
                "/seats",
                "station=none&learner=s-1",
                StatusCode::NOT_FOUND,
                "no such station",
            ),
            (
                "/classes/import",
                "roster=no+table",
                StatusCode::BAD_REQUEST,
                "header is `no table`",
            ),
            (
                "/classes/import",
                "roster=+%0A",
                StatusCode::BAD_REQUEST,
                "the table is empty",
            ),
        ] {
            let answer = send(&router, request(&Method::POST, path, Some(&cookie), body)).await;
            assert_eq!(answer.status(), status, "{path} {body}");
            let page = text(answer).await;
            assert!(page.contains(named), "{path} {body}: {page}");
        }
        let unknown = send(
            &router,
            request(&Method::GET, "/classes/c-2", Some(&cookie), ""),
        )
        .await;
        assert_eq!(unknown.status(), StatusCode::NOT_FOUND);
        assert!(house.registered.changes.lock().unwrap().is_empty());
        assert!(house.registered.imported.lock().unwrap().is_empty());
        assert!(house.instructed.lock().unwrap().is_empty());
    });
}

#[test]
fn names_stay_text_and_every_opening_of_names_is_in_the_log() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let pages = [
            ("/classes", None),
            ("/classes/c-1", Some("read names")),
            ("/classes/import", None),
            ("/seats", Some("read names")),
            ("/exams", None),
            ("/audit", Some("read audit log")),
        ];
        for (path, logged) in pages {
            let answer = send(&router, request(&Method::GET, path, Some(&cookie), "")).await;
            assert_eq!(answer.status(), StatusCode::OK, "{path}");
            let page = text(answer).await;
            assert!(
                !page.contains("<img") && page.contains("&#60;img"),
                "{path}: {page}"
            );
            let log = std::mem::take(&mut *house.registered.log.lock().unwrap());
            let actions: Vec<&str> = log.iter().map(|entry| entry[1].as_str()).collect();
            assert_eq!(actions, Vec::from_iter(logged), "{path}");
            assert!(log.iter().all(|entry| entry[0] == "t-admin"));
        }
        for (path, body) in [
            ("/classes/import", "roster=x&class=%3Cscript%3E"),
            ("/classes/c-1/codes", "hours=2"),
        ] {
            let answer = send(&router, request(&Method::POST, path, Some(&cookie), body)).await;
            let page = text(answer).await;
            assert!(
                !page.contains("<img") && page.contains("&#60;img"),
                "{path}: {page}"
            );
            assert!(!page.contains("<script>"), "{path}");
            assert_eq!(
                house.registered.log.lock().unwrap().pop().unwrap()[1],
                "read names"
            );
        }
    });
}

#[test]
fn a_roster_is_imported_after_its_report_alone() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let post = async |body: &str| {
            let asked = request(&Method::POST, "/classes/import", Some(&cookie), body);
            let answer = send(&router, asked).await;
            (answer.status(), text(answer).await)
        };
        let (status, page) = post("roster=sourcedId%0A1%3C%2Ftextarea%3E&class=B").await;
        assert_eq!(status, StatusCode::OK);
        assert!(
            page.contains("nothing is changed yet") && page.contains("name=\"hash\" value=\"h\""),
            "{page}"
        );
        assert!(
            page.contains("1 new") && page.contains("1 refused") && page.contains("3 learners"),
            "{page}"
        );
        assert!(
            page.contains("Import 1 of 2 lines") && page.contains("without the refused"),
            "{page}"
        );
        assert!(page.contains("1&#60;/textarea&#62;"), "{page}");
        assert!(house.registered.imported.lock().unwrap().is_empty());
        let (status, page) = post("roster=sourcedId%0A1&class=B&hash=old").await;
        assert_eq!(status, StatusCode::CONFLICT);
        assert!(
            page.contains("have changed") && page.contains("nothing is changed yet"),
            "{page}"
        );
        let (status, page) = post("roster=sourcedId%0A1&class=B&hash=h").await;
        assert_eq!(status, StatusCode::OK);
        assert!(page.contains(">Imported<"), "{page}");
        let imported = house.registered.imported.lock().unwrap().pop().unwrap();
        assert_eq!(imported, ["sourcedId\n1", "B", "h"].map(str::to_owned));
        // A whole school fits, and no more than 1 MiB is taken.
        for (length, expected) in [
            (900_000, StatusCode::OK),
            (1 << 20, StatusCode::PAYLOAD_TOO_LARGE),
        ] {
            let body = format!("roster={}", "x".repeat(length));
            let asked = request(&Method::POST, "/classes/import", Some(&cookie), &body);
            assert_eq!(send(&router, asked).await.status(), expected, "{length}");
        }
    });
}

#[test]
fn a_seat_sets_the_plan_of_an_own_station_and_exams_need_the_right() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let seat = async |cookie: &str, body: &str| {
            send(
                &router,
                request(&Method::POST, "/seats", Some(cookie), body),
            )
            .await
            .status()
        };
        assert_eq!(
            seat(&cookie, "station=b&learner=s-1").await,
            StatusCode::NOT_FOUND
        );
        assert!(house.instructed.lock().unwrap().is_empty());
        assert_eq!(
            seat(&cookie, "station=a&learner=s-1").await,
            StatusCode::SEE_OTHER
        );
        assert_eq!(
            seat(&cookie, "station=a&learner=s-exam-1").await,
            StatusCode::SEE_OTHER
        );
        let examiner = sign_in(&router, "examiner").await;
        assert_eq!(
            seat(&examiner, "station=a&learner=s-1").await,
            StatusCode::SEE_OTHER
        );
        let all = std::mem::take(&mut *house.instructed.lock().unwrap());
        let exams: Vec<bool> = all.iter().map(|one| one.exams).collect();
        assert_eq!(exams, [false, true, true]);
        let text_of = &all[0].instruction;
        assert_eq!(*text_of, Instruction::Plan("learner = \"s-1\"".into()));
        assert_eq!(house.registered.changes.lock().unwrap().len(), 3);
        // The page has own stations alone.
        let page =
            text(send(&router, request(&Method::GET, "/seats", Some(&cookie), "")).await).await;
        assert!(
            page.contains("Seat at a") && !page.contains("Seat at b"),
            "{page}"
        );
        assert!(!page.contains("at b<"), "the seat of another station");
    });
}

#[test]
fn the_content_of_an_exam_is_hidden_from_instructors_and_exams_are_set_by_examiners() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        for (role, may) in [("instructor", false), ("examiner", true), ("admin", true)] {
            let cookie = sign_in(&router, role).await;
            let get = async |path: &str| {
                text(send(&router, request(&Method::GET, path, Some(&cookie), "")).await).await
            };
            let (list, class) = (get("/classes").await, get("/classes/c-1").await);
            for page in [&list, &class] {
                assert_eq!(page.contains("exam, sealed"), !may, "{role}");
                assert_eq!(
                    page.contains("case case3 (probing), exam"),
                    may,
                    "{role}: {page}"
                );
            }
            assert_eq!(class.contains("<option>exam</option>"), may, "{role}");
            let exams = get("/exams").await;
            assert_eq!(exams.contains("secret7"), may, "{role}");
            assert_eq!(exams.contains("Release the results"), may, "{role}");
            assert_eq!(list.contains("href=\"/audit\""), role == "admin", "{role}");
        }
        let cookie = sign_in(&router, "instructor").await;
        let body = "task=exercise%3Aprobing&mode=exam";
        send(
            &router,
            request(&Method::POST, "/classes/c-1/plan", Some(&cookie), body),
        )
        .await;
        // The register judges; the page says what the person may do.
        let (_, exams, _) = house.registered.changes.lock().unwrap().pop().unwrap();
        assert!(!exams);
    });
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(48))]
    /// No form of any bytes makes the server fail.
    #[test]
    fn no_form_fails(body in ".{0,200}|task=[a-z:%0-9]{0,20}&minutes=[0-9.e-]{0,6}", class in "[a-z0-9%.-]{1,12}") {
        run(async {
            let house = Fake::new();
            let router = router(&house);
            let cookie = sign_in(&router, "admin").await;
            let paths = ["/classes".to_owned(), format!("/classes/{class}/plan"), format!("/classes/{class}/codes"), "/classes/import".into(), "/seats".into(), "/seats/reassign".into()];
            for path in paths {
                if path.parse::<axum::http::Uri>().is_err() {
                    continue;
                }
                let status = send(&router, request(&Method::POST, &path, Some(&cookie), &body)).await.status();
                assert!(!status.is_server_error(), "{path}: {status}");
            }
        });
    }
}
