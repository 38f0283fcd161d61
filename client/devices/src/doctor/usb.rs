//! Check of the devices that are plugged in.

use super::check::Check;
use super::sysfs::UsbDevice;

const NAME: &str = "usb";
/// Most devices with their names in the message.
const NAMED: usize = 4;

/// Lists the known devices. A computer without a force device is ok.
pub fn check(devices: &[UsbDevice]) -> Check {
    if devices.is_empty() {
        return Check::fine(
            NAME,
            "no force device is plugged in; mouse, 3D mouse and gamepad need none. The Haply service finds its own \
             devices: see `port`.",
        );
    }
    let mut names: Vec<String> = devices
        .iter()
        .take(NAMED)
        .map(|device| format!("{} at {}", device.label(), device.place))
        .collect();
    if devices.len() > NAMED {
        names.push(format!("{} more", devices.len() - NAMED));
    }
    let names = names.join(", ");
    if devices.iter().any(|device| device.kind.library.is_some()) {
        Check::fine(NAME, format!("plugged in: {names}."))
    } else {
        Check::fine(
            NAME,
            format!("plugged in: {names}. No force device is plugged in."),
        )
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::super::sysfs::known;
    use super::super::tree::{Tree, sound};
    use super::*;

    #[test]
    fn no_device_is_ok() {
        let check = check(&[]);
        assert!(check.ok);
        assert!(
            check.message.starts_with(
                "no force device is plugged in; mouse, 3D mouse and gamepad need none"
            ),
            "{check:?}"
        );
    }

    #[test]
    fn devices_are_named_with_numbers_and_place() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o600);
        tree.bus("2-1", 0x0403, 0xcb48, 0o666);
        tree.bus("2-2", 0x046d, 0xc31c, 0o600);
        let check = check(&known(&tree.roots().usb));
        assert_eq!(
            check.message,
            "plugged in: Touch USB (2988:0302) at 1-2, Novint Falcon (0403:cb48) at 2-1."
        );
    }

    #[test]
    fn a_3d_mouse_is_no_force_device() {
        let tree = Tree::new();
        tree.raw("1-2", 0x256f, 0xc635, 0, 0o666);
        let check = check(&known(&tree.roots().usb));
        assert!(check.ok && check.message.contains("3D mouse (256f:c635)"));
        assert!(check.message.contains("No force device"));
    }

    #[test]
    fn many_devices_fit_in_a_message() {
        let tree = Tree::new();
        for port in 1..=12 {
            tree.bus(&format!("1-1.{port}.{port}.{port}"), 0x1451, 0x0402, 0o600);
        }
        let check = check(&known(&tree.roots().usb));
        assert!(check.message.contains("8 more"), "{check:?}");
        sound(&[check]);
    }
}
