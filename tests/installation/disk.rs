//! A disk that is full or read-only: each command is refused with a sentence, nothing that was good is lost, and everything
//! works again afterwards.

use std::path::Path;
use std::process::Command;

use sulcus_support::Resource;
use sulcus_tests::{Ended, Place, Program, files_with};

use crate::snapshot::{audit, snapshot};

/// A small disk of its own, mounted at a folder. A drop takes it away.
struct Disk<'a> {
    folder: &'a Path,
}

impl<'a> Disk<'a> {
    fn mount(folder: &'a Path, size: &str) -> Result<Self, String> {
        std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
        let size = format!("size={size},mode=700");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &size, "sulcus-test"])
            .arg(folder)
            .output()
            .map_err(|error| format!("mount: {error}"))?;
        if mounted.status.success() {
            Ok(Self { folder })
        } else {
            Err(String::from_utf8_lossy(&mounted.stderr).trim().to_owned())
        }
    }

    fn remount(&self, how: &str) {
        let how = format!("remount,{how}");
        let mounted = Command::new("mount")
            .args(["-o", &how])
            .arg(self.folder)
            .status();
        assert!(mounted.expect("mount").success(), "{how}");
    }

    /// Fills the disk to the last byte.
    fn fill(&self) {
        let mut filler = std::fs::File::create(self.folder.join("filler.lock")).expect("a file");
        let mut length = 1 << 20;
        while length > 0 {
            match std::io::Write::write(&mut filler, &vec![0; length]) {
                Ok(written) if written > 0 => {}
                _ => length /= 2,
            }
        }
    }

    fn free(&self) {
        std::fs::remove_file(self.folder.join("filler.lock")).expect("the filler");
    }
}

impl Drop for Disk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount")
            .arg("--lazy")
            .arg(self.folder)
            .status();
    }
}

/// Commands that change the state, each with other values.
const CHANGES: [&str; 6] = [
    "token add --role instructor --out NAME.txt",
    "class import NAME.csv",
    "class keep Oak 400",
    "token revoke TOKEN",
    "person add NAME --role instructor",
    "certificate rotate",
];

fn run(place: &Place, line: &str) -> Ended {
    let words: Vec<&str> = line.split_whitespace().collect();
    place.run(Program::Server, &words)
}

/// A state with a certificate, a token, a class. Returns the id of the token.
fn prepared(place: &Place) -> String {
    std::fs::write(place.path("oak.csv"), "learner,class\ns-4f7k2,Oak\n").expect("a table");
    run(place, "class import oak.csv").ok();
    run(
        place,
        "token add --role student --station station --out ticket",
    )
    .ok();
    let list = run(place, "token list --json").ok().json();
    let id = list["tokens"][0]["id"].as_str();
    id.unwrap_or_else(|| panic!("{list}")).to_owned()
}

/// Each change is refused, and no byte of the state differs afterwards.
fn refuses_all(place: &Place, token: &str) {
    let state = place.path("state");
    let before = snapshot(&state);
    for (k, change) in CHANGES.iter().enumerate() {
        let name = format!("elm{k}");
        std::fs::write(
            place.path(&format!("{name}.csv")),
            format!("learner,class\ns-9z{k}x2,{name}\n"),
        )
        .expect("a table");
        let line = change.replace("NAME", &name).replace("TOKEN", token);
        let ended = run(place, &line);
        ended.refused(&["state"]);
        assert!(
            !place.path(&format!("{name}.txt")).exists(),
            "{line}: a ticket that is not valid"
        );
        let after = snapshot(&state);
        let changed: Vec<_> = before
            .keys()
            .chain(after.keys())
            .filter(|path| before.get(*path) != after.get(*path))
            .collect();
        assert!(changed.is_empty(), "{line}: {changed:?}");
    }
}

/// Each change works, and the audit log has grown by entries alone.
fn accepts_all(place: &Place, token: &str) {
    let before = audit(&place.path("state"));
    for (k, change) in CHANGES.iter().enumerate() {
        let name = format!("elm{k}");
        run(
            place,
            &change.replace("NAME", &name).replace("TOKEN", token),
        )
        .ok();
    }
    let after = audit(&place.path("state"));
    assert!(after.starts_with(&before), "entries are never lost");
    assert!(after.len() > before.len(), "{after:?}");
}

#[test]
fn a_full_disk_of_the_state_refuses_changes_and_loses_nothing() {
    let place = Place::new();
    let state = place.path("state");
    let Some(disk) = Resource::Image.or_skip(Disk::mount(&state, "4m")) else {
        return;
    };
    let token = prepared(&place);
    disk.fill();
    refuses_all(&place, &token);
    disk.free();
    accepts_all(&place, &token);
}

#[test]
fn a_read_only_disk_of_the_state_refuses_changes_and_loses_nothing() {
    let place = Place::new();
    let state = place.path("state");
    let Some(disk) = Resource::Image.or_skip(Disk::mount(&state, "4m")) else {
        return;
    };
    let token = prepared(&place);
    disk.remount("ro");
    refuses_all(&place, &token);
    disk.remount("rw");
    accepts_all(&place, &token);
}

#[test]
fn recordings_on_a_read_only_disk_are_refused_with_a_sentence_and_the_next_session_is_whole() {
    let place = Place::new();
    let recordings = place.path("recordings");
    let Some(disk) = Resource::Image.or_skip(Disk::mount(&recordings, "200m")) else {
        return;
    };
    let server = place.serve(&["--exercise", "crown"]);
    let hand = || place.perform(&server, &["--duration", "2"]);
    let first = hand();
    assert_eq!(first.code, 0, "{first:#?}");
    let before = snapshot(&recordings);
    assert_eq!(before.len(), 1);

    disk.remount("ro");
    let refused = hand();
    assert_eq!(refused.code, 1, "{refused:#?}");
    let why = "cannot make recording";
    assert!(refused.stderr.contains(why), "{refused:#?}");
    assert_eq!(
        snapshot(&recordings),
        before,
        "the first recording is as it was"
    );

    disk.remount("rw");
    let again = hand();
    assert_eq!(again.code, 0, "{again:#?}");
    let found = files_with(&recordings, "mcap");
    assert_eq!(found.len(), 2, "{found:?}");
    for file in found {
        let file = file.to_str().expect("plain");
        let replay = place.run(Program::Sessions, &["replay", file, "--json"]);
        assert_eq!(replay.ok().json()["identical"], true);
    }
    drop(server);
}
