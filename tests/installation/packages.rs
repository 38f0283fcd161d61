//! Packages and archives: built from the same programs they have the same bytes, and hold what a machine needs.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use sulcus_support::Resource;
use sulcus_tests::Program;

/// Folder with the programs: that of `SULCUS_PROGRAMS`, else that of the tests.
fn programs() -> PathBuf {
    // The programs of the tests are built, if they are not.
    std::env::var_os("SULCUS_PROGRAMS")
        .map_or_else(|| Program::Server.path().with_file_name(""), PathBuf::from)
}

/// Builds all packages into a folder of their own.
fn build() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docker/build-packages");
    let built = Command::new(script)
        .args(["--quick", "--programs"])
        .arg(programs())
        .arg("--out")
        .arg(folder.path())
        .output()
        .expect("bash");
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{said}");
    folder
}

/// Packages for all tests of this binary. Tests run in threads of one process, which ends with them.
pub fn packages() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER.get_or_init(build).path()
}

/// Whether this machine can build packages.
fn can() -> Result<(), String> {
    let found = Command::new("dpkg-deb").arg("--version").output();
    found
        .map(|_| ())
        .map_err(|error| format!("dpkg-deb: {error}"))
}

/// Path of the one file of a folder with a beginning and an ending.
pub fn file(folder: &Path, begin: &str, end: &str) -> PathBuf {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten();
    let mut found = entries.map(|entry| entry.path()).filter(|path| {
        let name = path.file_name().map(|name| name.to_string_lossy());
        name.is_some_and(|name| name.starts_with(begin) && name.ends_with(end))
    });
    let one = found.next();
    assert!(found.next().is_none(), "one {begin}…{end}");
    one.unwrap_or_else(|| panic!("{begin}…{end} in {}", folder.display()))
}

fn listed(program: &str, arguments: &[&str], file: &Path) -> String {
    let output = Command::new(program).args(arguments).arg(file).output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{program} {}", file.display());
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn packages_hold_programs_service_rules_and_the_clients_for_download() {
    if Resource::Image.or_skip(can()).is_none() {
        return;
    }
    let folder = packages();
    let server = listed(
        "dpkg-deb",
        &["--contents"],
        &file(folder, "sulcus-server_", ".deb"),
    );
    for path in [
        "./usr/bin/sulcus-server",
        "./usr/bin/sulcus-sessions",
        "./usr/sbin/sulcus-school",
        "./usr/lib/systemd/system/sulcus-server.service",
        "./usr/share/sulcus/clients/SHA256SUMS",
        "./usr/share/sulcus/clients/sulcus-client_",
        "./usr/share/sulcus/clients/sulcus-client-",
        "./usr/share/doc/sulcus-server/copyright",
    ] {
        assert!(server.contains(path), "{path} in {server}");
    }
    let client = listed(
        "dpkg-deb",
        &["--contents"],
        &file(folder, "sulcus-client_", ".deb"),
    );
    for path in [
        "./usr/bin/sulcus-client",
        "./usr/lib/udev/rules.d/70-sulcus-devices.rules",
    ] {
        assert!(client.contains(path), "{path} in {client}");
    }
    // Every file belongs to root: no number of a user of the machine that built the package.
    for line in server.lines().chain(client.lines()) {
        assert!(line.contains(" root/root "), "{line}");
    }
    let facts = listed(
        "dpkg-deb",
        &["--info"],
        &file(folder, "sulcus-client_", ".deb"),
    );
    assert!(facts.contains("Depends: libc6 (>= 2."), "{facts}");
    let archive = listed("tar", &["-tzf"], &file(folder, "sulcus-client-", ".tar.gz"));
    assert!(archive.contains("/sulcus-client\n"), "{archive}");
    let sums = std::fs::read_to_string(folder.join("SHA256SUMS")).expect("sums");
    assert_eq!(sums.lines().count(), 4, "{sums}");
}

#[test]
fn a_second_build_of_the_packages_has_the_same_bytes() {
    if Resource::Image.or_skip(can()).is_none() {
        return;
    }
    let sums = |folder: &Path| std::fs::read_to_string(folder.join("SHA256SUMS")).expect("sums");
    assert_eq!(sums(build().path()), sums(packages()));
}
