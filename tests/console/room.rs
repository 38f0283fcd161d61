//! Acts of an instructor at the console, and their traces in the recordings.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use sulcus_sessions::{Message, Occurrence, Recording};
use sulcus_tests::{Ended, files_with, rows};

use crate::browser::{
    Driver, SOON, click, foreign_requests, run, sign_in, type_into, until, value,
};
use crate::class::{Class, STATIONS};

/// Largest number of ticks from a pause to a force of zero. The force falls with each tick that runs: points of the
/// clock that a busy machine skips do not count.
const STILL_TICKS: usize = 100;

/// Notes for each station the first tick that the page shows of a running session, of a pressing hand, of an alert of
/// trauma, and of such an alert at the first place.
const WATCH: &str = "
window.seen = {};
const look = () => {
  for (const tile of document.querySelectorAll('.tile')) {
    const seen = (window.seen[tile.dataset.station] ??= {});
    const tick = Number(tile.dataset.tick);
    if (tile.dataset.phase === 'running') {
      seen.running ??= tick;
      if (parseFloat(tile.querySelectorAll('.values dd')[1].textContent) > 0.1) {
        seen.pressing ??= tick;
      }
    }
    if (tile.querySelector('[data-kind=trauma]')) {
      seen.trauma ??= tick;
      if (tile === document.querySelector('.tile')) {
        seen.first ??= tick;
      }
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

/// Waits until the recording of a station has more ticks of a pause than the force needs to fall to zero.
async fn at_rest(class: &Class, station: &str) {
    let begin = Instant::now();
    let is_paused =
        |message: &Result<Message, _>| matches!(message, Ok(Message::Row(row)) if row.input.paused);
    loop {
        let files = files_with(&class.place.path("recordings"), "mcap");
        let opened = files.iter().filter_map(|file| Recording::open(file).ok());
        let mut own = opened.filter(|recording| recording.header().station == station);
        if own.any(|recording| recording.messages().filter(is_paused).count() > STILL_TICKS) {
            return;
        }
        assert!(begin.elapsed() < SOON, "{station} does not come to rest");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
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
            .map(|k| class.student(k, "900"))
            .collect();
        for (name, ..) in STATIONS {
            until(
                &page,
                name,
                &format!("window.seen['{name}']?.running !== undefined"),
            )
            .await;
        }

        // A pause by one click, at a hand that presses.
        let second = tile("chair-2");
        let pressing = "window.seen['chair-2'].pressing !== undefined";
        until(&page, "the second hand at work", pressing).await;
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
        at_rest(&class, "chair-2").await;

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
            "window.seen['chair-3'].first !== undefined",
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
    let resumed = found
        .iter()
        .find(|event| event.kind == "instructed" && event.data["level"] == "resumed");
    let until = resumed.expect("the end of the pause").tick;
    let rows = rows(&second);
    let in_pause = rows
        .iter()
        .filter(|row| (instructed.tick..until).contains(&row.tick));
    let held: Vec<_> = in_pause.skip(STILL_TICKS).collect();
    assert!(!held.is_empty(), "no row at rest");
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

    let third = of("chair-3");
    let last = sulcus_tests::rows(&third).last().expect("rows").tick;
    let third = events(&third);
    let trauma = third
        .iter()
        .find(|event| event.kind == "force_zone" && event.data["zone"] == "trauma");
    let trauma = trauma.expect("the heavy hand hurts").tick;
    let alarmed = alarmed.as_u64().expect("a tick");
    // The page shows the alert while the session runs, and not before its cause.
    assert!(
        (trauma..=last).contains(&alarmed),
        "trauma at {trauma}, on the page at {alarmed}, last tick {last}"
    );
}
