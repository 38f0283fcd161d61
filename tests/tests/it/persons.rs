//! `sulcus-server person` and the link of the first administrator.

use sulcus_tests::{Place, Program};

#[test]
fn a_person_is_added_listed_and_removed_with_the_token() {
    let place = Place::new();
    let add = ["person", "add", "mueller", "--role", "instructor", "--json"];
    let added = place.run(Program::Server, &add).ok().json();
    let password = added["password"].as_str().expect("a password");
    assert_eq!(
        (password.len(), added["role"].as_str()),
        (23, Some("instructor"))
    );
    let people = place.path("state/people.json");
    let kept = std::fs::read_to_string(&people).expect("a file");
    assert!(
        kept.contains("$argon2id$") && !kept.contains(password),
        "{kept}"
    );
    place
        .run(Program::Server, &add)
        .refused(&["`mueller` is taken"]);
    let other = place
        .run(
            Program::Server,
            &["person", "password", "mueller", "--json"],
        )
        .ok()
        .json();
    assert!(
        other["password"]
            .as_str()
            .is_some_and(|new| new != password)
    );
    let listed = place
        .run(Program::Server, &["person", "list", "--json"])
        .ok()
        .json();
    assert_eq!(
        (&listed["people"][0]["login"], &listed["people"][0]["valid"]),
        (&"mueller".into(), &true.into())
    );
    place
        .run(Program::Server, &["person", "remove", "mueller"])
        .ok();
    let tokens = place
        .run(Program::Server, &["token", "list", "--json"])
        .ok()
        .json();
    assert_eq!(tokens["tokens"][0]["valid"], false, "{tokens}");
    let listed = place
        .run(Program::Server, &["person", "list", "--json"])
        .ok()
        .json();
    assert_eq!(listed["people"], serde_json::json!([]));
}

#[test]
fn a_wrong_name_or_role_makes_neither_a_person_nor_a_token() {
    let place = Place::new();
    let add = |login: &str, role: &str| {
        place.run(Program::Server, &["person", "add", login, "--role", role])
    };
    add("Mueller", "instructor").refused(&["`Mueller`", "small letters"]);
    add("mueller", "student").refused(&["student", "token add"]);
    let tokens = place
        .run(Program::Server, &["token", "list", "--json"])
        .ok()
        .json();
    assert_eq!(tokens["tokens"], serde_json::json!([]));
}

/// The first line of `serve` has the link while nobody can sign in, and no link afterwards.
#[test]
fn the_link_of_the_first_administrator_is_printed_while_nobody_can_sign_in() {
    let place = Place::new();
    let first = |place: &Place| {
        let mut server = place
            .command(Program::Server.path())
            .args(["serve", "--exercise", "crown", "--no-admission", "--json"])
            .args(["--listen", "127.0.0.1:0", "--console", "127.0.0.1:0"])
            .stdout(std::process::Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut line = String::new();
        let stdout = server.stdout.take().expect("piped");
        std::io::BufRead::read_line(&mut std::io::BufReader::new(stdout), &mut line)
            .expect("a line");
        let _ = server.kill();
        let _ = server.wait();
        serde_json::from_str::<serde_json::Value>(&line).expect("JSON")
    };
    let said = first(&place);
    let console = said["console"].as_str().expect("an address");
    let link = said["first_administrator"].as_str().expect("a link");
    assert!(
        link.starts_with(&format!("https://{console}/first/")),
        "{link}"
    );
    place
        .run(Program::Server, &["token", "add", "--role", "instructor"])
        .ok();
    assert!(first(&place)["first_administrator"].is_null());
}
