//! Versions of the recording's layout and of what its numbers mean.
//!
//! A recording can be replayed bit for bit only by a program whose tick gives the same bits. So the version is raised, on
//! purpose, when the layout changes *or* when the tick gives other bits for the recordings under `sessions/tests/corpus`; whoever
//! raises it writes here what changed and what is to be done with older files.
//!
//! What exists: this table, which tells a reader of an older (or newer) file what it is and what to do. What does not: a way to
//! read versions 1 and 2. They were written for two days in November 2026, before the first release; no file of theirs was kept, so
//! that a migration could not be tested. The first migration belongs here, as a function from an old file's header and rows to
//! the present ones: rows of another tick can be run again and then deviate ([`crate::replay::Deviation`]), never be identical.

use crate::header::FORMAT_VERSION;

/// A version that is known.
struct Version {
    number: &'static str,
    /// What was different, for its reader.
    what: &'static str,
}

/// All versions before the present one.
const FORMER: [Version; 2] = [
    Version {
        number: "1",
        what: "its rows have no level of detail and its states no tissue; written on 21 November 2026 by 0.1.0, before release",
    },
    Version {
        number: "2",
        what: "its states spell out tissue at rest, so that hashes are others; written on 21 and 22 November 2026 by 0.1.0, before release",
    },
];

/// What to do with a recording of version `found`, which is not the present one: a clause that follows "this program reads ...".
pub(crate) fn advice(found: &str) -> String {
    if let Some(former) = FORMER.iter().find(|version| version.number == found) {
        return format!(
            "that version is older ({}); nothing reads it any more",
            former.what
        );
    }
    let number = |text: &str| text.parse::<u32>().ok();
    match (number(found), number(FORMAT_VERSION)) {
        (Some(found), Some(own)) if found > own => {
            "that version is newer: use the Sulcus version that wrote it, or a later one".to_owned()
        }
        _ => "there never was such a version: the header is damaged".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_former_version_is_known_and_others_are_told_apart() {
        let own: u32 = FORMAT_VERSION.parse().expect("a number");
        for former in 1..own {
            let said = advice(&former.to_string());
            assert!(
                said.starts_with("that version is older"),
                "{former}: {said}"
            );
        }
        assert!(advice(&(own + 1).to_string()).contains("newer"));
        for none in ["", "0", "-1", "x", "3.1"] {
            assert!(advice(none).contains("damaged"), "{none}");
        }
    }
}
