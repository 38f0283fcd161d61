//! Check of the libraries that the library of OpenHaptics needs.

use std::path::{Path, PathBuf};

use super::check::{Check, part};
use super::roots::Roots;

const NAME: &str = "driver libraries";
/// Libraries of the driver itself: of OpenHaptics 3.4 and of 3.0. One of them must open.
const IO: [&str; 2] = ["libPhantomIOLib42.so", "libPHANToMIO.so.4"];
const CURSES: &str = "libncurses.so.5";

/// Whether a folder has the library of OpenHaptics.
fn installed(folders: &[PathBuf]) -> bool {
    let has = |folder: &Path| {
        std::fs::read_dir(folder)
            .into_iter()
            .flatten()
            .filter_map(Result::ok)
            .any(|entry| entry.file_name().to_string_lossy().starts_with("libHD.so"))
    };
    folders.iter().any(|folder| has(folder))
}

/// Opens the libraries in turn; `None` if OpenHaptics is not installed.
pub fn check(roots: &Roots) -> Option<Check> {
    installed(&roots.libraries).then(|| open(roots))
}

fn open(roots: &Roots) -> Check {
    if let Err(reason) = (roots.opens)(CURSES) {
        return Check::wrong(
            NAME,
            format!(
                "OpenHaptics needs {CURSES}, which does not open: {}. Install the package libncurses5 of the \
                 distribution.",
                part(&reason)
            ),
        );
    }
    let mut reasons = IO.iter().map(|name| (roots.opens)(name));
    match reasons.next() {
        Some(Err(reason)) if reasons.all(|result| result.is_err()) => Check::wrong(
            NAME,
            format!(
                "OpenHaptics needs {}, which does not open: {}. Install the vendor's device driver package and run: \
                 sudo ldconfig",
                IO[0],
                part(&reason)
            ),
        ),
        _ => Check::fine(NAME, "the libraries that OpenHaptics needs can be opened."),
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::super::tree::{Tree, sound};
    use super::*;

    fn of(roots: &Roots) -> Check {
        let check = check(roots).expect("OpenHaptics is installed");
        sound(std::slice::from_ref(&check));
        check
    }

    #[test]
    fn each_missing_library_has_its_remedy() {
        let tree = Tree::new();
        assert_eq!(check(&tree.roots()), None);
        tree.file("lib/libHD.so.3.4", "");
        let mut roots = tree.roots();
        assert_eq!(check(&roots).map(|check| check.ok), Some(true));
        roots.opens = |name| match name {
            CURSES => Err(format!("{name}: cannot open shared object file")),
            _ => Ok(()),
        };
        assert!(of(&roots).message.contains("libncurses5"));
        roots.opens = |name| match name {
            "libPhantomIOLib42.so" => Err(format!("{name}: cannot open shared object file")),
            _ => Ok(()),
        };
        assert!(of(&roots).ok, "the driver of 3.0 is there");
        roots.opens = |name| match name {
            CURSES => Ok(()),
            _ => Err(format!("{name}: cannot open shared object file")),
        };
        let refused = of(&roots);
        assert!(
            !refused.ok && refused.message.contains("driver package"),
            "{refused:?}"
        );
    }
}
