//! The first administrator by the link of the first start, and names with passwords.

use std::sync::Arc;
use std::time::Instant;

use axum::http::{Method, StatusCode, header};
use sulcus_console::App;

use crate::house::{Fake, request, router, router_of, run, send, sign_in, text};

#[test]
fn the_link_makes_one_administrator_who_signs_in_by_name_from_then_on() {
    run(async {
        let house = Fake::new();
        let app = App::new(house.clone());
        let link = app.first.make(Instant::now()).unwrap();
        let router = router_of(app);
        let ask = async |method: Method, body: &str| {
            let answer = send(&router, request(&method, &link, None, body)).await;
            (
                answer.status(),
                answer.headers().contains_key(header::SET_COOKIE),
                text(answer).await,
            )
        };
        let (status, _, page) = ask(Method::GET, "").await;
        assert!(status.is_success() && page.contains("valid once"), "{page}");
        let (status, has_cookie, page) =
            ask(Method::POST, "login=dean&password=short&again=short").await;
        assert_eq!((status, has_cookie), (StatusCode::BAD_REQUEST, false));
        assert!(page.contains("too short"), "{page}");
        let (status, ..) = ask(
            Method::POST,
            "login=dean&password=0123456789&again=0123456780",
        )
        .await;
        assert_eq!(status, StatusCode::BAD_REQUEST, "a repetition that differs");
        let (status, has_cookie, _) = ask(
            Method::POST,
            "login=dean&password=0123456789&again=0123456789",
        )
        .await;
        assert_eq!((status, has_cookie), (StatusCode::SEE_OTHER, true));
        for method in [Method::GET, Method::POST] {
            let (status, has_cookie, _) =
                ask(method, "login=eve&password=0123456789&again=0123456789").await;
            assert_eq!(
                (status, has_cookie),
                (StatusCode::NOT_FOUND, false),
                "used twice"
            );
        }
        assert_eq!(house.passwords.lock().unwrap().len(), 1);
        let by_name = request(
            &Method::POST,
            "/sign-in",
            None,
            "login=dean&password=0123456789",
        );
        assert_eq!(
            send(&router, by_name).await.headers()[header::LOCATION],
            "/"
        );
        let wrong = request(
            &Method::POST,
            "/sign-in",
            None,
            "login=dean&password=0123456780",
        );
        let wrong = send(&router, wrong).await;
        assert_eq!(wrong.status(), StatusCode::FORBIDDEN);
        assert!(text(wrong).await.contains("name or password is wrong"));
    });
}

#[test]
fn a_new_password_ends_all_other_sessions_of_the_person() {
    run(async {
        let house = Fake::new();
        house
            .passwords
            .lock()
            .unwrap()
            .insert("dean".into(), "0123456789".into());
        let router = router(&house);
        let [other, own] = [
            sign_in(&router, "admin").await,
            sign_in(&router, "admin").await,
        ];
        let set = async |body: &str| {
            send(
                &router,
                request(&Method::POST, "/password", Some(&own), body),
            )
            .await
        };
        let wrong = set("old=nonsense&new=9876543210&again=9876543210").await;
        assert_eq!(wrong.status(), StatusCode::FORBIDDEN);
        let right = set("old=0123456789&new=9876543210&again=9876543210").await;
        assert_eq!(right.status(), StatusCode::SEE_OTHER);
        let fresh = right.headers()[header::SET_COOKIE]
            .to_str()
            .unwrap()
            .split(';')
            .next()
            .unwrap()
            .to_owned();
        for (cookie, expected) in [
            (&other, StatusCode::UNAUTHORIZED),
            (&own, StatusCode::UNAUTHORIZED),
            (&fresh, StatusCode::OK),
        ] {
            let asked = request(&Method::GET, "/api/stations", Some(cookie), "");
            assert_eq!(send(&router, asked).await.status(), expected);
        }
    });
}

/// Twenty students who sign in at once must not take all cores: one password is checked at a time.
#[test]
fn passwords_are_checked_one_at_a_time() {
    run(async {
        let app = App::new(Fake::new());
        let turns = Arc::clone(&app.turns);
        let held = turns.acquire().await.unwrap();
        let router = router_of(app);
        let asked = request(
            &Method::POST,
            "/sign-in",
            None,
            "login=a&password=0123456789",
        );
        let waiting = tokio::spawn(async move { send(&router, asked).await.status() });
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
        assert!(!waiting.is_finished());
        drop(held);
        assert_eq!(waiting.await.unwrap(), StatusCode::FORBIDDEN);
    });
}
