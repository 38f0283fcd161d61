//! Files with which a school installs the server: the service for systemd, the composition, the image.

use std::path::{Path, PathBuf};
use std::process::Command;

use sulcus_support::Resource;
use sulcus_tests::{Place, Program};

fn docker(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../docker")).join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(docker(name)).expect(name)
}

/// `systemd-analyze` exits with 0 on unknown keys, and says so. A silent check alone is a right file.
#[test]
fn the_service_is_silent_in_the_check_of_systemd() {
    let found = Command::new("systemd-analyze").arg("--version").output();
    let found = found.map_err(|error| error.to_string());
    if Resource::Systemd.or_skip(found).is_none() {
        return;
    }
    let place = Place::new();
    let unit = text("sulcus-server.service");
    let program = Program::Server.path().display().to_string();
    let checked = |unit: &str| {
        let path = place.path("sulcus-server.service");
        std::fs::write(&path, unit).expect("writes");
        let output = Command::new("systemd-analyze")
            .arg("verify")
            .arg(&path)
            .output();
        let output = output.expect("systemd-analyze starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.success(), said)
    };
    let here = unit.replace("/usr/bin/sulcus-server", &program);
    // The manual lies there after an installation.
    let here = here.replace("Documentation=", "#");
    assert_eq!(checked(&here), (true, String::new()));
    let (_, said) = checked(&here.replace("NoNewPrivileges", "NoNewPrivilege"));
    assert!(
        said.contains("NoNewPrivilege"),
        "the check finds a wrong key: {said}"
    );
}

/// Each way of installation ends the server by SIGTERM, gives it more than the 32 s that an end may take, and keeps both
/// folders.
#[test]
fn every_way_of_installation_ends_in_order_and_keeps_state_and_recordings() {
    for (name, words) in [
        (
            "sulcus-server.service",
            &[
                "KillSignal=SIGTERM",
                "TimeoutStopSec=60",
                "StateDirectory=sulcus\n",
                // A ticket on standard output must not reach the journal.
                "StandardOutput=null\n",
            ][..],
        ),
        (
            "compose.yaml",
            &[
                "stop_signal: SIGTERM",
                "stop_grace_period: 60s",
                "recordings:/recordings",
                "state:/var/lib/sulcus",
            ],
        ),
        (
            "build-image",
            &[
                "--stop-signal SIGTERM",
                "--volume /recordings",
                "--volume /var/lib/sulcus",
            ],
        ),
        (
            "Dockerfile.server",
            &[
                "STOPSIGNAL SIGTERM",
                "VOLUME [\"/recordings\", \"/var/lib/sulcus\"]",
            ],
        ),
    ] {
        let text = text(name);
        for word in words {
            assert!(text.contains(word), "{name}: {word}");
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    let image = format!("image: localhost/sulcus-server:{version}\n");
    assert!(text("compose.yaml").contains(&image), "expected {image}");
}

#[test]
fn the_builder_of_the_image_names_what_is_missing() {
    // A machine with a shell and neither of the builders.
    let place = Place::new();
    for program in ["bash", "dirname", "id"] {
        let found = ["/usr/bin", "/bin"].map(|folder| Path::new(folder).join(program));
        let found = found.iter().find(|path| path.is_file()).expect(program);
        std::os::unix::fs::symlink(found, place.path(program)).expect("a link");
    }
    let bare = Command::new(docker("build-image"))
        .env("PATH", place.path(""))
        .output()
        .expect("bash");
    let said = String::from_utf8_lossy(&bare.stderr).into_owned();
    assert_eq!(bare.status.code(), Some(2), "{said}");
    let is_named = said.contains("mmdebstrap buildah") || said.contains("expected root");
    assert!(is_named, "{said}");
    let wrong = Command::new(docker("build-image"))
        .arg("--colour")
        .output()
        .expect("bash");
    let said = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert_eq!(wrong.status.code(), Some(2), "{said}");
    assert!(said.contains("argument is --colour"), "{said}");
    let help = Command::new(docker("build-image"))
        .arg("--help")
        .output()
        .expect("bash");
    assert!(help.status.success() && String::from_utf8_lossy(&help.stdout).contains("--out DIR"));
}

/// A release of another version than the workspace's, or without a version, changes nothing.
#[test]
fn a_release_needs_the_version_of_the_workspace() {
    let release = |arguments: &[&str]| {
        let ended = Command::new(docker("release")).args(arguments).output();
        let ended = ended.expect("bash");
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        (ended.status.code(), said)
    };
    let version = env!("CARGO_PKG_VERSION");
    for (arguments, why) in [
        (&[][..], "version is missing".to_owned()),
        (
            &["9.9.9"],
            format!("version of the workspace is {version}, expected 9.9.9"),
        ),
        (&[version, "9.9.9"], "version is given twice".into()),
        (&["--colour"], "argument is --colour".into()),
    ] {
        let (code, said) = release(arguments);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(&why), "{said}");
    }
    // The section of the next release is there, with the version in its heading.
    let log = std::fs::read_to_string(docker("../CHANGELOG.md")).expect("the changelog");
    let heading = format!("({version})\n");
    let is_there = log.contains(&format!("## Unreleased {heading}"))
        || log.contains(&format!("## {version},"));
    assert!(is_there, "a section of {version}");
}
