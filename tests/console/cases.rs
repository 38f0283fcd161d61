//! A teacher's case in the browser: made, changed by keys, saved, compiled, given to a station. Two teachers at one case.

use std::time::{Duration, Instant};

use fantoccini::{Client, Locator};
use serde_json::{Value, json};

use crate::browser::{
    Driver, click, foreign_requests, run, sign_in, type_into, until, until_within, value,
};
use crate::class::Class;
use crate::live::FIRST;
use crate::looks::look;
use sulcus_tests::Program;

/// Longest compilation on a busy machine.
const COMPILED: Duration = Duration::from_secs(600);

/// Counts the frames that the browser draws from now on.
const DRAWN: &str = "
window.drawn = 0;
window.began = performance.now();
const next = () => {
  window.drawn += 1;
  requestAnimationFrame(next);
};
requestAnimationFrame(next);
";

/// A key that is pressed on the focused site.
async fn press(page: &Client, key: &str) {
    let script = "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key: arguments[0], bubbles: true }))";
    page.execute(script, vec![key.into()]).await.unwrap();
}

async fn open(page: &Client, console: &str, path: &str) {
    page.goto(&format!("https://{console}{path}"))
        .await
        .unwrap();
}

/// Waits for a step of a compilation, which has the idle time of the machine alone.
async fn finished(page: &Client, expression: &str) {
    let begin = Instant::now();
    while value(page, expression).await != Value::Bool(true) {
        let stage = value(page, "document.querySelector('#work').innerText").await;
        assert!(begin.elapsed() < COMPILED, "{stage}");
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
}

/// Selector of a site.
fn site(fdi: u8, side: &str, place: u8) -> String {
    format!(".site[data-fdi='{fdi}'][data-side={side}][data-place='{place}']")
}

async fn chart(page: &Client) {
    until(
        page,
        "the chart",
        "document.querySelectorAll('.site').length === 84 && document.querySelector('.site[aria-current]') !== null",
    )
    .await;
}

#[test]
fn a_case_is_written_compiled_and_used_and_a_second_teacher_overwrites_nothing() {
    let Some(driver) = Driver::find() else { return };
    let axe = std::env::var_os("SULCUS_AXE")
        .map(|file| std::fs::read_to_string(file).expect("axe-core's script"));
    let class = Class::new();
    run(async {
        let page = driver.browser(false).await;
        page.set_window_size(1400, 1500).await.unwrap();
        sign_in(&page, &class.console, &class.instructor).await;
        open(&page, &class.console, "/cases").await;
        until(
            &page,
            "the form",
            "document.querySelectorAll('#condition option').length === 3",
        )
        .await;
        // A healthy patient has every tooth, and room for the values of this test.
        let condition = "document.querySelector('#condition').value = 'healthy'";
        page.execute(condition, vec![]).await.unwrap();
        type_into(&page, "#new-name", "deep").await;
        click(&page, "#new button[type=submit]").await;
        chart(&page).await;

        // Digits set depths and go on; a value out of range is told at its site and stops the compilation.
        let (first, second) = (site(36, "buccal", 1), site(36, "buccal", 2));
        click(&page, &first).await;
        press(&page, "6").await;
        press(&page, "0").await;
        let depth = |site: &str| format!("document.querySelector(\"{site} .depth\").textContent");
        assert_eq!(value(&page, &depth(&first)).await, "6");
        assert_eq!(value(&page, &depth(&second)).await, "10");
        click(&page, &second).await;
        for _ in 0..4 {
            press(&page, "+").await;
        }
        let faulty = format!("document.querySelector(\"{second}\").classList.contains('fault')");
        until(&page, "the fault", &faulty).await;
        assert_eq!(
            value(&page, "document.querySelector('#compile').disabled").await,
            true
        );
        for _ in 0..4 {
            click(&page, "#undo").await;
        }
        until(
            &page,
            "no fault",
            "document.querySelector('#checked').textContent === 'No fault.'",
        )
        .await;

        // A second teacher with the same version.
        click(&page, "#save").await;
        let saved = "document.querySelector('#answer').textContent === 'saved'";
        until(&page, "the save", saved).await;
        let other = driver.browser(false).await;
        other.set_window_size(1400, 1500).await.unwrap();
        sign_in(&other, &class.console, &class.instructor).await;
        open(&other, &class.console, "/cases/deep").await;
        chart(&other).await;
        click(&page, &site(37, "lingual", 1)).await;
        press(&page, "3").await;
        press(&page, "b").await;
        click(&page, "#compile").await;
        finished(&page, "document.querySelector('#progress').value > 0").await;
        click(&other, &site(31, "buccal", 1)).await;
        press(&other, "4").await;
        click(&other, "#save").await;
        until(
            &other,
            "the conflict",
            "document.querySelector('#conflict').open",
        )
        .await;
        click(&other, "#conflict button[value=copy]").await;
        until(&other, "the copy", "location.pathname === '/cases/deep-2'").await;
        chart(&other).await;
        let kept = depth(&site(31, "buccal", 1));
        assert_eq!(value(&other, &kept).await, "4", "nothing is lost");
        other.close().await.unwrap();

        let compiled = "document.querySelector('#state').textContent.startsWith('compiled')";
        finished(&page, compiled).await;
        click(&page, "#draw").await;
        until(
            &page,
            "the picture",
            "document.querySelector('#picture').naturalWidth > 100",
        )
        .await;
        click(&page, "#use button").await;
        let used = "document.querySelector('#used').textContent.includes('has the case deep')";
        until(&page, "the plan", used).await;
        click(&page, "#remove").await;
        click(&page, "#sure button[value=yes]").await;
        let refused = "document.querySelector('#answer').textContent.includes('in the plan of')";
        until(&page, "the refusal", refused).await;
        assert_eq!(foreign_requests(&page).await, json!([]));
        page.close().await.unwrap();

        turned(&driver, &class).await;
        for is_dark in [false, true] {
            let scheme = if is_dark { "dark" } else { "light" };
            let page = driver.browser(is_dark).await;
            sign_in(&page, &class.console, &class.instructor).await;
            open(&page, &class.console, "/cases").await;
            let all = "document.querySelectorAll('.case').length === 2";
            until(&page, "both cases", all).await;
            look(&page, &format!("cases-{scheme}"), axe.as_deref()).await;
            open(&page, &class.console, "/cases/deep").await;
            chart(&page).await;
            look(&page, &format!("case-{scheme}"), axe.as_deref()).await;
            page.close().await.unwrap();
        }
    });
}

/// The compiled mouth in three dimensions, where the program for it is built; else the reason why not.
async fn turned(driver: &Driver, class: &Class) {
    let page = driver.drawing_browser().await;
    page.set_window_size(1400, 1000).await.unwrap();
    sign_in(&page, &class.console, &class.instructor).await;
    open(&page, &class.console, "/cases/deep").await;
    chart(&page).await;
    click(&page, "#turn").await;
    until(
        &page,
        "the page",
        "location.pathname === '/cases/deep/mouth'",
    )
    .await;
    if Program::Server
        .path()
        .with_file_name("sulcus-review")
        .is_file()
    {
        let started = "document.querySelector('#replay')?.dataset.started === 'yes'";
        until_within(&page, "the viewer", started, FIRST).await;
        let frame = page.find(Locator::Css("#replay iframe")).await;
        frame.unwrap().enter_frame().await.unwrap();
        page.execute(DRAWN, vec![]).await.unwrap();
        // The viewer looks for a failure of its own every second.
        let drawn = "window.drawn >= 20 && performance.now() > window.began + 3000";
        until(&page, "frames after the start", drawn).await;
        page.clone().enter_parent_frame().await.unwrap();
        crate::live::picture(&page, "mouth").await;
        assert_eq!(
            value(&page, "document.querySelector('#told').textContent").await,
            ""
        );
    } else {
        let reason = "document.querySelector('#told')?.textContent.includes('sulcus-review')";
        until(&page, "the reason why no mouth is shown", reason).await;
    }
    assert_eq!(foreign_requests(&page).await, json!([]));
    page.close().await.unwrap();
}
