//! Classes in the console, as a teacher works: a roster of a file, a plan in three clicks, a code, a learner who signs in.

use std::time::Instant;

use fantoccini::Client;
use serde_json::json;
use sulcus_tests::{Program, files_with};

use crate::browser::{
    Driver, SOON, click, foreign_requests, run, sign_in, type_into, until, value,
};
use crate::class::Class;
use crate::looks::look;

/// Roster in the code page of western spreadsheets, with a name that is HTML, and a line without a person.
const ROSTER: &[u8] = b"sourcedId;givenName;familyName;email;class\r\n\
    1;Zo\xeb;O'Neill;z@school.example;Class B\r\n\
    2;<img src=x onerror=alert(1)>;Li;;Class B\r\n\
    ;Nobody;Known;;Class B\r\n";

const TEXT: &str = "document.body.innerText";

fn holds(text: &str) -> String {
    format!("{TEXT}.includes({})", json!(text))
}

/// Loads a page until it does not hold a text.
async fn until_gone(page: &Client, address: &str, text: &str) {
    let begin = Instant::now();
    loop {
        page.goto(address).await.unwrap();
        if value(page, &holds(text)).await == json!(false) {
            return;
        }
        assert!(begin.elapsed() < SOON, "{address} still has: {text}");
    }
}

#[test]
fn a_teacher_imports_a_class_gives_it_a_plan_and_a_learner_signs_in_by_code() {
    let Some(driver) = Driver::find() else { return };
    let axe = std::env::var_os("SULCUS_AXE")
        .map(|file| std::fs::read_to_string(file).expect("axe-core's script"));
    let class = Class::new();
    let roster = class.place.path("roster.csv");
    std::fs::write(&roster, ROSTER).expect("writes");
    run(async {
        let page = driver.browser(false).await;
        sign_in(&page, &class.console, &class.instructor).await;
        click(&page, "nav.sections a[href='/classes']").await;
        until(&page, "no class", &holds("There is no class yet")).await;
        look(&page, "classes-none", axe.as_deref()).await;
        click(&page, "a[href='/classes/import']").await;
        type_into(&page, "#file", roster.to_str().expect("plain")).await;
        until(
            &page,
            "the file's text",
            "document.getElementById('roster').value.includes('Zoë')",
        )
        .await;
        click(&page, ".roster button").await;
        until(&page, "the report", &holds("nothing is changed yet")).await;
        until(
            &page,
            "a refusal",
            "document.querySelectorAll('[data-verdict=refused]').length === 1",
        )
        .await;
        look(&page, "import", axe.as_deref()).await;
        click(&page, "#report ~ form button").await;
        until(&page, "the import", &holds("Imported")).await;
        assert_eq!(
            value(&page, "document.images.length").await,
            0,
            "a name is text"
        );

        // Three clicks and a choice: Classes, the case of the list, Assign.
        click(&page, "nav.sections a[href='/classes']").await;
        until(&page, "the class", &holds("2 learners")).await;
        click(&page, "#task-c-1 option[value='exercise:probing']").await;
        click(&page, "form[action='/classes/c-1/plan'] button").await;
        until(&page, "the plan", &holds("plan: probing, practice")).await;
        look(&page, "classes", axe.as_deref()).await;

        click(&page, "a[href='/classes/c-1']").await;
        until(
            &page,
            "the learners",
            "document.querySelectorAll('.members > li').length === 2",
        )
        .await;
        let names = value(
            &page,
            "[...document.querySelectorAll('.members .name')].map((e) => e.innerText)",
        )
        .await;
        assert_eq!(
            names,
            json!(["<img src=x onerror=alert(1)> Li", "Zoë O'Neill"])
        );
        click(&page, ".members > li:nth-child(2) summary").await;
        look(&page, "class", axe.as_deref()).await;
        click(&page, "form[action='/classes/c-1/codes'] button").await;
        until(
            &page,
            "two codes",
            "document.querySelectorAll('.cards .code').length === 2",
        )
        .await;
        look(&page, "codes", axe.as_deref()).await;
        let card = value(&page, "[...document.querySelectorAll('.cards li')].filter((e) => e.innerText.includes('Zoë')).map((e) => [e.querySelector('code').innerText, e.querySelector('.code').innerText])[0]").await;
        let [id, code] = [0, 1].map(|k| card[k].as_str().expect("a card").to_owned());

        // The station offers crown; the learner's plan is probing.
        let seconds = "2";
        let client = class
            .place
            .command(Program::Client.path())
            .env("SULCUS_TICKET", class.ticket(1))
            .args([
                "run",
                "--server",
                &class.server.address,
                "--exercise",
                "probing",
            ])
            .args(["--duration", seconds, "--code", &code])
            .args(["--tick", "server"])
            .output()
            .expect("the client starts");
        assert!(client.status.success(), "{client:?}");
        let file = files_with(&class.place.path("recordings"), "mcap").remove(0);
        let info = class
            .place
            .run(
                Program::Sessions,
                &["info", file.to_str().expect("plain"), "--json"],
            )
            .ok()
            .json();
        assert_eq!(info["learner_id"], id.as_str(), "{info}");

        // The seat ends with the session.
        let seats = format!("https://{}/seats", class.console);
        until_gone(&page, &seats, "seated: Zoë").await;
        look(&page, "seats", axe.as_deref()).await;
        click(&page, &format!("#at-chair-3 option[value='{id}']")).await;
        click(&page, "#at-chair-3 ~ button").await;
        until(&page, "the seat", &holds("seated: Zoë O'Neill")).await;
        let name = file
            .file_name()
            .and_then(|name| name.to_str())
            .expect("a name");
        type_into(&page, "#recording", name).await;
        click(&page, "#whose optgroup option:first-child").await;
        type_into(&page, "#why", "sat at the wrong station").await;
        click(&page, "form[action='/seats/reassign'] button").await;
        until(
            &page,
            "the entry",
            "document.querySelector('td[data-label=Reason]') !== null",
        )
        .await;
        click(&page, "a[href='/exams']").await;
        until(&page, "no exam", &holds("No exam was set yet")).await;
        look(&page, "exams", axe.as_deref()).await;
        assert_eq!(foreign_requests(&page).await, json!([]));
        page.close().await.unwrap();
        let dark = driver.browser(true).await;
        sign_in(&dark, &class.console, &class.instructor).await;
        for (path, name) in [
            ("classes/c-1", "class-dark"),
            ("seats", "seats-dark"),
            ("classes", "classes-dark"),
        ] {
            dark.goto(&format!("https://{}/{path}", class.console))
                .await
                .unwrap();
            look(&dark, name, axe.as_deref()).await;
        }
        dark.close().await.unwrap();
    });
    let log = std::fs::read_to_string(class.place.path("state/audit.jsonl")).expect("a log");
    for action in [
        "import roster",
        "assign plan",
        "make codes",
        "\"code\"",
        "reassign",
        "read names",
    ] {
        assert!(log.contains(action), "{action}: {log}");
    }
}
