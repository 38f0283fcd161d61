//! Acts of an instructor at the console, and their traces in the recordings.

use serde_json::{Value, json};
use sulcus_sessions::{Occurrence, Recording};
use sulcus_tests::{Ended, files_with, rows};

use crate::browser::{Driver, click, foreign_requests, run, sign_in, type_into, until, value};
use crate::class::{Class, STATIONS};

/// Longest time from a trauma to its alert on the page, ticks of four milliseconds.
const SHOWN_TICKS: u64 = 250;
/// Longest time from the tick of a pause to a force of zero, ticks of one millisecond.
const STILL_TICKS: u64 = 100;

/// Notes for each station the first tick that the page shows of a running session, and of an alert of trauma.
const WATCH: &str = "
window.seen = {};
const look = () => {
  for (const tile of document.querySelectorAll('.tile')) {
    const seen = (window.seen[tile.dataset.station] ??= {});
    const tick = Number(tile.dataset.tick);
    if (tile.dataset.phase === 'running') {
      seen.running ??= tick;
    }
    if (tile.querySelector('[data-kind=trauma]')) {
      seen.trauma ??= tick;
    }
  }
};
new MutationObserver(look).observe(document.querySelector('#stations'), { subtree: true, childList: true, attributes: true });
";

fn tile(station: &str) -> String {
    format!(".tile[data-station={station}]")
}

fn events(recording: &Recording) -> Vec<Occurrence> {
    let messages = recording.messages().filter_map(Result::ok);
    messages
        .filter_map(|message| match message {
            sulcus_sessions::Message::Event(event) => Occurrence::parse(&event.text),
            _ => None,
        })
        .collect()
}

#[test]
fn an_instructor_sees_four_hands_stops_one_and_hears_of_a_trauma() {
    let Some(driver) = Driver::find() else { return };
    let class = Class::new();
    run(async {
        let page = driver.browser(false).await;
        sign_in(&page, &class.console, &class.instructor).await;
        let count = format!(
            "document.querySelectorAll('.tile[data-phase=free]').length === {}",
            STATIONS.len()
        );
        until(&page, "four free stations", &count).await;
        page.execute(WATCH, vec![]).await.unwrap();
        let students: Vec<_> = (0..STATIONS.len())
            .map(|k| class.student(k, "180"))
            .collect();
        for (name, _, rate, _) in STATIONS {
            until(
                &page,
                name,
                &format!("window.seen['{name}']?.running !== undefined"),
            )
            .await;
            let first = value(&page, &format!("window.seen['{name}'].running")).await;
            assert!(
                first.as_u64().is_some_and(|tick| tick <= u64::from(rate)),
                "{name}: {first}"
            );
        }

        // A pause by one click, at a hand that presses.
        let second = tile("chair-2");
        let pressing = format!(
            "document.querySelector('{second}').dataset.phase === 'running' && Number(document.querySelector('{second}').dataset.tick) > 3000"
        );
        until(&page, "the second hand at work", &pressing).await;
        click(&page, &format!("{second} .pause")).await;
        let answered =
            format!("Number(document.querySelector('{second} .answer').dataset.tick) > 0");
        until(&page, "the tick of the pause", &answered).await;
        let paused = value(
            &page,
            &format!("Number(document.querySelector('{second} .answer').dataset.tick)"),
        )
        .await;
        until(
            &page,
            "the state",
            &format!("document.querySelector('{second} .phase').textContent === 'paused'"),
        )
        .await;

        // The heavy hand hurts, and comes first.
        until(
            &page,
            "a trauma",
            "window.seen['chair-3'].trauma !== undefined",
        )
        .await;
        until(
            &page,
            "its place",
            "document.querySelector('.tile').dataset.station === 'chair-3'",
        )
        .await;
        let alarmed = value(&page, "window.seen['chair-3'].trauma").await;

        // The second station's own page, by a click on its name.
        click(&page, &format!("{second} h2 a")).await;
        until(
            &page,
            "the page of the station",
            "document.querySelector('#name')?.textContent === 'chair-2'",
        )
        .await;
        until(
            &page,
            "its events",
            "document.querySelectorAll('#events li').length > 0",
        )
        .await;
        type_into(&page, "#text", "<b>hold</b> it flatter").await;
        click(&page, "button[value=say]").await;
        until(
            &page,
            "an answer",
            "document.querySelector('#answer').textContent.startsWith('Message: in force')",
        )
        .await;
        let event = "[...document.querySelectorAll('#events li')].some((item) => item.textContent.includes('<b>hold</b> it flatter') && item.querySelectorAll('b').length === 1)";
        until(&page, "the message among the events, as text", event).await;
        click(&page, ".pause").await;
        until(
            &page,
            "the end of the pause",
            "document.querySelector('.phase').textContent === 'running'",
        )
        .await;
        click(&page, "#end").await;
        click(&page, "#sure button[value=no]").await;
        assert_eq!(
            value(&page, "document.querySelector('.phase').textContent").await,
            "running"
        );
        click(&page, "#end").await;
        click(&page, "#sure button[value=yes]").await;
        until(
            &page,
            "the end",
            "document.querySelector('.tile').dataset.phase === 'free'",
        )
        .await;
        assert_eq!(foreign_requests(&page).await, json!([]));
        for name in ["chair-1", "chair-3", "chair-4"] {
            let end = "fetch(`/api/stations/${arguments[0]}/instruct`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: '{\"do\":\"end\"}' }).then((answer) => arguments[1](answer.status))";
            let status = page.execute_async(end, vec![name.into()]).await.unwrap();
            // A hand that has probed every site ends its session by itself, before a slow browser comes so far.
            let has_ended = name != "chair-1" && status == 409;
            assert!(status == 200 || has_ended, "{name}: {status}");
        }

        // A student is told so, at every page of a teacher.
        let other = driver.browser(false).await;
        other
            .goto(&format!("https://{}/", class.console))
            .await
            .unwrap();
        type_into(&other, "#token", class.ticket(0)).await;
        click(&other, "#by-ticket button").await;
        until(
            &other,
            "the page of a student",
            "location.pathname === '/home'",
        )
        .await;
        let status = "fetch('/api/stations').then((answer) => answer.status)";
        let asked = other
            .execute_async(&format!("{status}.then(arguments[0])"), vec![])
            .await;
        assert_eq!(asked.unwrap(), 403);
        other.close().await.unwrap();
        page.close().await.unwrap();

        for (k, student) in students.into_iter().enumerate() {
            let ended = Ended::new(student.wait_with_output().unwrap());
            assert_eq!(ended.code, 0, "student {k}: {ended:#?}");
        }
        told(&class, &paused, &alarmed);
    });
}

/// The recordings hold what the page said, at the ticks that it named.
fn told(class: &Class, paused: &Value, alarmed: &Value) {
    let files = files_with(&class.place.path("recordings"), "mcap");
    assert_eq!(files.len(), STATIONS.len(), "{files:?}");
    let of = |station: &str| {
        let mut all = files
            .iter()
            .map(|file| Recording::open(file).expect("a recording"));
        all.find(|recording| recording.header().station == station)
            .expect("its recording")
    };
    let second = of("chair-2");
    let found = events(&second);
    let instructed = found
        .iter()
        .find(|event| event.kind == "instructed" && event.data["level"] == "paused");
    let instructed = instructed.expect("the pause is recorded");
    assert_eq!(Some(instructed.tick), paused.as_u64());
    assert!(
        instructed.data["by"]
            .as_str()
            .is_some_and(|by| !by.is_empty()),
        "{instructed:?}"
    );
    assert!(
        found
            .iter()
            .any(|event| event.kind == "message" && event.data["text"] == "<b>hold</b> it flatter")
    );
    let from = instructed.tick + STILL_TICKS;
    let resumed = found
        .iter()
        .find(|event| event.kind == "instructed" && event.data["level"] == "resumed");
    let until = resumed.expect("the end of the pause").tick;
    let rows = rows(&second);
    let held: Vec<_> = rows
        .iter()
        .filter(|row| (from..until).contains(&row.tick))
        .collect();
    assert!(held.len() > 100, "{} rows in the pause", held.len());
    for row in held {
        assert!(
            row.wrench.iter().flatten().all(|part| *part == 0.0),
            "tick {}: {:?}",
            row.tick,
            row.wrench
        );
    }
    let pressed = rows.iter().filter(|row| row.tick < instructed.tick);
    let largest = pressed
        .flat_map(|row| row.wrench[0][..3].to_vec())
        .fold(0.0_f32, |most, part| most.max(part.abs()));
    assert!(
        largest > 0.05,
        "the hand felt something before the pause: {largest} N"
    );

    let third = events(&of("chair-3"));
    let trauma = third
        .iter()
        .find(|event| event.kind == "force_zone" && event.data["zone"] == "trauma");
    let trauma = trauma.expect("the heavy hand hurts").tick;
    let alarmed = alarmed.as_u64().expect("a tick");
    assert!(
        (trauma..=trauma + SHOWN_TICKS).contains(&alarmed),
        "trauma at {trauma}, on the page at {alarmed}"
    );
}
