//! Check of the libraries and services of the back-ends.

use super::check::{Check, shorten};
use super::sysfs::UsbDevice;
use crate::{Found, State};

const NAME: &str = "library";
/// Most characters of a back-end's own message.
const LONGEST: usize = 180;

/// Returns one check for each back-end of the list. An absent library fails its check only if a device needs it.
pub fn checks(found: &[Found], devices: &[UsbDevice]) -> Vec<Check> {
    let mut libraries: Vec<&str> = Vec::new();
    for entry in found {
        if !libraries.contains(&entry.library) {
            libraries.push(entry.library);
        }
    }
    libraries
        .into_iter()
        .map(|library| {
            let entries: Vec<&Found> = found
                .iter()
                .filter(|entry| entry.library == library)
                .collect();
            let plugged = devices
                .iter()
                .find(|device| device.kind.library == Some(library));
            check(library, &entries, plugged)
        })
        .collect()
}

fn check(library: &str, entries: &[&Found], plugged: Option<&UsbDevice>) -> Check {
    let name = format!("{NAME} {library}");
    let with = |wanted: State| entries.iter().find(|entry| entry.state == wanted);
    if let Some(entry) = with(State::WrongVersion).or_else(|| with(State::Error)) {
        return Check::wrong(name, own(entry));
    }
    let devices = entries
        .iter()
        .filter(|entry| !entry.serial.is_empty())
        .count();
    let absent = with(State::NoLibrary).or_else(|| with(State::NoDevice));
    match (absent, plugged) {
        (Some(entry), Some(device)) if devices == 0 && entry.state == State::NoLibrary => {
            Check::wrong(
                name,
                format!(
                    "{} is plugged in and needs this library. {}",
                    device.label(),
                    own(entry)
                ),
            )
        }
        (Some(entry), Some(device)) if devices == 0 => Check::wrong(
            name,
            format!(
                "{} is plugged in, but the library does not find it: see `permission` and `driver`. {}",
                device.label(),
                own(entry)
            ),
        ),
        (Some(entry), None) if devices == 0 && entry.state == State::NoLibrary => Check::fine(
            name,
            format!(
                "absent, and no device that is plugged in needs it. {}",
                own(entry)
            ),
        ),
        (Some(entry), None) if devices == 0 => Check::fine(name, format!("open. {}", own(entry))),
        _ => match entries.iter().find(|entry| entry.state != State::Ready) {
            Some(entry) => Check::fine(name, format!("open, devices: {devices}. {}", own(entry))),
            None => Check::fine(name, format!("open, devices: {devices}, all ready.")),
        },
    }
}

/// A back-end's own message.
fn own(entry: &Found) -> String {
    shorten(&entry.message, LONGEST)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::super::sysfs::known;
    use super::super::tree::{Tree, sound};
    use super::*;

    fn device(serial: &str, state: State, message: &str) -> Found {
        Found {
            model: "omega.6".into(),
            serial: serial.into(),
            motion_dof: 6,
            force_dof: 3,
            ..Found::nothing("forcedimension", state, message)
        }
    }

    fn of(found: &[Found], tree: &Tree) -> Vec<Check> {
        let checks = checks(found, &known(&tree.roots().usb));
        sound(&checks);
        checks
    }

    #[test]
    fn an_absent_library_is_wrong_only_with_its_device() {
        let found = [
            Found::nothing("haply", State::NoLibrary, "the service is absent"),
            Found::nothing(
                "openhaptics",
                State::NoLibrary,
                "libHD.so is absent: install OpenHaptics",
            ),
            Found::nothing("forcedimension", State::NoLibrary, "libdrd.so.3 is absent"),
        ];
        let tree = Tree::new();
        assert!(of(&found, &tree).iter().all(|check| check.ok));
        tree.touch("1-2", 0, 0o666);
        let checks = of(&found, &tree);
        let states: Vec<_> = checks
            .iter()
            .map(|check| (check.name.as_str(), check.ok))
            .collect();
        assert_eq!(
            states,
            [
                ("library haply", true),
                ("library openhaptics", false),
                ("library forcedimension", true)
            ]
        );
        assert!(checks[1].message.contains("Touch USB (2988:0302)"));
        assert!(checks[1].message.contains("install OpenHaptics"));
    }

    #[test]
    fn a_plugged_device_that_the_library_does_not_see_is_wrong() {
        let tree = Tree::new();
        let found = [Found::nothing(
            "forcedimension",
            State::NoDevice,
            "no device",
        )];
        assert!(of(&found, &tree)[0].ok);
        tree.bus("2-1", 0x1451, 0x0402, 0o600);
        let check = &of(&found, &tree)[0];
        assert!(
            !check.ok && check.message.contains("see `permission`"),
            "{check:?}"
        );
        assert!(of(&[device("12", State::Ready, "ready")], &tree)[0].ok);
    }

    #[test]
    fn a_wrong_version_is_wrong_without_a_device() {
        let found = [Found::nothing(
            "openhaptics",
            State::WrongVersion,
            "hdGetError is missing",
        )];
        let check = &of(&found, &Tree::new())[0];
        assert!(!check.ok && check.message == "hdGetError is missing");
    }

    #[test]
    fn devices_are_counted_and_the_first_that_is_not_ready_is_told() {
        let found = [
            device("1", State::Ready, "ready"),
            device("2", State::InUse, "another program uses the device"),
        ];
        let check = &of(&found, &Tree::new())[0];
        assert!(check.ok);
        assert_eq!(
            check.message,
            "open, devices: 2. another program uses the device"
        );
        assert_eq!(
            of(&found[..1], &Tree::new())[0].message,
            "open, devices: 1, all ready."
        );
    }

    #[test]
    fn a_long_message_of_a_back_end_is_shortened() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o666);
        let found = [Found::nothing(
            "openhaptics",
            State::NoDevice,
            "x".repeat(4000),
        )];
        let check = &checks(&found, &known(&tree.roots().usb))[0];
        assert!(check.message.chars().count() <= 300 && check.message.contains("see `permission`"));
    }
}
