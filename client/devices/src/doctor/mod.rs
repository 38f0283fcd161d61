//! Checks of a computer before a run with haptic devices.
//!
//! [`examine`] looks at libraries, drivers, rights, the network, clocks and the disk. Each [`Check`] is ok or says what
//! to do. No check changes the system, needs the rights of an administrator, or makes a device move.

mod certificate;
mod check;
mod clock;
mod config;
mod dependencies;
mod disk;
mod driver;
mod kind;
mod library;
mod permission;
mod port;
mod realtime;
mod roots;
mod sysfs;
#[cfg(all(test, target_os = "linux"))]
mod tree;
mod udp;
mod usb;

use std::path::PathBuf;

pub use check::Check;
pub use roots::{Right, Roots};

use crate::Found;

/// Question to [`examine`].
#[derive(Clone, Debug)]
pub struct Asked {
    /// Folder of the recordings. The folder may be missing; no check creates it.
    pub recordings: PathBuf,
    /// Server as `HOST:PORT`, if one was named.
    pub server: Option<String>,
    /// Result of reading a given ticket. The text of `Ok` appears in a message: the fingerprint, never the token. The
    /// text of `Err` is the reason.
    pub ticket: Option<Result<String, String>>,
    /// Places of the system.
    pub roots: Roots,
}

/// Examines the computer. The call takes some seconds at most: every back-end lists its devices, a name of a server is
/// looked up for at most 3 s, and the clock needs 60 ms.
pub fn examine(asked: &Asked) -> Vec<Check> {
    let found: Vec<Found> = crate::backends()
        .iter()
        .flat_map(|backend| backend.list())
        .collect();
    examine_with(asked, &found)
}

/// Examines the computer with the given list of the back-ends.
fn examine_with(asked: &Asked, found: &[Found]) -> Vec<Check> {
    let roots = &asked.roots;
    let devices = sysfs::known(&roots.usb);
    let mut checks = library::checks(found, &devices);
    if cfg!(target_os = "linux") {
        checks.extend(driver::checks(roots, &devices));
        checks.extend(permission::checks(roots, &devices));
        checks.push(usb::check(&devices));
    } else {
        checks.extend(["driver", "permission", "usb"].map(Check::elsewhere));
    }
    checks.push(port::check(roots));
    checks.extend(udp::checks(asked.server.as_deref()));
    checks.push(certificate::check(asked.ticket.as_ref()));
    checks.push(clock::check());
    checks.push(realtime::check(roots));
    checks.push(disk::check(&asked.recordings));
    checks
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::collections::BTreeSet;

    use super::tree::{Tree, sound};
    use super::*;

    fn asked(tree: &Tree) -> Asked {
        Asked {
            recordings: tree.path("recordings"),
            server: Some("127.0.0.1:4433".into()),
            ticket: Some(Ok("00ff".repeat(16))),
            roots: tree.roots(),
        }
    }

    #[test]
    fn every_group_answers_once_or_more_without_a_device() {
        let tree = Tree::new();
        tree.folder("recordings");
        let checks = examine(&asked(&tree));
        let groups: Vec<_> = checks.iter().map(Check::group).collect();
        for group in [
            "library",
            "driver",
            "permission",
            "usb",
            "port",
            "udp",
            "certificate",
            "clock",
            "real-time",
            "disk",
        ] {
            assert!(groups.contains(&group), "no check of {group}: {groups:?}");
        }
        sound(&checks);
    }

    #[test]
    fn names_are_unique_with_two_equal_devices() {
        let tree = Tree::new();
        tree.touch("1-1", 0, 0o600);
        tree.touch("1-2", 1, 0o600);
        let checks = examine_with(&asked(&tree), &[]);
        sound(&checks);
        let names: BTreeSet<_> = checks.iter().map(|check| &check.name).collect();
        assert_eq!(names.len(), checks.len(), "{checks:?}");
        let refused = |check: &&Check| check.group() == "permission" && !check.ok;
        assert_eq!(checks.iter().filter(refused).count(), 2);
    }

    #[test]
    fn a_check_has_three_fields_in_json() {
        let value = serde_json::to_value(Check::wrong("usb", "text")).expect("plain fields");
        assert_eq!(
            value,
            serde_json::json!({"name": "usb", "ok": false, "message": "text"})
        );
    }
}
