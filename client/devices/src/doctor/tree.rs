//! Made-up tree of a system in a temporary folder, for tests.

use std::net::{Ipv4Addr, SocketAddr};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use super::check::{Check, LONGEST};
use super::roots::{Right, Roots};

/// Made-up tree. Permissions count for a person who is neither the owner nor in the group of a file.
pub struct Tree(tempfile::TempDir);

impl Tree {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn folder(&self, name: &str) {
        std::fs::create_dir_all(self.path(name)).expect("made");
    }

    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("in the tree")).expect("made");
        std::fs::write(path, bytes).expect("written");
    }

    pub fn mode(&self, name: &str, mode: u32) {
        std::fs::set_permissions(self.path(name), std::fs::Permissions::from_mode(mode))
            .expect("own file");
    }

    /// Device with a node on its bus; bus and number are those of the place.
    pub fn bus(&self, place: &str, vendor: u16, product: u16, mode: u32) {
        let (bus, number) = place.split_once('-').expect("a place");
        let number = number.split('.').next_back().expect("a number");
        for (file, text) in [
            ("idVendor", format!("{vendor:04x}\n")),
            ("idProduct", format!("{product:04x}\n")),
            ("busnum", format!("{bus}\n")),
            ("devnum", format!("{number}\n")),
        ] {
            self.file(&format!("usb/{place}/{file}"), text);
        }
        let node = format!("dev/bus/usb/{bus:0>3}/{number:0>3}");
        self.file(&node, "");
        self.mode(&node, mode);
    }

    /// Touch with a serial line.
    pub fn touch(&self, place: &str, channel: u32, mode: u32) {
        self.bus(place, 0x2988, 0x0302, 0o664);
        self.folder(&format!("usb/{place}:1.0/tty/ttyACM{channel}"));
        self.file(&format!("dev/ttyACM{channel}"), "");
        self.mode(&format!("dev/ttyACM{channel}"), mode);
    }

    /// Device with a raw node.
    pub fn raw(&self, place: &str, vendor: u16, product: u16, number: u32, mode: u32) {
        self.bus(place, vendor, product, 0o664);
        self.folder(&format!("usb/{place}:1.0/0003:0001/hidraw/hidraw{number}"));
        self.file(&format!("dev/hidraw{number}"), "");
        self.mode(&format!("dev/hidraw{number}"), mode);
    }

    /// Configuration of a Touch with a serial line.
    pub fn config(&self, name: &str, channel: u32) {
        let text =
            format!("ModelType=OMNI\nCardType=USB\nChannel={channel}\nNominalMaxForce=3.300000\n");
        self.file(&format!("home/.3dsystems/config/{name}.config"), text);
    }

    pub fn roots(&self) -> Roots {
        Roots {
            usb: self.path("usb"),
            dev: self.path("dev"),
            limits: self.path("limits"),
            libraries: vec![self.path("lib")],
            configs: vec![
                self.path("share/config"),
                self.path("home/.3dsystems/config"),
            ],
            spacenavd: self.path("spnav.sock"),
            haply: SocketAddr::from((Ipv4Addr::LOCALHOST, 9)),
            haply_config: self.path("haply"),
            allowed: |path: &Path, right| {
                let bits = match right {
                    Right::Read => 0o004,
                    Right::ReadWrite => 0o006,
                };
                std::fs::metadata(path).is_ok_and(|data| data.permissions().mode() & bits == bits)
            },
            opens: |_| Ok(()),
        }
    }
}

/// Asserts what holds for every list: short messages, none of them empty or cut. Long paths of a temporary folder may
/// be cut.
pub fn sound(checks: &[Check]) {
    for check in checks {
        assert!(check.message.chars().count() <= LONGEST, "{check:?}");
        assert!(!check.message.is_empty() && !check.name.is_empty());
        assert!(
            !check.message.contains("...") || std::env::temp_dir().as_os_str().len() > 16,
            "a message lost its middle: {check:?}"
        );
    }
}
