//! Grades in the console: two recorded sessions are graded by the server, a teacher looks at the reasons, gives another
//! score, and finds that score after a restart.

use std::time::{Duration, Instant};

use fantoccini::Client;
use serde_json::json;
use sulcus_tests::Program;

use crate::browser::{Driver, click, foreign_requests, run, sign_in, type_into, until, value};
use crate::class::{Class, Seat};
use crate::looks::look;

const SEATS: [Seat; 1] = [("chair-1", "probing", 250, None)];
/// Longest time until both sessions are graded. Their replays are of unoptimised programs at the lowest priority.
const GRADED: Duration = Duration::from_secs(300);

/// Records a session of a learner without a network.
fn record(class: &Class, learner: &str, habit: Option<&str>) {
    let mut arguments = vec!["demo", "--virtual", "--exercise", "probing"];
    arguments.extend(["--duration", "12", "--learner", learner]);
    arguments.extend(["--recordings", "recordings"]);
    arguments.extend(habit.iter().flat_map(|habit| ["--habit", habit]));
    class.place.run(Program::Client, &arguments).ok();
}

async fn open(page: &Client, class: &Class, path: &str) {
    let address = format!("https://{}{path}", class.console);
    page.goto(&address).await.unwrap();
}

/// Waits until both sessions have their grades.
async fn wait_for_grades(page: &Client, class: &Class) {
    let begin = Instant::now();
    let states =
        "[...document.querySelectorAll('td[data-label=State]')].map((cell) => cell.textContent)";
    loop {
        open(page, class, "/results").await;
        let found = value(page, states).await;
        let is_graded = |state: &serde_json::Value| {
            let text = state.as_str().unwrap_or_default();
            text.contains("passed") || text.contains("not decided")
        };
        let all = found.as_array().unwrap();
        if all.len() == 2 && all.iter().all(is_graded) {
            return;
        }
        assert!(begin.elapsed() < GRADED, "not graded: {found}");
        tokio::time::sleep(Duration::from_millis(500)).await;
    }
}

#[test]
fn a_teacher_finds_why_a_grade_is_what_it_is_and_gives_another() {
    let Some(driver) = Driver::find() else { return };
    let axe = std::env::var_os("SULCUS_AXE")
        .map(|file| std::fs::read_to_string(file).expect("axe-core's script"));
    let mut class = Class::of(&SEATS);
    record(&class, "s-1", None);
    record(&class, "s-2", Some("heavy-hand"));
    let add = ["token", "add", "--role", "student", "--station", "chair-1"];
    let add = [&add[..], &["--learner", "s-2", "--out", "s-2.ticket"]].concat();
    class.place.run(Program::Server, &add).ok();
    run(async {
        let page = driver.browser(false).await;
        sign_in(&page, &class.console, &class.instructor).await;
        wait_for_grades(&page, &class).await;
        look(&page, "results", axe.as_deref()).await;

        // The reasons of a score: list, session, moments. Three clicks from the start at most.
        open(&page, &class, "/").await;
        click(&page, "nav.sections a[href='/results']").await;
        let row = "[...document.querySelectorAll('tbody tr')].find((row) => row.textContent.includes('s-2'))";
        until(&page, "the list", &format!("{row} !== undefined")).await;
        let link = format!("({row}.querySelector('a').id = 'asked')");
        value(&page, &link).await;
        click(&page, "#asked").await;
        let moments = "document.querySelectorAll('.moments li').length";
        until(&page, "the moments", &format!("{moments} > 0")).await;
        let text = value(&page, "document.querySelector('.moments').textContent").await;
        assert!(text.as_str().unwrap().contains(" N"), "{text}");
        let chart = "document.querySelector('.sheet iframe')?.contentDocument?.querySelector('svg') !== null";
        until(&page, "the chart of the sheet", chart).await;
        look(&page, "result", axe.as_deref()).await;
        let path = value(&page, "location.pathname").await;
        let path = path.as_str().unwrap().to_owned();
        let shown = "document.querySelector('.scores').textContent";
        let proposal = "document.querySelector('.scores dd').textContent.split(',')[0]";
        let proposal = value(&page, proposal).await;
        let proposal = proposal.as_str().unwrap().to_owned();

        // Another score, with its reason as text.
        type_into(&page, "#reason", "<b>device</b> slipped").await;
        value(&page, "(document.querySelector('#score').value = '77.5')").await;
        click(&page, "input[name=passed][value=yes]").await;
        click(&page, ".revise button.main").await;
        let revised =
            format!("{shown}.includes('<b>device</b> slipped') && {shown}.includes('77.5')");
        until(&page, "the revision", &revised).await;

        // The class, two examiners, one learner.
        open(&page, &class, "/results/class?exercise=probing").await;
        until(
            &page,
            "the class",
            "document.querySelector('.figures') !== null",
        )
        .await;
        look(&page, "class-results", axe.as_deref()).await;
        open(&page, &class, "/results/compare").await;
        click(&page, "tbody a").await;
        until(
            &page,
            "the other session",
            "location.search.includes('first=')",
        )
        .await;
        click(&page, "tbody a").await;
        until(
            &page,
            "the comparison",
            "location.search.includes('second=')",
        )
        .await;
        look(&page, "compare", axe.as_deref()).await;
        open(&page, &class, "/learners/s-2").await;
        look(&page, "learner", axe.as_deref()).await;
        let size = "fetch('/learners/s-2/export').then((answer) => answer.blob()).then((blob) => arguments[0](blob.size))";
        let size = page.execute_async(size, vec![]).await.unwrap();
        assert!(size.as_u64().unwrap() > 100_000, "{size}");
        assert_eq!(foreign_requests(&page).await, json!([]));
        page.close().await.unwrap();

        // The score and the proposal survive a restart of the server.
        class.restart();
        let page = driver.browser(true).await;
        sign_in(&page, &class.console, &class.instructor).await;
        wait_for_grades(&page, &class).await;
        open(&page, &class, &path).await;
        until(&page, "the revision again", &revised).await;
        let beside = format!("{shown}.includes({})", json!(proposal));
        until(&page, "the proposal beside it", &beside).await;
        look(&page, "result-dark", axe.as_deref()).await;
        page.close().await.unwrap();

        // The learner finds the own result, and nothing of the other.
        let page = driver.browser(false).await;
        open(&page, &class, "/sign-in").await;
        let ticket = std::fs::read_to_string(class.place.path("s-2.ticket")).expect("a ticket");
        type_into(&page, "#token", ticket.trim()).await;
        click(&page, "#by-ticket button").await;
        until(&page, "the own page", "location.pathname === '/home'").await;
        let rows = "document.querySelectorAll('tbody tr').length === 1";
        until(&page, "one session", rows).await;
        look(&page, "home", axe.as_deref()).await;
        click(&page, "tbody a").await;
        until(&page, "the own grade", &revised).await;
        let truth = value(&page, "document.body.textContent.includes('True, mm')").await;
        assert_eq!(truth, false);
        page.close().await.unwrap();
    });
}
