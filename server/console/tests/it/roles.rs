//! Every route for every role, from the table of routes; origins; sign-in and sign-out.

use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use sulcus_console::routes::{self, Access, Form};
use sulcus_proto::Role;

use crate::house::{Fake, request, router, run, send, sign_in, text};

/// Path of a route with the names of real things.
fn filled(path: &str) -> String {
    let path = match path {
        "/api/results/{session}/replay" => "/api/results/{session}/replay?at=1",
        other => other,
    };
    path.replace("/viewer/{version}/{name}", "/viewer/1.2.3/viewer.js")
        .replace("{station}", "a")
        .replace("{name}", "console.css")
        .replace("{secret}", "wrong")
        .replace("{session}", "one")
        .replace("{learner}", "s-1")
        .replace("{case}", crate::cases::CASE)
        .replace("{side}", "above")
        .replace("{class}", "c-1")
        .replace("{exam}", "e-1")
        .replace("{file}", crate::house::CLIENT)
}

/// Body with which a permitted request succeeds.
fn body(path: &str) -> &'static str {
    match path {
        "/api/cases" => r#"{"name":"a","condition":"healthy","seed":1}"#,
        "/api/cases-check" => r#"{"label":"a","missing":[],"teeth":[]}"#,
        // The missing teeth stay the same, and the version with them.
        "/api/cases/{case}" => {
            r#"{"version":"[46]","chart":{"label":"","missing":[46],"teeth":[]}}"#
        }
        "/api/cases/{case}/use" => r#"{"station":"a","exercise":"bimanual"}"#,
        "/sign-in" => "token=instructor",
        "/api/stations/{station}/instruct" => r#"{"do":"pause"}"#,
        "/password" => "old=first-one-11&new=first-one-11&again=first-one-11",
        "/results/session/{session}/own-score" => "score=70",
        "/results/session/{session}/revise" => "score=72&passed=yes&reason=seen+again",
        "/results/session/{session}/norm" => "norm=yes",
        "/learners/{learner}/erase" => "confirm=s-1",
        "/first/{secret}" => "login=a&password=0123456789&again=0123456789",
        path => crate::register::body(path),
    }
}

#[test]
fn every_route_admits_the_roles_of_the_table_and_no_other() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        house
            .passwords
            .lock()
            .unwrap()
            .insert("a".into(), "first-one-11".into());
        for route in routes::table() {
            let (path, body) = (filled(route.path), body(route.path));
            // The walk has no link of a first start and no path of a stream; the tests of `first` and `view` have.
            let is_gone =
                ["/first/{secret}", "/live/{capability}/stream.rrd"].contains(&route.path);
            for role in [None].into_iter().chain(Role::ALL.map(Some)) {
                *house.recorded.lock().unwrap() = crate::results::for_each_route(route.path);
                let cookie = match role {
                    Some(role) => Some(sign_in(&router, role.name()).await),
                    None => None,
                };
                let asked = request(&route.method, &path, cookie.as_deref(), body);
                let answer = send(&router, asked).await;
                let status = answer.status();
                let what = format!("{} {path} as {role:?}: {status}", route.method);
                if is_gone {
                    assert_eq!(status, StatusCode::NOT_FOUND, "{what}");
                    continue;
                }
                if route.access.admits(role) {
                    assert!(
                        status.is_success() || status == StatusCode::SEE_OTHER,
                        "{what}"
                    );
                    continue;
                }
                let is_home = path == "/" && role.is_some();
                match (role, route.form) {
                    (Some(_), _) if is_home => {
                        assert_eq!(answer.headers()[header::LOCATION], "/home", "{what}");
                    }
                    (Some(_), _) => assert_eq!(status, StatusCode::FORBIDDEN, "{what}"),
                    (None, Form::Page) if route.method == Method::GET => {
                        assert_eq!(answer.headers()[header::LOCATION], "/sign-in", "{what}");
                    }
                    (None, _) => assert_eq!(status, StatusCode::UNAUTHORIZED, "{what}"),
                }
                let told = text(answer).await;
                assert!(!told.contains("learner-of"), "{what}: {told}");
            }
        }
        let all = house.instructed.lock().unwrap();
        // An instruction, a case at a station and a seat, each by instructor, examiner and admin.
        assert_eq!(all.len(), 9, "{all:?}");
    });
}

#[test]
fn no_route_changes_anything_for_a_page_of_another_origin() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        for route in routes::table()
            .iter()
            .filter(|route| route.method == Method::POST)
        {
            let foreign: [&[(&str, &str)]; 4] = [
                &[("sec-fetch-site", "cross-site")],
                &[("sec-fetch-site", "same-site")],
                &[
                    ("origin", "https://evil.example"),
                    ("host", "school.example"),
                ],
                &[("host", "school.example")],
            ];
            for headers in foreign {
                let mut request = Request::builder()
                    .method(&route.method)
                    .uri(filled(route.path))
                    .header(header::COOKIE, &cookie)
                    .header(header::CONTENT_TYPE, "application/json");
                for (name, value) in headers {
                    request = request.header(*name, *value);
                }
                let request = request.body(Body::from(body(route.path))).unwrap();
                let status = send(&router, request).await.status();
                assert_eq!(status, StatusCode::FORBIDDEN, "{} {headers:?}", route.path);
            }
        }
        assert!(house.instructed.lock().unwrap().is_empty());
        // The session is not signed out by any of them.
        let answer = send(
            &router,
            request(&Method::GET, "/api/stations", Some(&cookie), ""),
        )
        .await;
        assert_eq!(answer.status(), StatusCode::OK);
    });
}

#[test]
fn a_script_with_a_token_needs_no_origin_and_a_wrong_token_opens_nothing() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        for (token, expected) in [
            ("instructor", StatusCode::OK),
            ("wrong", StatusCode::FORBIDDEN),
        ] {
            let request = Request::post("/api/stations/a/instruct")
                .header(header::AUTHORIZATION, format!("Bearer {token}"))
                .header(header::CONTENT_TYPE, "application/json")
                .body(Body::from(r#"{"do":"pause"}"#))
                .unwrap();
            assert_eq!(send(&router, request).await.status(), expected, "{token}");
        }
        assert_eq!(house.instructed.lock().unwrap()[0].by, "t-instructor");
    });
}

#[test]
fn a_teacher_of_one_station_neither_sees_nor_instructs_another() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let seen = text(
            send(
                &router,
                request(&Method::GET, "/api/stations", Some(&cookie), ""),
            )
            .await,
        )
        .await;
        assert!(
            seen.contains("learner-of-a") && !seen.contains("learner-of-b"),
            "{seen}"
        );
        for (method, path) in [
            (Method::POST, "/api/stations/b/instruct"),
            (Method::GET, "/stations/b"),
        ] {
            let other = send(
                &router,
                request(&method, path, Some(&cookie), r#"{"do":"pause"}"#),
            )
            .await;
            let missing = path.replace("/b", "/none");
            let none = send(
                &router,
                request(&method, &missing, Some(&cookie), r#"{"do":"pause"}"#),
            )
            .await;
            assert_eq!(
                (other.status(), none.status()),
                (StatusCode::NOT_FOUND, StatusCode::NOT_FOUND)
            );
            assert_eq!(
                text(other).await,
                text(none).await,
                "one can tell whether a station exists"
            );
        }
        assert!(house.instructed.lock().unwrap().is_empty());
        let admin = sign_in(&router, "admin").await;
        let answer = send(
            &router,
            request(
                &Method::POST,
                "/api/stations/b/instruct",
                Some(&admin),
                r#"{"do":"pause"}"#,
            ),
        )
        .await;
        assert_eq!(
            text(answer).await,
            r#"{"taken":true,"text":"","tick":1234}"#
        );
    });
}

#[test]
fn an_examiner_alone_may_set_plans_of_exams() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        for token in ["instructor", "examiner", "admin"] {
            let cookie = sign_in(&router, token).await;
            let plan = r#"{"do":"plan","text":"mode = \"exam\""}"#;
            let path = "/api/stations/a/instruct";
            let answer = send(&router, request(&Method::POST, path, Some(&cookie), plan)).await;
            assert_eq!(answer.status(), StatusCode::OK);
        }
        let exams: Vec<bool> = house
            .instructed
            .lock()
            .unwrap()
            .iter()
            .map(|one| one.exams)
            .collect();
        assert_eq!(exams, [false, true, true]);
    });
}

#[test]
fn a_sign_out_and_a_revoked_token_end_the_session() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let ask = async |cookie: &str| {
            let asked = request(&Method::GET, "/api/stations", Some(cookie), "");
            send(&router, asked).await.status()
        };
        let [first, second] = [
            sign_in(&router, "admin").await,
            sign_in(&router, "admin").await,
        ];
        assert_ne!(first, second, "a new id at each sign-in");
        let out = request(&Method::POST, "/sign-out", Some(&first), "");
        assert_eq!(send(&router, out).await.status(), StatusCode::SEE_OTHER);
        assert_eq!(
            (ask(&first).await, ask(&second).await),
            (StatusCode::UNAUTHORIZED, StatusCode::OK)
        );
        house.revoked.lock().unwrap().push("t-admin".into());
        assert_eq!(ask(&second).await, StatusCode::UNAUTHORIZED);
    });
}

#[test]
fn wrong_tokens_are_refused_and_after_ten_the_address_waits() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let mut told = Vec::new();
        for _ in 0..12 {
            let asked = request(&Method::POST, "/sign-in", None, "token=guessed%3Cx%3E");
            let answer = send(&router, asked).await;
            assert!(!answer.headers().contains_key(header::SET_COOKIE));
            told.push(answer.status());
        }
        assert_eq!(told[9], StatusCode::FORBIDDEN);
        assert_eq!(told[10], StatusCode::TOO_MANY_REQUESTS);
        // The right one waits too: an attacker learns nothing from the answer.
        let right = send(
            &router,
            request(&Method::POST, "/sign-in", None, "token=admin"),
        )
        .await;
        assert_eq!(right.status(), StatusCode::TOO_MANY_REQUESTS);
    });
}

#[test]
fn every_answer_carries_the_headers_that_keep_a_page_to_its_origin() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        for path in [
            "/",
            "/sign-in",
            "/healthz",
            "/assets/tile.js",
            "/assets/none",
            "/none/at/all",
        ] {
            let answer = send(&router, request(&Method::GET, path, None, "")).await;
            let policy = answer.headers()["content-security-policy"]
                .to_str()
                .unwrap();
            assert!(
                policy.starts_with("default-src 'none'") && !policy.contains("unsafe"),
                "{policy}"
            );
            assert_eq!(
                answer.headers()["x-content-type-options"],
                "nosniff",
                "{path}"
            );
            assert!(answer.headers().contains_key("cache-control"), "{path}");
        }
        let missing = send(&router, request(&Method::GET, "/none", None, "")).await;
        assert_eq!(missing.status(), StatusCode::NOT_FOUND);
    });
}

#[test]
fn a_body_that_is_no_instruction_is_named_and_a_large_one_is_refused() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let ask = async |body: &str| {
            let path = "/api/stations/a/instruct";
            let answer = send(&router, request(&Method::POST, path, Some(&cookie), body)).await;
            (answer.status(), text(answer).await)
        };
        let (status, told) = ask(r#"{"do":"explode"}"#).await;
        assert_eq!(status, StatusCode::BAD_REQUEST);
        assert!(
            told.contains("explode") && told.contains("expected pause"),
            "{told}"
        );
        let (status, told) = ask("{{{").await;
        assert_eq!(status, StatusCode::BAD_REQUEST, "{told}");
        let (status, told) = ask(&"x".repeat(1 << 20)).await;
        assert_eq!(status, StatusCode::BAD_REQUEST, "{told}");
        assert!(house.instructed.lock().unwrap().is_empty());
    });
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]
    /// No request of any bytes instructs a station or makes the server fail.
    #[test]
    fn no_bytes_instruct_or_fail(body in ".{0,200}", path in "/[a-z/{}%.]{0,40}", cookie in "[ -~]{0,60}") {
        run(async {
            let house = Fake::new();
            let router = router(&house);
            for (method, path) in [(Method::POST, "/api/stations/a/instruct"), (Method::POST, "/sign-in"), (Method::GET, path.as_str())] {
                let Ok(request) = Request::builder()
                    .method(method)
                    .uri(path)
                    .header("sec-fetch-site", "same-origin")
                    .header(header::COOKIE, format!("__Host-sulcus={cookie}"))
                    .header(header::CONTENT_TYPE, "application/json")
                    .body(Body::from(body.clone()))
                else {
                    continue;
                };
                let status = send(&router, request).await.status();
                assert!(!status.is_server_error(), "{path}: {status}");
            }
            assert!(house.instructed.lock().unwrap().is_empty());
        });
    }
}

/// The table has no route that everybody may use to change something, but the sign-in.
#[test]
fn changes_need_a_sign_in() {
    for route in routes::table()
        .iter()
        .filter(|route| route.method != Method::GET)
    {
        assert!(
            route.access != Access::Open || ["/sign-in", "/first/{secret}"].contains(&route.path),
            "{}",
            route.path
        );
    }
}

#[test]
fn the_page_of_the_stations_has_the_forecast_of_the_disk() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let page = send(&router, request(&Method::GET, "/", Some(&cookie), "")).await;
        let page = text(page).await;
        let expected = "Room for recordings: 62 GB, some 51 hours of a station with two hands.";
        assert!(page.contains(expected), "{page}");
    });
}
