//! Lists, and devices that do not open.

use sulcus_standins::Fault;
use sulcus_standins::setup::{DeviceSetup, Setup};

use crate::dhd;
use crate::hd::{NAME, one, two};
use crate::session::{Options, Session};

fn of_library(name: &str) -> Options {
    Options {
        library: Some(name.into()),
        ..Options::default()
    }
}

#[test]
fn the_list_names_the_devices_and_opens_none() {
    let mut session = Session::new(NAME, two());
    let items = session.list();
    assert_eq!(items.len(), 2);
    let serials: Vec<_> = items.iter().map(|item| item.serial.as_str()).collect();
    assert_eq!(serials, ["L1", "R1"]);
    assert!(
        items
            .iter()
            .all(|item| item.state == "Ready" && item.dof == [6, 3]),
        "{items:?}"
    );
    assert!(items[0].message.contains("Left Device"), "{items:?}");
    let log = session.rig.log().expect("a log");
    assert!(
        log.device(0).chain(log.device(1)).next().is_none(),
        "{:?}",
        log.entries
    );
}

#[test]
fn without_files_the_default_device_opens() {
    let options = Options {
        has_no_files: true,
        ..Options::default()
    };
    let mut session = Session::with(NAME, one(), &options);
    let items = session.list();
    assert_eq!((items.len(), items[0].serial.as_str()), (1, "default"));
    session.live(&["default"]);
    session.stop().expect("an orderly end");
    let opened = session.open(&["L1"]).expect("by serial number");
    assert_eq!(opened[0].serial, "L1");
}

#[test]
fn a_library_that_is_unusable_is_named() {
    for (backend, variable) in [
        (NAME, "SULCUS_HD_LIBRARY"),
        (dhd::NAME, "SULCUS_DHD_LIBRARY"),
    ] {
        let mut session = Session::with(backend, one(), &of_library("/no/such/library.so"));
        let items = session.list();
        assert_eq!(items[0].state, "NoLibrary", "{items:?}");
        assert!(
            items[0].message.contains("/no/such/library.so"),
            "{items:?}"
        );
        assert!(items[0].message.contains(variable), "{items:?}");
        assert_eq!(session.open(&["L1"]), Err(items[0].message.clone()));
        drop(session);
        let mut session = Session::with(backend, one(), &of_library("standin_empty"));
        let items = session.list();
        assert_eq!(items[0].state, "WrongVersion", "{items:?}");
        assert!(items[0].message.contains("has no function"), "{items:?}");
        assert_eq!(session.open(&["L1"]), Err(items[0].message.clone()));
    }
    let mut session = Session::with(NAME, one(), &of_library("standin_hd_missing"));
    let items = session.list();
    assert_eq!(items[0].state, "WrongVersion");
    assert!(items[0].message.contains("hdGetDoublev"), "{items:?}");
    assert!(session.open(&["L1"]).is_err());
}

#[test]
fn an_old_version_is_told() {
    let mut setup = one();
    setup.driver.hd_version = "2.0.4".into();
    let mut session = Session::new(NAME, setup);
    let error = session.open(&["L1"]).expect_err("too old");
    assert!(error.contains("2.0.4") && error.contains("3.0"), "{error}");
    drop(session);
    let mut setup = Setup::new(vec![DeviceSetup::omega6(17)]);
    setup.driver.dhd_version = [2, 9, 1, 0];
    let mut session = Session::new(dhd::NAME, setup);
    let items = session.list();
    assert_eq!(items[0].state, "WrongVersion");
    assert!(items[0].message.contains("2.9.1.0"), "{items:?}");
    assert!(session.open(&["17"]).is_err());
}

#[test]
fn a_refused_device_names_cause_and_remedy() {
    let mut session = Session::new(NAME, two());
    let error = session.open(&["L9"]).expect_err("unknown");
    assert!(
        error.contains("L9") && error.contains("Left Device"),
        "{error}"
    );
    for (code, text) in [
        (0x600, "OpenHaptics 3.4"),
        (0x302, "cable"),
        (0x300, "setup program"),
        (0x303, "plug it in again"),
    ] {
        session
            .rig
            .fault(0, Fault::OpenError(code))
            .expect("a fault");
        let error = session.open(&["R1", "L1"]).expect_err("refused");
        assert!(
            error.contains(text) && error.contains("Left Device"),
            "{error}"
        );
    }
    session.rig.fault(0, Fault::OpenError(0)).expect("a fault");
    // The right device was closed again after each refusal.
    session.live(&["R1", "L1"]);
    session.stop().expect("an orderly end");
}
