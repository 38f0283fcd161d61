//! The live view of a station with two moving hands: flat, and in three dimensions where the program for it is built.

use std::path::PathBuf;
use std::time::Duration;

use fantoccini::Client;
use serde_json::{Value, json};
use sulcus_tests::Program;

use crate::browser::{Driver, click, foreign_requests, run, sign_in, until, until_within, value};
use crate::class::{Class, Seat};

/// Slow, as a browser that draws in software takes a core of its own.
const SEATS: [Seat; 1] = [("chair-1", "bimanual", 250, None)];
/// Time for the first picture in three dimensions: the program packs the viewer, the browser compiles it.
pub const FIRST: Duration = Duration::from_secs(240);

/// Remembers all shapes of both tools in the picture from above.
const WATCH: &str = "
window.shapes = [new Set(), new Set()];
setInterval(() => {
  for (const k of [0, 1]) {
    const tool = document.querySelector(`.flats figure:last-child .tool.tool${k}`);
    if (tool) {
      window.shapes[k].add(tool.getAttribute('d'));
    }
  }
}, 50);
";

pub async fn picture(page: &Client, name: &str) {
    if let Some(folder) = std::env::var_os("SULCUS_LOOK") {
        let picture = page.screenshot().await.unwrap();
        std::fs::write(PathBuf::from(folder).join(format!("{name}.png")), picture).unwrap();
    }
}

#[test]
fn both_tools_of_a_running_station_move_on_the_page_of_its_instructor() {
    let Some(driver) = Driver::find() else { return };
    let class = Class::of(&SEATS);
    run(async {
        let page = driver.drawing_browser().await;
        page.set_window_size(1400, 1000).await.unwrap();
        sign_in(&page, &class.console, &class.instructor).await;
        let mut student = class.student(0, "1200");
        let seen = "document.querySelector('.tile[data-phase=running] h2 a') !== null";
        until(&page, "the running station", seen).await;
        click(&page, ".tile h2 a").await;
        let running = "document.querySelector('.phase')?.textContent === 'running'";
        until(&page, "the session", running).await;

        click(&page, "#flat").await;
        page.execute(WATCH, vec![]).await.unwrap();
        let moves = "window.shapes.every((shapes) => shapes.size > 5)";
        until(&page, "two tools that move", moves).await;
        let teeth = "document.querySelectorAll('.flats .tooth').length > 1";
        until(&page, "teeth near the tools", teeth).await;
        // A pose that comes late lets a tool go for a moment.
        let said = "document.querySelector('.flat-text').textContent.includes(' N')";
        until(&page, "the force in words", said).await;
        let plotted = "[...document.querySelectorAll('.plot .first')].some((line) => line.getAttribute('d').length > 100)";
        until(&page, "the plot of the force", plotted).await;
        let charted = "document.querySelectorAll('#chart td').length >= 6 && document.querySelector('#chart td small').textContent !== ''";
        until(&page, "the chart", charted).await;
        picture(&page, "live-flat").await;
        assert_eq!(foreign_requests(&page).await, json!([]));

        let program = Program::Server.path().with_file_name("sulcus-review");
        click(&page, "#solid").await;
        if !program.is_file() {
            let reason =
                "document.querySelector('#view-told').textContent.includes('sulcus-review')";
            until(&page, "the reason why the view is flat", reason).await;
            until(
                &page,
                "the flat view",
                "document.querySelector('.flats') !== null",
            )
            .await;
        } else {
            solid(&page).await;
        }
        student.kill().unwrap();
        student.wait().unwrap();
        page.close().await.unwrap();
    });
}

/// The view in three dimensions: its time goes on, and no request leaves the origin.
async fn solid(page: &Client) {
    let seconds = "Number(document.querySelector('#view').dataset.seconds ?? 0)";
    until_within(page, "the viewer's time", &format!("{seconds} > 0"), FIRST).await;
    let first = value(page, seconds).await.as_f64().unwrap();
    let later = format!("{seconds} > {}", first + 2.0);
    until(page, "two more seconds in the viewer", &later).await;
    picture(page, "live-solid").await;
    let frame = page.find(fantoccini::Locator::Css("#view iframe")).await;
    frame.unwrap().enter_frame().await.unwrap();
    let shown = "(() => { const box = document.querySelector('#canvas').getBoundingClientRect(); return box.width > 300 && box.height > 300; })()";
    assert_eq!(value(page, shown).await, Value::Bool(true));
    // Calls of the viewer to its makers end at the policy of its page.
    let foreign = foreign_requests(page).await;
    let left = foreign.as_array().unwrap().iter();
    let left: Vec<&Value> = left
        .filter(|name| {
            !name.as_str().unwrap().starts_with("data:")
                && !name.as_str().unwrap().starts_with("blob:")
        })
        .collect();
    assert!(left.is_empty(), "{left:?}");
    page.clone().enter_parent_frame().await.unwrap();
}
