//! Sizes and schemes of the pages: nothing overflows, every button is large enough for a finger, axe-core finds no
//! serious fault. `SULCUS_LOOK=FOLDER` keeps the pictures, `SULCUS_AXE=FILE` names axe-core's script.

use std::path::PathBuf;

use fantoccini::Client;
use serde_json::json;

use crate::browser::{Driver, click, run, sign_in, until, value};
use crate::class::{Class, STATIONS};

/// Widths of a desk, a tablet and a phone, pixels.
const WIDTHS: [u32; 3] = [1400, 820, 390];

/// Parts of the page that stick out to the side.
const OVERFLOWING: &str = "[...document.querySelectorAll('body *')].filter((e) => e.getClientRects().length > 0 && !e.classList.contains('skip') && e.getBoundingClientRect().right > document.documentElement.clientWidth + 1).map((e) => e.outerHTML.slice(0, 80))";
/// Buttons and fields that are lower than a finger needs: 44 pixels.
const SMALL: &str = "[...document.querySelectorAll('button, input')].filter((e) => e.getClientRects().length > 0 && e.getBoundingClientRect().height < 43.5).map((e) => e.outerHTML.slice(0, 80))";

pub(crate) async fn look(page: &Client, name: &str, axe: Option<&str>) {
    for width in WIDTHS {
        page.set_window_size(width, 1000).await.unwrap();
        // Headless windows have a least width; what counts is the page's own.
        let is_wide = value(page, "document.documentElement.clientWidth").await;
        assert_eq!(
            value(page, OVERFLOWING).await,
            json!([]),
            "{name} at {is_wide} px"
        );
        assert_eq!(
            value(page, SMALL).await,
            json!([]),
            "{name} at {is_wide} px"
        );
        if let Some(folder) = std::env::var_os("SULCUS_LOOK") {
            let picture = page.screenshot().await.unwrap();
            std::fs::write(
                PathBuf::from(folder).join(format!("{name}-{width}.png")),
                picture,
            )
            .unwrap();
        }
    }
    if let Some(axe) = axe {
        page.execute(axe, vec![]).await.unwrap();
        let script = "axe.run().then((found) => arguments[0](found.violations.filter((v) => ['serious', 'critical'].includes(v.impact)).map((v) => v.id + ': ' + v.nodes.map((n) => n.html).join(' | '))))";
        let found = page.execute_async(script, vec![]).await.unwrap();
        assert_eq!(found, json!([]), "{name}");
    }
}

#[test]
fn the_pages_fit_a_desk_a_tablet_and_a_phone_light_and_dark() {
    let Some(driver) = Driver::find() else { return };
    let axe = std::env::var_os("SULCUS_AXE")
        .map(|file| std::fs::read_to_string(file).expect("axe-core's script"));
    let class = Class::new();
    run(async {
        for is_dark in [false, true] {
            let scheme = if is_dark { "dark" } else { "light" };
            // Each scheme has sessions of its own: a slow browser would find the first ones ended.
            let students = [0, 2].map(|k| class.student(k, "900"));
            let page = driver.browser(is_dark).await;
            page.goto(&format!("https://{}/sign-in", class.console))
                .await
                .unwrap();
            assert_eq!(
                value(&page, "matchMedia('(prefers-color-scheme: dark)').matches").await,
                is_dark
            );
            look(&page, &format!("sign-in-{scheme}"), axe.as_deref()).await;
            sign_in(&page, &class.console, &class.instructor).await;
            let count = format!(
                "document.querySelectorAll('.tile').length === {}",
                STATIONS.len()
            );
            until(&page, "all stations", &count).await;
            until(
                &page,
                "an alert",
                "document.querySelector('.tile .alerts li') !== null",
            )
            .await;
            look(&page, &format!("stations-{scheme}"), axe.as_deref()).await;
            page.set_window_size(1400, 1000).await.unwrap();
            click(&page, ".tile[data-station=chair-3] h2 a").await;
            until(
                &page,
                "events",
                "document.querySelectorAll('#events li').length > 2",
            )
            .await;
            look(&page, &format!("station-{scheme}"), axe.as_deref()).await;
            page.close().await.unwrap();
            students.into_iter().for_each(Class::interrupt);
        }
    });
}
