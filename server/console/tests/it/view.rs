//! Live view: paths that open one stream once, bounded queues, the viewer's files, the flat picture, the chart.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use axum::Router;
use axum::body::Body;
use axum::http::{Method, Response, StatusCode, header};
use futures_util::StreamExt as _;
use sulcus_console::guard::Caller;
use sulcus_console::house::{
    Feeds, Glance, Holder, Live, Outlines, QUEUE, Segment, SiteDepth, ToolOutline, ToothOutline,
    Viewer,
};
use sulcus_console::view::capabilities::{LONGEST, Right, Shows};
use sulcus_console::{App, house::House};
use sulcus_proto::Role;
use sulcus_proto::live::Hands;
use sulcus_proto::station::StationEvent;
use tokio::sync::{broadcast, watch};

use crate::house::{Fake, request, router, router_of, run, send, sign_in, text};

/// Longest wait for a condition.
const SOON: Duration = Duration::from_secs(120);

/// Streams and pictures of a test's server.
pub struct Views {
    pub glance: Mutex<Glance>,
    pub begin: watch::Sender<Option<Segment>>,
    pub further: Mutex<Option<broadcast::Sender<Segment>>>,
    /// Stations whose stream was asked for.
    pub asked: Mutex<Vec<String>>,
    /// Reason why there is no viewer.
    pub missing: Mutex<Option<String>>,
}

impl Default for Views {
    fn default() -> Self {
        Self {
            glance: Mutex::default(),
            begin: watch::Sender::new(Some(part("begin"))),
            further: Mutex::new(Some(broadcast::Sender::new(QUEUE))),
            asked: Mutex::default(),
            missing: Mutex::default(),
        }
    }
}

impl Views {
    fn further(&self, text: &str) {
        if let Some(sender) = &*self.further.lock().unwrap() {
            let _ = sender.send(part(text));
        }
    }

    fn viewers(&self) -> usize {
        let further = self.further.lock().unwrap();
        further.as_ref().map_or(0, |sender| sender.receiver_count())
    }
}

fn part(text: &str) -> Segment {
    text.as_bytes().into()
}

impl Feeds for Fake {
    fn glance(&self, _: &str) -> Option<Glance> {
        Some(*self.views.glance.lock().unwrap())
    }

    fn outlines(&self, station: &str) -> Option<Outlines> {
        let begun = self.glance(station)?.begun;
        let tool = ToolOutline {
            name: format!("probe of {station}"),
            line: vec![[0.0; 3], [0.0, 0.0, -0.09]],
            rim: vec![],
        };
        let tooth = ToothOutline {
            fdi: 36,
            points: vec![[0.01, 0.0, 0.0]],
            margin: vec![],
        };
        (begun > 0).then(|| Outlines {
            begun,
            tick_s: 0.001,
            tools: vec![tool],
            teeth: vec![tooth],
        })
    }

    fn depths(&self, _: &str) -> Vec<SiteDepth> {
        let depth = |site| SiteDepth {
            tooth: 36,
            site,
            depth_mm: 4.5,
        };
        ["mesiobuccal", "buccal"].map(depth).into()
    }

    fn live(&self, station: &str) -> Result<Live, String> {
        self.views.asked.lock().unwrap().push(station.to_owned());
        let further = self.views.further.lock().unwrap();
        let further = further.as_ref().ok_or("no session runs")?;
        Ok(Live {
            begin: self.views.begin.subscribe(),
            further: further.subscribe(),
        })
    }

    fn viewer(&self) -> Result<Arc<Viewer>, String> {
        if let Some(why) = &*self.views.missing.lock().unwrap() {
            return Err(why.clone());
        }
        let files = [
            ("viewer.wasm", "\x1f packed wasm"),
            ("viewer.js", "\x1f packed js"),
        ];
        Ok(Arc::new(Viewer {
            version: "1.2.3".into(),
            files: files
                .map(|(name, content)| (name.to_owned(), part(content)))
                .into(),
        }))
    }
}

async fn get(router: &Router, path: &str, cookie: Option<&str>) -> Response<Body> {
    send(router, request(&Method::GET, path, cookie, "")).await
}

/// Path of a stream for a signed-in page.
async fn open(router: &Router, cookie: &str, station: &str) -> String {
    let path = format!("/api/stations/{station}/live");
    let answer = send(router, request(&Method::POST, &path, Some(cookie), "")).await;
    assert_eq!(answer.status(), StatusCode::OK);
    let told: serde_json::Value = serde_json::from_str(&text(answer).await).unwrap();
    let path = told["path"].as_str().unwrap().to_owned();
    assert!(
        path.starts_with("/live/") && path.ends_with("/stream.rrd"),
        "{path}"
    );
    assert_eq!(
        path.len(),
        "/live//stream.rrd".len() + 32,
        "128 bits: {path}"
    );
    path
}

/// Text of a body until it contains `wanted`, or until its end.
async fn until(body: &mut axum::body::BodyDataStream, wanted: &str) -> String {
    let mut read = String::new();
    let reading = async {
        while !read.contains(wanted) {
            let Some(chunk) = body.next().await else {
                break;
            };
            read.push_str(std::str::from_utf8(&chunk.unwrap()).unwrap());
        }
    };
    let done = tokio::time::timeout(SOON, reading).await;
    assert!(done.is_ok(), "no `{wanted}` in: {read}");
    read
}

async fn in_time(what: &str, holds: impl Fn() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < SOON, "{what}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

/// Waits until pages see this recording at station `a`.
async fn shown(router: &Router, cookie: &str, recording: &str) {
    let begin = Instant::now();
    loop {
        let told = text(get(router, "/api/stations", Some(cookie)).await).await;
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        if told["stations"][0]["status"]["recording"] == recording {
            return;
        }
        assert!(begin.elapsed() < SOON, "{told}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

#[test]
fn a_path_opens_its_stream_once_without_a_cookie() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let path = open(&router, &cookie, "a").await;
        let answer = get(&router, &path, None).await;
        assert_eq!(answer.status(), StatusCode::OK);
        assert_eq!(answer.headers()[header::CACHE_CONTROL], "no-store");
        let mut body = answer.into_body().into_data_stream();
        assert_eq!(until(&mut body, "begin").await, "begin");
        house.views.further("1");
        house.views.further("2");
        assert_eq!(until(&mut body, "2").await, "12");
        for cookie in [None, Some(cookie.as_str())] {
            let again = get(&router, &path, cookie).await;
            assert_eq!(again.status(), StatusCode::NOT_FOUND, "used twice");
        }
        // The end of the session is the end of the stream.
        house.views.further.lock().unwrap().take();
        assert_eq!(until(&mut body, "never").await, "");
        let asked = house.views.asked.lock().unwrap();
        assert!(asked.iter().all(|station| station == "a"), "{asked:?}");
    });
}

#[test]
fn a_path_is_for_the_callers_own_station_and_others_look_like_none() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        for (method, rest) in [
            (Method::POST, "live"),
            (Method::GET, "flat"),
            (Method::GET, "chart"),
        ] {
            let mut told = Vec::new();
            for station in ["b", "none"] {
                let path = format!("/api/stations/{station}/{rest}");
                let answer = send(&router, request(&method, &path, Some(&cookie), "")).await;
                assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{path}");
                told.push(text(answer).await);
            }
            assert_eq!(told[0], told[1]);
        }
        assert!(house.views.asked.lock().unwrap().is_empty());
        let student = sign_in(&router, "student").await;
        for (method, path) in [
            (Method::POST, "/api/stations/a/live"),
            (Method::GET, "/api/stations/a/flat"),
            (Method::GET, "/api/stations/a/chart"),
            (Method::GET, "/api/viewer"),
            (Method::GET, "/viewer/1.2.3/viewer.wasm"),
        ] {
            let answer = send(&router, request(&method, path, Some(&student), "")).await;
            assert_eq!(answer.status(), StatusCode::FORBIDDEN, "{path}");
            let answer = send(&router, request(&method, path, None, "")).await;
            assert_eq!(answer.status(), StatusCode::UNAUTHORIZED, "{path}");
        }
        assert!(house.views.asked.lock().unwrap().is_empty());
    });
}

#[test]
fn a_path_older_than_a_minute_opens_nothing() {
    run(async {
        let house = Fake::new();
        let app = App::new(house.clone());
        let right = || Right {
            shows: Shows::Live("a".into()),
            caller: Caller {
                holder: house.find("instructor").unwrap(),
                session: None,
            },
        };
        let Some(before) = Instant::now().checked_sub(LONGEST) else {
            return;
        };
        let late = app.capabilities.make(right(), before).unwrap();
        let fresh = app
            .capabilities
            .make(right(), before + LONGEST / 2)
            .unwrap();
        let router = router_of(app);
        for (secret, expected) in [(late, StatusCode::NOT_FOUND), (fresh, StatusCode::OK)] {
            let answer = get(&router, &format!("/live/{secret}/stream.rrd"), None).await;
            assert_eq!(answer.status(), expected);
        }
    });
}

#[test]
fn a_sign_out_and_a_revoked_token_end_paths_and_open_streams() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let [used, unused] = [
            open(&router, &cookie, "a").await,
            open(&router, &cookie, "a").await,
        ];
        let other = sign_in(&router, "examiner").await;
        let others = open(&router, &other, "a").await;
        let mut body = get(&router, &used, None)
            .await
            .into_body()
            .into_data_stream();
        until(&mut body, "begin").await;
        send(
            &router,
            request(&Method::POST, "/sign-out", Some(&cookie), ""),
        )
        .await;
        until(&mut body, "never").await;
        let answer = get(&router, &unused, None).await;
        assert_eq!(
            answer.status(),
            StatusCode::NOT_FOUND,
            "the sign-in has ended"
        );
        let mut body = get(&router, &others, None)
            .await
            .into_body()
            .into_data_stream();
        until(&mut body, "begin").await;
        house.revoked.lock().unwrap().push("t-examiner".into());
        until(&mut body, "never").await;
        in_time("the viewers are gone", || house.views.viewers() == 0).await;
    });
}

#[test]
fn a_flood_waits_in_a_bounded_queue_and_a_viewer_that_leaves_frees_its_place() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let path = open(&router, &cookie, "a").await;
        let answer = get(&router, &path, None).await;
        // Nothing is read while a thousand parts come.
        for k in 0..1000 {
            house.views.further(&format!("<{k}>"));
            tokio::task::yield_now().await;
        }
        let mut body = answer.into_body().into_data_stream();
        let read = until(&mut body, "<999>").await;
        assert!(read.starts_with("begin"), "{read}");
        let parts = read.matches('<').count();
        // Parts in the queue, a part under way, and the part that waits behind it.
        assert!(parts <= QUEUE + 2, "{parts} parts: {read}");
        assert_eq!(house.views.viewers(), 1);
        drop(body);
        in_time("the place is free", || house.views.viewers() == 0).await;
    });
}

#[test]
fn a_station_without_a_session_and_a_missing_program_are_said() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        house.views.further.lock().unwrap().take();
        let asked = request(&Method::POST, "/api/stations/a/live", Some(&cookie), "");
        let answer = send(&router, asked).await;
        assert_eq!(answer.status(), StatusCode::CONFLICT);
        assert!(text(answer).await.contains("no session runs"));
        *house.views.missing.lock().unwrap() = Some("the program is missing".into());
        for path in ["/api/viewer", "/viewer/1.2.3/viewer.wasm"] {
            let answer = get(&router, path, Some(&cookie)).await;
            assert_eq!(answer.status(), StatusCode::SERVICE_UNAVAILABLE, "{path}");
            assert!(
                text(answer).await.contains("the program is missing"),
                "{path}"
            );
        }
    });
}

#[test]
fn the_viewers_files_are_kept_by_version_and_its_page_calls_no_other_origin() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "admin").await;
        let about = text(get(&router, "/api/viewer", Some(&cookie)).await).await;
        assert!(
            about.contains(r#""page":"/viewer/1.2.3/index.html""#),
            "{about}"
        );
        for (name, content_type, is_kept) in [
            ("index.html", "text/html; charset=utf-8", false),
            ("start.js", "text/javascript; charset=utf-8", false),
            ("viewer.js", "text/javascript; charset=utf-8", true),
            ("viewer.wasm", "application/wasm", true),
        ] {
            let answer = get(&router, &format!("/viewer/1.2.3/{name}"), Some(&cookie)).await;
            assert_eq!(answer.status(), StatusCode::OK, "{name}");
            let value = |name: header::HeaderName| {
                let value = answer.headers().get(name);
                value
                    .map(|value| value.to_str().unwrap().to_owned())
                    .unwrap_or_default()
            };
            assert_eq!(value(header::CONTENT_TYPE), content_type);
            assert_eq!(
                value(header::CACHE_CONTROL).contains("immutable"),
                is_kept,
                "{name}"
            );
            assert_eq!(value(header::CONTENT_ENCODING) == "gzip", is_kept, "{name}");
            let policy = value(header::CONTENT_SECURITY_POLICY);
            for part in [
                "connect-src 'self';",
                "frame-ancestors 'self'",
                "default-src 'none'",
            ] {
                assert!(policy.contains(part), "{name}: {policy}");
            }
            assert!(
                !policy.contains("http") && !policy.contains('*'),
                "{policy}"
            );
        }
        for path in ["/viewer/1.2.4/viewer.js", "/viewer/1.2.3/none"] {
            let answer = get(&router, path, Some(&cookie)).await;
            assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{path}");
        }
        let page = get(&router, "/stations/a", Some(&cookie)).await;
        let policy = page.headers()[header::CONTENT_SECURITY_POLICY]
            .to_str()
            .unwrap();
        assert!(
            policy.contains("frame-src 'self'") && !policy.contains("unsafe"),
            "{policy}"
        );
    });
}

#[test]
fn the_flat_picture_has_the_mouth_of_each_session_then_instants_until_the_sign_out() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let answer = get(&router, "/api/stations/a/flat", Some(&cookie)).await;
        assert_eq!(answer.headers()[header::CONTENT_TYPE], "text/event-stream");
        let mut body = answer.into_body().into_data_stream();
        until(&mut body, "event: none").await;
        for begun in [1, 2] {
            let set = |tick: u64| {
                let mut hands = Hands {
                    tick,
                    ..Hands::default()
                };
                hands.tools[0].held = true;
                hands.tools[0].graphic.position = [0.01, 0.0, 0.1];
                *house.views.glance.lock().unwrap() = Glance {
                    begun,
                    hands: Some(hands),
                };
            };
            set(1000);
            let mouth = until(&mut body, "event: mouth").await;
            let read = mouth + &until(&mut body, "\"tick\":1000").await;
            assert!(
                read.contains("probe of a") && read.contains("\"fdi\":36"),
                "{read}"
            );
            assert!(
                read.contains("[10.0,0.0,10.0]"),
                "the tip in millimetres: {read}"
            );
            set(1100);
            let read = until(&mut body, "\"tick\":1100").await;
            assert!(!read.contains("event: mouth"), "{read}");
        }
        send(
            &router,
            request(&Method::POST, "/sign-out", Some(&cookie), ""),
        )
        .await;
        until(&mut body, "event: signed-out").await;
        assert_eq!(until(&mut body, "never").await, "");
    });
}

#[test]
fn the_chart_holds_the_last_called_depth_of_each_site_of_this_session() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let chart = async || text(get(&router, "/api/stations/a/chart", Some(&cookie)).await).await;
        let begin = chart().await;
        assert!(
            begin.contains(r#""called":[]"#) && begin.contains(r#""depth_mm":4.5"#),
            "{begin}"
        );
        house.behind[0]
            .status
            .send_modify(|status| status.recording = "1.mcap".into());
        shown(&router, &cookie, "1.mcap").await;
        // More than a page's list of last events holds; the last one is at a site of its own.
        for k in 0..69 {
            let (site, depth) = if k < 68 {
                ("buccal", k % 9)
            } else {
                ("lingual", 3)
            };
            let text = format!(
                "reading_called at tick {k}: {{\"tooth\":{},\"site\":\"{site}\",\"depth_mm\":{depth}}}",
                if k == 0 { 11 } else { 36 }
            );
            let event = StationEvent {
                station: "a".into(),
                tick: k,
                text,
            };
            house.behind[0].events.send(event).unwrap();
            tokio::task::yield_now().await;
        }
        let begin = Instant::now();
        let mut found = serde_json::Value::Null;
        while begin.elapsed() < SOON && found["called"].as_array().map(Vec::len) != Some(3) {
            found = serde_json::from_str(&chart().await).unwrap();
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let called = found["called"].as_array().unwrap();
        assert_eq!(called.len(), 3, "{found}");
        assert_eq!(called[0]["tooth"], 11, "the first one is still there");
        assert_eq!(
            (&called[1]["site"], &called[1]["depth_mm"]),
            (&"buccal".into(), &(67 % 9).into())
        );
        house.behind[0]
            .status
            .send_modify(|status| status.recording = "2.mcap".into());
        shown(&router, &cookie, "2.mcap").await;
        assert!(
            chart().await.contains(r#""called":[]"#),
            "of another session"
        );
    });
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]
    /// No path but a made one opens a stream.
    #[test]
    fn no_guessed_path_opens_a_stream(secret in "[0-9a-f]{32}|[ -~&&[^/?#%]]{1,40}") {
        run(async {
            let house = Fake::new();
            let app = App::new(house.clone());
            let holder = Holder { id: "t-admin".into(), role: Role::Admin, station: None };
            let right = Right { shows: Shows::Live("a".into()), caller: Caller { holder, session: None } };
            app.capabilities.make(right, Instant::now()).unwrap();
            let router = router_of(app);
            let Ok(uri) = format!("/live/{secret}/stream.rrd").parse::<axum::http::Uri>() else { return };
            let answer = get(&router, &uri.to_string(), None).await;
            assert_eq!(answer.status(), StatusCode::NOT_FOUND);
            assert_eq!(house.views.viewers(), 0);
        });
    }
}
