//! The key file: made once, private, never replaced.

use super::*;

#[test]
fn a_key_is_made_once_and_found_again() {
    let dir = tempfile::tempdir().expect("temporary directory");
    let path = dir.path().join("deep/station.key");
    let made = StationKey::load_or_create(&path).expect("made");
    let found = StationKey::load_or_create(&path).expect("found");
    assert_eq!(made.public(), found.public());
    let public = path.with_extension("pub");
    let read = PublicKey::from_file_or_hex(public.to_str().expect("utf-8")).expect("public");
    assert_eq!(read, made.public());
    assert_eq!(
        PublicKey::from_file_or_hex(made.public().fingerprint()).expect("hex"),
        read
    );
    assert_eq!(
        std::fs::read_dir(path.parent().expect("parent"))
            .expect("list")
            .count(),
        2
    );
}

#[cfg(unix)]
#[test]
fn the_file_is_private_and_must_stay_so() {
    use std::os::unix::fs::PermissionsExt as _;
    let dir = tempfile::tempdir().expect("temporary directory");
    let path = dir.path().join("station.key");
    StationKey::load_or_create(&path).expect("made");
    let mode = std::fs::metadata(&path)
        .expect("there")
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o600);
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o644)).expect("chmod");
    let error = StationKey::load_or_create(&path)
        .expect_err("exposed")
        .to_string();
    assert!(
        error.contains("can be read by others (mode 644)"),
        "{error}"
    );
}

#[test]
fn something_else_is_not_a_key_and_is_not_replaced() {
    let dir = tempfile::tempdir().expect("temporary directory");
    let path = dir.path().join("station.key");
    for content in [
        &b""[..],
        b"hello",
        b"sulcus station key 1\nabc",
        &[255; 100],
    ] {
        std::fs::write(&path, content).expect("written");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).expect("chmod");
        }
        let error = StationKey::load_or_create(&path)
            .expect_err("no key")
            .to_string();
        assert!(error.contains("is not a station key"), "{error}");
        assert_eq!(std::fs::read(&path).expect("there"), content);
    }
}

#[test]
fn debug_does_not_show_the_secret() {
    let key = StationKey::from_seed([7; 32]);
    assert!(!format!("{key:?}").contains(&"07".repeat(32)));
}
