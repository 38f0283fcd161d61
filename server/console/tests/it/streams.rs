//! The stream of a page: first everything, then changes, nothing of other stations, its end.

use std::time::Duration;

use axum::body::Body;
use axum::http::{Method, Response};
use futures_util::StreamExt as _;
use sulcus_proto::station::StationEvent;

use crate::house::{Fake, request, router, run, send, sign_in, status, text};

/// Longest wait for a condition.
const SOON: Duration = Duration::from_secs(120);

/// Text of a stream until it contains `wanted`.
async fn until(answer: &mut Reader, wanted: &str) -> String {
    let reading = async {
        while !answer.text.contains(wanted) {
            let chunk = answer
                .body
                .next()
                .await
                .expect("the stream goes on")
                .unwrap();
            answer.text.push_str(std::str::from_utf8(&chunk).unwrap());
        }
    };
    let read = tokio::time::timeout(SOON, reading).await;
    assert!(read.is_ok(), "no `{wanted}` in: {}", answer.text);
    std::mem::take(&mut answer.text)
}

struct Reader {
    body: axum::body::BodyDataStream,
    text: String,
}

fn reader(answer: Response<Body>) -> Reader {
    Reader {
        body: answer.into_body().into_data_stream(),
        text: String::new(),
    }
}

#[test]
fn a_page_hears_its_stations_from_the_first_message_on_and_no_other() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let answer = send(
            &router,
            request(&Method::GET, "/api/events", Some(&cookie), ""),
        )
        .await;
        assert_eq!(answer.headers()["content-type"], "text/event-stream");
        assert_eq!(answer.headers()["x-accel-buffering"], "no");
        let mut stream = reader(answer);
        until(&mut stream, "event: lag").await;
        for behind in house.behind.iter().rev() {
            behind.status.send_modify(|status| status.tick = 77);
        }
        let heard = until(&mut stream, "\"tick\":77").await;
        assert!(
            heard.contains("learner-of-a") && !heard.contains("learner-of-b"),
            "{heard}"
        );
        let event = |station: &str| StationEvent {
            station: station.into(),
            tick: 80,
            text: format!("note at tick 80: {{\"text\":\"for {station}\"}}"),
        };
        house.behind[1].events.send(event("b")).unwrap();
        house.behind[0].events.send(event("a")).unwrap();
        let heard = until(&mut stream, "for a").await;
        assert!(
            heard.contains("event: event") && !heard.contains("for b"),
            "{heard}"
        );
        // A page that opens now gets the last events too.
        let snapshot = text(
            send(
                &router,
                request(&Method::GET, "/api/stations", Some(&cookie), ""),
            )
            .await,
        )
        .await;
        assert!(
            snapshot.contains("for a") && snapshot.contains("\"tick\":77"),
            "{snapshot}"
        );
    });
}

#[test]
fn a_trauma_is_an_alarm_and_a_called_depth_stands_beside_the_true_one() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let answer = send(
            &router,
            request(&Method::GET, "/api/events", Some(&cookie), ""),
        )
        .await;
        let mut stream = reader(answer);
        until(&mut stream, "event: lag").await;
        house.behind[0].events.send(StationEvent {
            station: "a".into(),
            tick: 9,
            text: "reading_called at tick 9: {\"tooth\":36,\"site\":\"mesiobuccal\",\"depth_mm\":5}".into(),
        }).unwrap();
        until(&mut stream, "\"called\":{\"depth_mm\":5").await;
        let mut hurt = status("a");
        hurt.phase = sulcus_proto::station::Phase::Running;
        (hurt.tools[0].peak_zone, hurt.tools[0].true_depth_mm) = (2, 4.5);
        house.behind[0].status.send(hurt).unwrap();
        let heard = until(&mut stream, "\"urgency\":\"alarm\"").await;
        assert!(
            heard.contains("\"kind\":\"trauma\"") && heard.contains("\"true_depth_mm\":4.5"),
            "{heard}"
        );
    });
}

#[test]
fn the_stream_ends_with_its_sign_in_and_a_slow_page_is_told_to_ask_again() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let open = || {
            send(
                &router,
                request(&Method::GET, "/api/events", Some(&cookie), ""),
            )
        };
        let (mut first, mut slow) = (reader(open().await), reader(open().await));
        until(&mut first, "event: lag").await;
        until(&mut slow, "event: lag").await;
        // The first page confirms each status: statuses that nobody waits for may be merged on a busy machine.
        for tick in 1..=1100 {
            house.behind[0]
                .status
                .send_modify(|status| status.tick = tick);
            until(&mut first, &format!("\"tick\":{tick},")).await;
        }
        let heard = until(&mut slow, "event: lag").await;
        assert!(heard.contains("missed"), "{heard}");
        house.revoked.lock().unwrap().push("t-admin".into());
        until(&mut first, "event: signed-out").await;
        while let Some(chunk) = first.body.next().await {
            let rest = chunk.unwrap();
            assert!(!rest.windows(6).any(|word| word == b"status"), "{rest:?}");
        }
    });
}

/// The key table of this machine has the name of the learner at station `a` alone.
#[test]
fn a_tile_has_the_name_of_its_learner_where_the_key_table_is() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let asked = || request(&Method::GET, "/api/stations", Some(&cookie), "");
        let begin = std::time::Instant::now();
        let named = loop {
            let told = text(send(&router, asked()).await).await;
            let told: serde_json::Value = serde_json::from_str(&told).unwrap();
            if told["stations"][0]["name"] != "" {
                break told;
            }
            assert!(begin.elapsed() < SOON, "{told}");
            tokio::time::sleep(Duration::from_millis(5)).await;
        };
        assert_eq!(named["stations"][0]["name"], crate::register::NAME);
        assert_eq!(named["stations"][1]["name"], "");
    });
}
