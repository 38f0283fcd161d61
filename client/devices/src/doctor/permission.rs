//! Check of the rights to the device nodes. The udev rule is printed; nothing is changed.

use std::path::Path;

use super::check::{Check, shown};
use super::kind::{Kind, Node};
use super::roots::{Right, Roots};
use super::sysfs::UsbDevice;

const NAME: &str = "permission";
/// File of the udev rules, and the commands that make them take effect.
const RULES: &str = "/etc/udev/rules.d/70-sulcus-devices.rules";
const RELOAD: &str = "sudo udevadm control --reload && sudo udevadm trigger";

/// Returns one check for each device. Without a device, the only check is ok.
pub fn checks(roots: &Roots, devices: &[UsbDevice]) -> Vec<Check> {
    if devices.is_empty() {
        return vec![Check::fine(
            NAME,
            "no known device is plugged in, so no permission is needed.",
        )];
    }
    devices.iter().map(|device| check(roots, device)).collect()
}

fn check(roots: &Roots, device: &UsbDevice) -> Check {
    let name = format!("{NAME} {}", device.place);
    let label = device.label();
    if device.kind.library.is_none() && roots.spacenavd.exists() {
        return Check::fine(
            name,
            format!("{label}: spacenavd reads the device for all users."),
        );
    }
    let nodes = device.nodes(&roots.dev);
    if nodes.is_empty() {
        let kind = match device.kind.node {
            Node::Serial => "/dev/ttyACM*",
            Node::HidRaw => "/dev/hidraw*",
            Node::Bus | Node::Any => "/dev/bus/usb",
        };
        return Check::wrong(
            name,
            format!(
                "{label}: the kernel made no device node {kind}. Unplug the device, plug it in again and read the last \
                 lines of: sudo dmesg"
            ),
        );
    }
    if let Some(node) = nodes.iter().find(|node| !node.exists()) {
        return Check::wrong(
            name,
            format!(
                "{label}: the device node {} is missing. Pass the node on to the container, or start udev.",
                node_name(roots, node)
            ),
        );
    }
    if let Some(node) = nodes
        .iter()
        .find(|node| !(roots.allowed)(node, Right::ReadWrite))
    {
        return Check::wrong(
            name,
            format!(
                "{label}: no right to {}. Put this line into {RULES}: {} Then run: {RELOAD}",
                node_name(roots, node),
                rule(device)
            ),
        );
    }
    let nodes: Vec<_> = nodes
        .iter()
        .take(2)
        .map(|node| node_name(roots, node))
        .collect();
    Check::fine(
        name,
        format!(
            "{label}: this user may read and write {}.",
            nodes.join(" and ")
        ),
    )
}

/// Path of a node as it reads on a real system: a long root of a made-up tree must not push out the rule.
fn node_name(roots: &Roots, node: &Path) -> String {
    let below = node.strip_prefix(&roots.dev).unwrap_or(node);
    shown(&Path::new("/dev").join(below))
}

/// Rule of udev for a device. The rule covers all nodes of the device: its parent on USB decides.
fn rule(device: &UsbDevice) -> String {
    rule_of(device.vendor, device.product, device.kind)
}

/// Rule for a vendor and a product.
fn rule_of(vendor: u16, product: u16, kind: Kind) -> String {
    let product = if kind.whole_vendor {
        String::new()
    } else {
        format!(r#", ATTRS{{idProduct}}=="{product:04x}""#)
    };
    format!(r#"SUBSYSTEMS=="usb", ATTRS{{idVendor}}=="{vendor:04x}"{product}, MODE="0666""#)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::super::sysfs::known;
    use super::super::tree::{Tree, sound};
    use super::*;

    fn of(tree: &Tree) -> Vec<Check> {
        let roots = tree.roots();
        let checks = checks(&roots, &known(&roots.usb));
        sound(&checks);
        checks
    }

    /// Rules that the package of the client installs.
    const INSTALLED: &str = include_str!("../../../../docker/70-sulcus-devices.rules");

    #[test]
    fn the_installed_rules_are_those_of_all_known_devices_and_of_no_other() {
        use std::collections::BTreeSet;
        let lines = INSTALLED
            .lines()
            .filter(|line| !line.starts_with('#') && !line.is_empty());
        let installed: BTreeSet<&str> = lines.collect();
        let mut expected = BTreeSet::new();
        for vendor in [0x2988, 0x0301, 0x1451, 0x0403, 0x256f, 0x046d] {
            for product in 0..=u16::MAX {
                if let Some(kind) = super::super::kind::kind(vendor, product) {
                    expected.insert(rule_of(vendor, product, kind));
                }
            }
        }
        let expected: BTreeSet<&str> = expected.iter().map(String::as_str).collect();
        assert_eq!(installed, expected);
    }

    #[test]
    fn a_touch_without_permission_gets_the_rule_and_the_commands() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o660);
        let checks = of(&tree);
        assert_eq!(checks.len(), 1);
        assert!(!checks[0].ok);
        assert_eq!(checks[0].name, "permission 1-2");
        assert_eq!(
            checks[0].message,
            "Touch USB (2988:0302): no right to /dev/ttyACM0. Put this line into \
             /etc/udev/rules.d/70-sulcus-devices.rules: SUBSYSTEMS==\"usb\", ATTRS{idVendor}==\"2988\", \
             MODE=\"0666\" Then run: sudo udevadm control --reload && sudo udevadm trigger"
        );
    }

    #[test]
    fn a_falcon_with_permission_is_ok_and_without_gets_a_rule_of_its_product() {
        let tree = Tree::new();
        tree.bus("2-1", 0x0403, 0xcb48, 0o666);
        assert!(of(&tree)[0].ok);
        tree.mode("dev/bus/usb/002/001", 0o664);
        let check = &of(&tree)[0];
        assert!(!check.ok);
        let rule = r#"ATTRS{idVendor}=="0403", ATTRS{idProduct}=="cb48", MODE="0666""#;
        assert!(check.message.contains(rule), "{check:?}");
        assert!(check.message.contains("/dev/bus/usb/002/001"));
    }

    #[test]
    fn the_raw_node_of_a_touch_hid_counts_not_its_bus() {
        let tree = Tree::new();
        tree.raw("1-3", 0x2988, 0x0304, 2, 0o666);
        assert!(of(&tree)[0].ok);
        tree.mode("dev/hidraw2", 0o600);
        assert!(of(&tree)[0].message.contains("/dev/hidraw2"));
    }

    #[test]
    fn a_3d_mouse_needs_no_right_with_spacenavd() {
        let tree = Tree::new();
        tree.raw("1-3", 0x046d, 0xc62b, 2, 0o600);
        let check = &of(&tree)[0];
        assert!(
            !check.ok && check.message.contains(r#"ATTRS{idProduct}=="c62b""#),
            "{check:?}"
        );
        tree.file("spnav.sock", "");
        assert!(of(&tree)[0].ok);
    }

    #[test]
    fn a_missing_node_is_told_apart_from_a_missing_right() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o666);
        std::fs::remove_file(tree.path("dev/ttyACM0")).expect("removed");
        assert!(of(&tree)[0].message.contains("is missing"));
        std::fs::remove_dir(tree.path("usb/1-2:1.0/tty/ttyACM0")).expect("removed");
        let check = &of(&tree)[0];
        assert!(
            !check.ok && check.message.contains("no device node /dev/ttyACM*"),
            "{check:?}"
        );
    }

    #[test]
    fn no_device_needs_no_permission() {
        assert!(of(&Tree::new())[0].ok);
    }
}
