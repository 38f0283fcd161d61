//! Versions of the recording's layout and of what its numbers mean.
//!
//! A recording can be replayed bit for bit only by a program whose tick gives the same bits. The version is raised, on
//! purpose, when the layout changes *or* when the tick gives other bits for the recordings under `sessions/tests/corpus`. The change
//! that raises it says here what is different and what becomes of older files:
//!
//! - A version that is *read as the present one*: its tick gives the same bits. Version 4 is such a one: its exact messages are
//!   encoded otherwise, and each channel names its encoding (`Layout`).
//! - A version that is *migrated*: its inputs are run again by the present tick, from the first snapshot to the end. The replay
//!   may then differ, never far ([`CLOSE`]), and a grade rests on it and says so. A replay does not go on from later snapshots, only
//!   compares them: an older number in a header must not buy a grade with states that no hand ever brought about.
//! - A version that is not read: versions 1 and 2 were written for two days in November 2026, before the first release, and no file
//!   of them was kept.
//!
//! Chain and signatures are over the inner bytes as they were written, and hold or do not in every version. A few files
//! of each former version are kept in `sessions/tests/corpus/format-N`, so that they are tested for good.

use serde::Serialize;

use crate::record::header::FORMAT_VERSION;
use crate::replay::Deviation;

/// A version that is known.
struct Version {
    number: &'static str,
    /// What was different, for its reader.
    what: &'static str,
    read: Read,
}

/// Treatment of a recording of a former version.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Read {
    /// Nothing reads it.
    Not,
    /// Its inputs are run by the present tick, which gives other bits.
    Migrated,
    /// The present tick gives the same bits.
    AsPresent,
}

/// How the messages of an exact channel are encoded. Each channel's record in the file names its encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// The exact bytes alone, in encodings of their own: up to version 4.
    Bare,
    /// In a protobuf message with one field of bytes (`crate::record::envelope`): from version 5 on.
    Protobuf,
}

/// All versions before the present one.
const FORMER: [Version; 4] = [
    Version {
        number: "1",
        what: "its rows have no level of detail and its states no tissue; written on 21 November 2026 by 0.1.0, before release",
        read: Read::Not,
    },
    Version {
        number: "2",
        what: "its states spell out tissue at rest, so that hashes are others; written on 21 and 22 November 2026 by 0.1.0, before release",
        read: Read::Not,
    },
    Version {
        number: "3",
        what: "its tick put the rows of blended surfaces together in another way, so that some hashes are others",
        read: Read::Migrated,
    },
    Version {
        number: "4",
        what: "its exact messages are not wrapped in protobuf, so that other programs do not decode them",
        read: Read::AsPresent,
    },
];

/// How far the replay of a migrated recording may be from what was recorded for a grade to rest on it.
///
/// The grade is of the inputs, run by the present tick, whatever the record says came out; this says that what the learner felt is
/// what is graded. In a single tick a force may have been in its ramp or not; the mean of every ten seconds and the tools' places say
/// whether the session is the same. Judged by what a grade tells apart: 0.05 N of force at a floor, and a tenth of the millimetre
/// to which depths are read.
pub const CLOSE: Close = Close {
    rms_force_n: 0.01,
    pose_mm: 0.1,
};

/// See [`CLOSE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Close {
    /// Root mean square of the difference in force under load, in any stretch between snapshots, newtons.
    pub rms_force_n: f64,
    /// Difference in a graphic tool's place at snapshots, millimetres.
    pub pose_mm: f64,
}

impl Close {
    /// Whether a replay is as close, and every row and snapshot is of the tick that it should be.
    pub fn holds(&self, found: &Deviation) -> bool {
        found.out_of_step == 0
            && found.rms_force_n <= self.rms_force_n
            && found.max_pose_mm.unwrap_or_default() <= self.pose_mm
    }
}

/// That a recording is of a former version that this program reads all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Migration {
    /// Its version.
    pub from: &'static str,
    /// The present one.
    pub to: &'static str,
    /// What was different.
    pub what: &'static str,
}

impl std::fmt::Display for Migration {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "from format {} to {}: {}", self.from, self.to, self.what)
    }
}

/// The migration of a recording of version `found`; `None` where its numbers are the present ones.
///
/// # Errors
/// When it cannot be: what to do, a clause that follows "this program reads ...".
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
                "that version is older ({}); nothing reads it any more",
                former.what
            )),
        };
    }
    let number = |text: &str| text.parse::<u32>().ok();
    Err(match (number(found), number(FORMAT_VERSION)) {
        (Some(found), Some(own)) if found > own => {
            "that version is newer: use the Sulcus version that wrote it, or a later one"
        }
        _ => "there never was such a version: the header is damaged",
    }
    .to_owned())
}

/// The versions that are read, in words.
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
        assert_eq!(reads("4"), Ok(None));
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

    #[test]
    fn close_is_close_in_the_mean_and_in_place() {
        let far = |rms_force_n, max_pose_mm| Deviation {
            rms_force_n,
            max_pose_mm,
            max_force_n: 1.0,
            ..Deviation::default()
        };
        assert!(CLOSE.holds(&far(0.01, None)));
        assert!(CLOSE.holds(&far(0.0, Some(0.1))));
        assert!(!CLOSE.holds(&far(0.011, None)));
        assert!(!CLOSE.holds(&far(0.0, Some(0.11))));
        assert!(!CLOSE.holds(&far(f64::NAN, None)));
        let out_of_step = Deviation {
            out_of_step: 1,
            ..Deviation::default()
        };
        assert!(!CLOSE.holds(&out_of_step));
    }
}
