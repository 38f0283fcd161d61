//! Import of a class: every line said, nothing made twice, nothing made of a bad table.

use proptest::prelude::*;

use super::*;
use crate::state::date::DAY_S;
use crate::state::tokens::Tokens;
use crate::state::{Place, StateFolder};

const NOW: u64 = 1_795_651_200;

struct Class {
    place: tempfile::TempDir,
    folder: StateFolder,
    store: TokenStore,
}

impl Class {
    fn new() -> Self {
        let place = tempfile::tempdir().expect("temporary folder");
        let folder = StateFolder::open(Some(&place.path().join("state"))).expect("creates");
        let store = TokenStore::of(&folder);
        Self {
            place,
            folder,
            store,
        }
    }

    fn import(&self, roster: &str, out: &str, renew: bool) -> Result<Vec<Line>, StateError> {
        let roster = Roster::parse(roster.as_bytes()).expect("a table");
        let path = self.place.path().join(out);
        roster.import(&self.store, &options(renew), &path, NOW)
    }

    fn tickets(&self, out: &str) -> Vec<Vec<String>> {
        let text = std::fs::read_to_string(self.place.path().join(out)).expect("tickets");
        let rows = text.lines().skip(1);
        rows.map(|row| row.split(',').map(str::to_owned).collect())
            .collect()
    }
}

fn options(renew: bool) -> Import<'static> {
    Import {
        class: "autumn",
        expires_unix_s: NOW + 100 * DAY_S,
        renew,
        fingerprint: [7; 32],
    }
}

fn verdicts(lines: &[Line]) -> Vec<&'static str> {
    let name = |line: &Line| match line.verdict {
        Verdict::New => "new",
        Verdict::Kept { .. } => "kept",
        Verdict::Replaces { .. } => "replaces",
        Verdict::Fault { .. } => "fault",
    };
    lines.iter().map(name).collect()
}

#[test]
fn every_ticket_of_a_class_opens_the_station_of_its_line() {
    let class = Class::new();
    let lines = class.import("id,station\ns-1,a-1\n007,a-2\n", "t.csv", false);
    assert_eq!(verdicts(&lines.expect("imports")), ["new", "new"]);
    let tokens = Tokens::open(&class.folder).expect("opens");
    let rows = class.tickets("t.csv");
    // A spreadsheet would make 7 of 007.
    assert_eq!((rows.len(), rows[1][0].as_str()), (2, "'007"));
    for (row, learner, station) in [(&rows[0], "s-1", "a-1"), (&rows[1], "007", "a-2")] {
        let ticket: Ticket = row[2].parse().expect("a ticket");
        assert_eq!(ticket.fingerprint, [7; 32]);
        let grant = tokens.grant(&ticket.token, NOW).expect("valid");
        assert_eq!(
            (grant.learner.as_str(), grant.class.as_str()),
            (learner, "autumn")
        );
        assert_eq!(grant.station, Place::Station(station.into()));
    }
}

#[test]
fn a_second_import_makes_only_tokens_that_are_missing() {
    let class = Class::new();
    class
        .import("id,station\ns-1,a-1\ns-2,a-2\n", "one.csv", false)
        .expect("imports");
    let again = class.import("id,station\ns-1,a-1\ns-2,a-3\ns-3,a-2\n", "two.csv", false);
    assert_eq!(
        verdicts(&again.expect("imports")),
        ["kept", "replaces", "new"]
    );
    assert_eq!(class.tickets("two.csv").len(), 2);
    let all = class.store.list().expect("reads");
    let valid: Vec<&str> = all
        .iter()
        .filter(|token| token.is_valid(NOW))
        .map(|token| token.learner.as_str())
        .collect();
    assert_eq!((all.len(), valid), (4, vec!["s-1", "s-2", "s-3"]));
    let renewed = class.import("id,station\ns-1,a-1\n", "three.csv", true);
    assert_eq!(verdicts(&renewed.expect("imports")), ["replaces"]);
    let tokens = Tokens::open(&class.folder).expect("opens");
    let old: Ticket = class.tickets("one.csv")[0][2].parse().expect("a ticket");
    let told = tokens
        .grant(&old.token, NOW)
        .expect_err("revoked")
        .to_string();
    assert!(told.contains("revoked"), "{told}");
}

#[test]
fn a_bad_line_is_said_with_its_number_and_nothing_is_made() {
    let class = Class::new();
    let text = "station;ID\n\na-1;s-1\na-2;Jane Doe\n;s-3\na 4;s-4\na-5;s-1\na-6;\n";
    let roster = Roster::parse(text.as_bytes()).expect("a table");
    let lines = roster.examine(&[], &options(false), NOW);
    assert_eq!(
        verdicts(&lines),
        ["new", "fault", "fault", "fault", "fault", "fault"]
    );
    let said: Vec<String> = lines.iter().map(Line::to_string).collect();
    for (line, parts) in [
        (1, ["line 4", "learner", "`Jane Doe`", "opaque"]),
        (2, ["line 5", "station", "``", "letters"]),
        (3, ["line 6", "station", "`a 4`", "letters"]),
        (4, ["line 7", "learner", "`s-1`", "line 3"]),
        (5, ["line 8", "learner", "``", "opaque"]),
    ] {
        for part in parts {
            assert!(said[line].contains(part), "{part}: {}", said[line]);
        }
    }
    class.import(text, "t.csv", false).expect_err("faults");
    assert_eq!(class.store.list().expect("reads"), []);
    assert!(!class.place.path().join("t.csv").exists());
}

#[test]
fn an_existing_table_of_tickets_is_kept_and_no_token_is_made() {
    let class = Class::new();
    class
        .import("id,station\ns-1,a-1\n", "t.csv", false)
        .expect("imports");
    let before = class.tickets("t.csv");
    class
        .import("id,station\ns-2,a-2\n", "t.csv", false)
        .expect_err("exists");
    assert_eq!(class.tickets("t.csv"), before);
    assert_eq!(class.store.list().expect("reads").len(), 1);
}

#[test]
fn tables_are_read_as_spreadsheets_save_them() {
    let of = |bytes: &[u8]| Roster::parse(bytes).map(|roster| roster.rows);
    let rows = |line: u64| Ok(vec![(line, "s-1".to_owned(), "a-1".to_owned())]);
    assert_eq!(
        of(b"\xef\xbb\xbfLearner ID;Station;Note\r\ns-1;a-1;x\r\n"),
        rows(2)
    );
    assert_eq!(of(b"sep=;\nID;STATION\ns-1;a-1\n"), rows(3));
    assert_eq!(
        of(b"learner\tstation\n'1-1\ta-1\n").expect("tabs")[0].1,
        "1-1"
    );
    let text = "id\tStation\r\ns-1\ta-1\r\n";
    let utf_16: Vec<u8> = [0xfeff]
        .into_iter()
        .chain(text.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(of(&utf_16), rows(2));
    let told = of(b"name,room\nx,y\n").expect_err("other headings");
    assert!(
        told.contains("line 1") && told.contains("`station`"),
        "{told}"
    );
    assert_eq!(of(b"id,station\n"), Ok(vec![]));
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..120), text in "(id|learner),station\n[s0-9,\"\n;éa-]{0,60}") {
        for bytes in [&bytes[..], text.as_bytes()] {
            if let Ok(roster) = Roster::parse(bytes) {
                for line in roster.examine(&[], &options(false), NOW) {
                    prop_assert!(!line.to_string().contains('\n'));
                }
            }
        }
    }
}
