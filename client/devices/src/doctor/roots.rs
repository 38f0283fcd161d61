//! Places of the system that the checks look at.

use std::ffi::OsString;
use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs};
use std::path::{Path, PathBuf};

use crate::haply::Haply;

/// Port of the Haply service without a setting.
const PORT: u16 = 10001;

/// Right to a file or a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Right {
    /// The user may read the file.
    Read,
    /// The user may read and write the file.
    ReadWrite,
}

/// Places of the system. Tests use a made-up tree in a temporary folder.
#[derive(Clone, Debug)]
pub struct Roots {
    /// USB devices of the kernel: `/sys/bus/usb/devices`.
    pub usb: PathBuf,
    /// Device nodes: `/dev`.
    pub dev: PathBuf,
    /// Limits of this process: `/proc/self/limits`.
    pub limits: PathBuf,
    /// Folders in which the libraries of OpenHaptics may be.
    pub libraries: Vec<PathBuf>,
    /// Folders of the configurations of the Touch, in the order of their use.
    pub configs: Vec<PathBuf>,
    /// Socket of spacenavd, the daemon of 3D mice.
    pub spacenavd: PathBuf,
    /// Address of the Haply service.
    pub haply: SocketAddr,
    /// Folder that an installed Haply service has: `/etc/haply-inverse-service`.
    pub haply_config: PathBuf,
    /// Whether this user has the right to a file.
    pub allowed: fn(&Path, Right) -> bool,
    /// Opens a shared library by its name and keeps it open. The error is the reason.
    pub opens: fn(&str) -> Result<(), String>,
}

impl Roots {
    /// Places of this computer. The environment variables of the back-ends and of the vendors count: `SULCUS_HAPLY`,
    /// `SULCUS_HD_LIBRARY`, `OH_SDK_BASE`, `LD_LIBRARY_PATH`, `GTDD_HOME`, `HOME`, `SPNAV_SOCKET`.
    pub fn system() -> Self {
        let mut configs = Vec::new();
        if let Some(home) = variable("GTDD_HOME") {
            configs.push(PathBuf::from(home).join("config"));
        }
        configs.push("/usr/share/3DSystems/config".into());
        if let Some(home) = variable("HOME") {
            configs.push(PathBuf::from(home).join(".3dsystems/config"));
        }
        Self {
            usb: "/sys/bus/usb/devices".into(),
            dev: "/dev".into(),
            limits: "/proc/self/limits".into(),
            libraries: libraries(),
            configs,
            spacenavd: variable("SPNAV_SOCKET")
                .map_or_else(|| "/var/run/spnav.sock".into(), PathBuf::from),
            haply: service(Haply::default().address()),
            haply_config: "/etc/haply-inverse-service".into(),
            allowed,
            opens,
        }
    }
}

/// Value of an environment variable that is set and not empty.
fn variable(name: &str) -> Option<OsString> {
    std::env::var_os(name).filter(|value| !value.is_empty())
}

/// Folders in which the library of OpenHaptics is searched.
fn libraries() -> Vec<PathBuf> {
    let mut folders = Vec::new();
    if let Some(file) = variable("SULCUS_HD_LIBRARY") {
        folders.extend(Path::new(&file).parent().map(Path::to_owned));
    }
    if let Some(kit) = variable("OH_SDK_BASE") {
        folders.extend(["lib64", "lib", "usr/lib"].map(|below| Path::new(&kit).join(below)));
    }
    if let Some(value) = variable("LD_LIBRARY_PATH") {
        folders.extend(std::env::split_paths(&value));
    }
    folders.extend(
        [
            "/usr/lib",
            "/usr/lib64",
            "/usr/lib/x86_64-linux-gnu",
            "/usr/local/lib",
            "/opt/OpenHaptics/Developer/3.4-0/lib64",
            "/opt/OpenHaptics/Developer/3.4-0/usr/lib",
        ]
        .map(PathBuf::from),
    );
    folders
}

/// Address of the Haply service in the text of its back-end. The check of the library tells of a text that is wrong.
fn service(text: &str) -> SocketAddr {
    let bare = ["ws://", "http://"]
        .iter()
        .find_map(|scheme| text.trim().strip_prefix(scheme))
        .unwrap_or(text.trim())
        .trim_end_matches('/');
    let addresses = match bare.rsplit_once(':') {
        Some(_) => bare.to_socket_addrs(),
        None => (bare, PORT).to_socket_addrs(),
    };
    addresses
        .ok()
        .and_then(|mut addresses| addresses.next())
        .unwrap_or(SocketAddr::from((Ipv4Addr::LOCALHOST, PORT)))
}

/// Asks the system, which also knows access control lists. The right of a folder to be entered is not looked at.
#[cfg(unix)]
fn allowed(path: &Path, right: Right) -> bool {
    use rustix::fs::Access;
    let access = match right {
        Right::Read => Access::READ_OK,
        Right::ReadWrite => Access::READ_OK | Access::WRITE_OK,
    };
    rustix::fs::access(path, access).is_ok()
}

#[cfg(not(unix))]
fn allowed(path: &Path, _: Right) -> bool {
    path.exists()
}

/// Opens a library as the libraries of a vendor open it: by name, in the folders of the system.
fn opens(name: &str) -> Result<(), String> {
    // SAFETY: the code that runs at the load of this library also runs when a back-end opens the vendor's library.
    match unsafe { libloading::Library::new(name) } {
        Ok(library) => {
            // A driver that was closed fails at its second load in the same process.
            std::mem::forget(library);
            Ok(())
        }
        // The reason of the loader is the source of the error; the error itself says that a call failed.
        Err(error) => Err(std::error::Error::source(&error)
            .map_or_else(|| error.to_string(), |reason| reason.to_string())),
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    /// The right of a person who is not root: a thread of its own gives up its rights and ends.
    fn allowed_to_nobody(path: PathBuf, right: Right) -> bool {
        std::thread::spawn(move || {
            if rustix::process::geteuid().is_root() {
                // SAFETY: the bare system call changes the identity of this thread alone, and all are plain numbers.
                let result = unsafe { libc::syscall(libc::SYS_setresuid, 65534, 65534, 65534) };
                assert_eq!(result, 0, "root may change its identity");
            }
            allowed(&path, right)
        })
        .join()
        .expect("no panic")
    }

    #[test]
    fn the_system_answers_for_a_person_without_rights() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("node");
        std::fs::write(&file, "").expect("written");
        let set = |path: &Path, mode| {
            std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode))
                .expect("own file");
        };
        set(folder.path(), 0o755);
        for (mode, read, write) in [
            (0o000, false, false),
            (0o444, true, false),
            (0o666, true, true),
        ] {
            set(&file, mode);
            assert_eq!(
                allowed_to_nobody(file.clone(), Right::Read),
                read,
                "{mode:o}"
            );
            assert_eq!(
                allowed_to_nobody(file.clone(), Right::ReadWrite),
                write,
                "{mode:o}"
            );
        }
    }

    #[test]
    fn a_library_that_does_not_exist_gives_the_reason() {
        let reason = opens("libsulcus-no-such-library.so.5").expect_err("no such library");
        assert!(
            reason.contains("libsulcus-no-such-library.so.5"),
            "{reason}"
        );
        assert!(!Roots::system().configs.is_empty());
    }

    #[test]
    fn the_address_of_the_service_is_read_in_each_form() {
        let plain = SocketAddr::from((Ipv4Addr::LOCALHOST, PORT));
        for text in [
            "127.0.0.1",
            "ws://127.0.0.1:10001/",
            " http://127.0.0.1 ",
            "no address:x",
            "",
        ] {
            assert_eq!(service(text), plain, "{text}");
        }
        assert_eq!(service("127.0.0.1:12").port(), 12);
    }
}
