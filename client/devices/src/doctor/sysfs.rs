//! USB devices as the kernel of Linux lists them in files.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::kind::{Kind, Node, kind};

/// Most bytes of a file of `/sys`.
const LONGEST: u64 = 64;

/// Known device that is plugged in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsbDevice {
    /// Place on the bus, such as `1-2.4`.
    pub place: String,
    /// Number of the vendor.
    pub vendor: u16,
    /// Number of the product.
    pub product: u16,
    /// Kind.
    pub kind: Kind,
    /// Path of the device on its bus below `/dev`, if its numbers can be read.
    bus: Option<String>,
    /// Names of the serial lines, such as `ttyACM0`.
    serial: Vec<String>,
    /// Names of the raw devices, such as `hidraw3`.
    raw: Vec<String>,
}

impl UsbDevice {
    /// Label with the numbers, for messages.
    pub fn label(&self) -> String {
        format!(
            "{} ({:04x}:{:04x})",
            self.kind.label, self.vendor, self.product
        )
    }

    /// Paths of the device nodes below `dev` that a library needs; empty if the kernel made none.
    pub fn nodes(&self, dev: &Path) -> Vec<PathBuf> {
        let names: Vec<&String> = match self.kind.node {
            Node::Serial => self.serial.iter().collect(),
            Node::HidRaw => self.raw.iter().collect(),
            Node::Bus => self.bus.iter().collect(),
            Node::Any if self.serial.is_empty() && self.raw.is_empty() => self.bus.iter().collect(),
            Node::Any => self.serial.iter().chain(&self.raw).collect(),
        };
        names.into_iter().map(|name| dev.join(name)).collect()
    }

    /// Numbers of the serial lines: 0 for `ttyACM0`.
    pub fn channels(&self) -> Vec<u32> {
        self.serial
            .iter()
            .filter_map(|name| name.strip_prefix("ttyACM")?.parse().ok())
            .collect()
    }
}

/// Known devices below the folder `usb`, in the order of their places. A missing folder has none.
pub fn known(usb: &Path) -> Vec<UsbDevice> {
    let entries = names(usb);
    entries
        .iter()
        .filter(|name| is_place(name))
        .filter_map(|place| device(usb, place, &entries))
        .collect()
}

fn device(usb: &Path, place: &str, entries: &[String]) -> Option<UsbDevice> {
    let folder = usb.join(place);
    let vendor = hexadecimal(&text(&folder.join("idVendor"))?)?;
    let product = hexadecimal(&text(&folder.join("idProduct"))?)?;
    let kind = kind(vendor, product)?;
    let number = |name| text(&folder.join(name))?.trim().parse::<u16>().ok();
    let bus = number("busnum")
        .zip(number("devnum"))
        .map(|(bus, device)| format!("bus/usb/{bus:03}/{device:03}"));
    let (mut serial, mut raw) = (Vec::new(), Vec::new());
    let parts = entries.iter().filter(|name| {
        name.strip_prefix(place)
            .is_some_and(|rest| rest.starts_with(':'))
    });
    for part in parts.map(|name| usb.join(name)) {
        serial.extend(
            names(&part.join("tty"))
                .into_iter()
                .filter(|name| is_node(name, "ttyACM")),
        );
        for inner in names(&part) {
            let inner = names(&part.join(inner).join("hidraw"));
            raw.extend(inner.into_iter().filter(|name| is_node(name, "hidraw")));
        }
    }
    Some(UsbDevice {
        place: place.to_owned(),
        vendor,
        product,
        kind,
        bus,
        serial,
        raw,
    })
}

/// Whether the name is a place on a bus: digits, `-`, and digits with dots. Names with `:` are parts of a device.
fn is_place(name: &str) -> bool {
    name.len() <= 32
        && name.split_once('-').is_some_and(|(bus, port)| {
            let digits =
                |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
            digits(bus) && port.split('.').all(digits)
        })
}

/// Whether the name is `prefix` and a number.
fn is_node(name: &str, prefix: &str) -> bool {
    name.strip_prefix(prefix).is_some_and(|rest| {
        (1..=5).contains(&rest.len()) && rest.bytes().all(|byte| byte.is_ascii_digit())
    })
}

/// Number of four hexadecimal digits, with white space around them.
fn hexadecimal(text: &str) -> Option<u16> {
    let digits = text.trim();
    let valid = digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    valid
        .then(|| u16::from_str_radix(digits, 16).ok())
        .flatten()
}

/// Start of a text file; `None` for a file that cannot be read.
fn text(path: &Path) -> Option<String> {
    let mut bytes = Vec::new();
    File::open(path)
        .ok()?
        .take(LONGEST)
        .read_to_end(&mut bytes)
        .ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

/// Names in a folder, sorted; empty for a folder that cannot be read. Names that are no text are left out.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    names
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use proptest::prelude::*;

    use super::super::tree::Tree;
    use super::*;

    #[test]
    fn nodes_of_each_kind_are_found() {
        let tree = Tree::new();
        tree.touch("1-2", 3, 0o666);
        tree.raw("1-3.4", 0x2988, 0x0304, 7, 0o666);
        tree.bus("2-1", 0x0403, 0xcb48, 0o666);
        let dev = tree.path("dev");
        let found: Vec<_> = known(&tree.roots().usb)
            .into_iter()
            .map(|device| (device.place.clone(), device.nodes(&dev), device.channels()))
            .collect();
        assert_eq!(
            found,
            [
                ("1-2".to_owned(), vec![dev.join("ttyACM3")], vec![3]),
                ("1-3.4".to_owned(), vec![dev.join("hidraw7")], vec![]),
                ("2-1".to_owned(), vec![dev.join("bus/usb/002/001")], vec![]),
            ]
        );
    }

    #[test]
    fn a_device_at_1_2_does_not_get_the_node_of_1_21() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o666);
        tree.touch("1-21", 1, 0o666);
        let channels: Vec<_> = known(&tree.roots().usb)
            .iter()
            .map(UsbDevice::channels)
            .collect();
        assert_eq!(channels, [[0], [1]]);
    }

    #[test]
    fn a_missing_folder_has_no_devices() {
        assert_eq!(known(Path::new("/no/such/folder")), []);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn garbage_in_the_files_of_a_device_is_no_device_or_a_known_one(
            vendor in proptest::collection::vec(any::<u8>(), 0..100),
            product in prop_oneof![Just(b"0302\n".to_vec()), proptest::collection::vec(any::<u8>(), 0..100)],
            number in proptest::collection::vec(any::<u8>(), 0..100),
            name in "[a-z0-9][a-z0-9:-]{0,11}",
            known_vendor in any::<bool>(),
        ) {
            let tree = Tree::new();
            let folder = format!("usb/{name}x/tty/{name}");
            tree.folder(&folder);
            tree.folder("usb/1-2:1.0/tty/ttyACM99999999999");
            tree.folder("usb/1-2:1.0/tty/ttyACM");
            tree.folder(&format!("usb/1-2:1.0/{name}/hidraw/{name}"));
            let vendor = if known_vendor { b"2988".to_vec() } else { vendor };
            let files = [("idVendor", &vendor), ("idProduct", &product), ("busnum", &number), ("devnum", &number)];
            for (file, bytes) in files {
                tree.file(&format!("usb/1-2/{file}"), bytes);
            }
            for device in known(&tree.roots().usb) {
                prop_assert!(kind(device.vendor, device.product).is_some());
                prop_assert!(device.channels().is_empty());
            }
        }

        #[test]
        fn numbers_have_four_digits(text in any::<String>()) {
            if let Some(number) = hexadecimal(&text) {
                prop_assert_eq!(format!("{number:04x}"), text.trim().to_ascii_lowercase());
            }
        }
    }

    #[test]
    fn plus_signs_and_short_numbers_are_no_numbers() {
        for text in ["+298", "298", "29880", "", "0x29"] {
            assert_eq!(hexadecimal(text), None, "{text}");
        }
        assert_eq!(hexadecimal(" CB48\n"), Some(0xcb48));
        for name in ["usb1", "1-2:1.0", "1-", "-1", "1-2.", "a-1", "1-+2"] {
            assert!(!is_place(name), "{name}");
        }
        assert!(is_place("1-2.4.1"));
    }
}
