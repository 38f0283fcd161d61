//! Versions of a recording's layout and of the meaning of its numbers.
//!
//! A replay is bit-identical only if the tick of the program has the same bits as the tick of the recording. A change
//! of the layout raises the version, and so does a change of the bits of `sessions/tests/corpus`. The change adds the
//! former version to `FORMER`, with the difference and one of three treatments:
//!
//! - Read as the present version: the tick has the same bits. In version 4 only the encoding of the exact messages
//!   differs, and each channel names its encoding (`Layout`). Version 5 has no samples of devices and fewer fields in
//!   the header. A grade treats gaps of the connection in recordings from version 6 on ([`GAPS_SINCE`]). Version 6 has
//!   no couplings of its own in the header, and fewer facts of a device.
//! - Migrated: the present tick runs the inputs, from the first snapshot to the end. A grade may rest on the replay as
//!   long as the replay stays close ([`crate::replay::CLOSE`]), and says so. Later snapshots are only compared.
//!   Otherwise an older version number in a header could bring a state into a grade that no hand has caused.
//! - Not read: versions 1 and 2. Both were written for two days in November 2026, before the first release, and no file
//!   exists.
//!
//! Chain and signatures cover the inner bytes as written, in every version. `sessions/tests/corpus/format-N` contains a
//! few files of each former version.

use serde::Serialize;

use crate::record::header::FORMAT_VERSION;

/// First version whose gaps of the connection a grade leaves out. The numbers of older recordings stay as they were.
pub const GAPS_SINCE: u32 = 6;

/// A former version.
struct Version {
    number: &'static str,
    /// Difference to the next version, for users.
    what: &'static str,
    read: Read,
}

/// Treatment of a recording of a former version.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Read {
    /// The version is refused.
    Not,
    /// The present tick runs the inputs and gives other bits.
    Migrated,
    /// The present tick gives the same bits.
    AsPresent,
}

/// Encoding of the messages of an exact channel. The record of each channel in the file names its encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// The exact bytes without protobuf: up to version 4.
    Bare,
    /// A protobuf message with one field of bytes (`crate::record::envelope`): from version 5 on.
    Protobuf,
}

/// All versions before the present one.
const FORMER: [Version; 6] = [
    Version {
        number: "1",
        what: "rows have no level of detail, and states have no tissue; written on 21 November 2026 by 0.1.0, before release",
        read: Read::Not,
    },
    Version {
        number: "2",
        what: "states contain tissue at rest, so the hashes differ; written on 21 and 22 November 2026 by 0.1.0, before release",
        read: Read::Not,
    },
    Version {
        number: "3",
        what: "the tick combined the rows of blended surfaces in another way, so some hashes differ",
        read: Read::Migrated,
    },
    Version {
        number: "4",
        what: "exact messages are not wrapped in protobuf, so other programs do not decode them",
        read: Read::AsPresent,
    },
    Version {
        number: "5",
        what: "what the hand felt is not recorded, and gaps of the connection are not graded apart",
        read: Read::AsPresent,
    },
    Version {
        number: "6",
        what: "couplings are always those of the scene, and devices have fewer facts",
        read: Read::AsPresent,
    },
];

/// Migration of a recording of a former version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Migration {
    /// Version of the recording.
    pub from: &'static str,
    /// Present version.
    pub to: &'static str,
    /// Difference between the versions.
    pub what: &'static str,
}

impl std::fmt::Display for Migration {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "from format {} to {}: {}", self.from, self.to, self.what)
    }
}

/// Migration of a recording of version `found`; `None` if the present tick gives the same bits.
///
/// # Errors
/// The version is not read: a clause with the reason, to follow "this program reads ...".
pub(crate) fn reads(found: &str) -> Result<Option<Migration>, String> {
    if found == FORMAT_VERSION {
        return Ok(None);
    }
    if let Some(former) = FORMER.iter().find(|version| version.number == found) {
        let migration = Migration {
            from: former.number,
            to: FORMAT_VERSION,
            what: former.what,
        };
        return match former.read {
            Read::AsPresent => Ok(None),
            Read::Migrated => Ok(Some(migration)),
            Read::Not => Err(format!(
                "that version is older ({}), and no present program reads it",
                former.what
            )),
        };
    }
    let number = |text: &str| text.parse::<u32>().ok();
    Err(match (number(found), number(FORMAT_VERSION)) {
        (Some(found), Some(own)) if found > own => {
            "that version is newer: use the Sulcus version that wrote the recording, or a later version"
        }
        _ => "that version never existed: the header is damaged",
    }
    .to_owned())
}

/// List of the versions that are read, as text.
pub(crate) fn readable() -> String {
    let of = |read: Read| {
        let versions = FORMER.iter().filter(move |version| version.read == read);
        versions.map(|version| format!("`{}`", version.number))
    };
    let present = of(Read::AsPresent).fold(format!("`{FORMAT_VERSION}`"), |said, version| {
        format!("{said}, {version}")
    });
    of(Read::Migrated).fold(present, |said, version| {
        format!("{said} and, migrated, {version}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_former_version_is_known_and_others_are_told_apart() {
        let own: u32 = FORMAT_VERSION.parse().expect("a number");
        assert_eq!(reads(FORMAT_VERSION), Ok(None));
        assert_eq!((reads("4"), reads("5")), (Ok(None), Ok(None)));
        for former in 1..own {
            let found = former.to_string();
            match reads(&found) {
                Ok(migration) => assert!(migration.is_none_or(|it| it.from == found)),
                Err(said) => assert!(
                    said.starts_with("that version is older"),
                    "{former}: {said}"
                ),
            }
        }
        assert!(
            reads(&(own + 1).to_string())
                .expect_err("not read")
                .contains("newer")
        );
        for none in ["", "0", "-1", "x", "3.1", "03"] {
            assert!(
                reads(none).expect_err("not read").contains("damaged"),
                "{none}"
            );
        }
    }
}
