//! Field of a force for each version.

use sulcus_core::Vec3;
use sulcus_devices::{Backend, State};
use sulcus_standin_haply::{Options, Version, Violation};

use crate::capture::warnings;
use crate::rig::{Rig, alone, backend, names, service};

#[test]
fn each_version_gets_its_field() {
    for (minor, field) in [(1, "values"), (4, "values"), (5, "vector"), (9, "vector")] {
        let options = Options {
            version: Version::new(3, minor, 0),
            ..Options::default()
        };
        let mut rig = Rig::start(
            &options,
            &["049D"],
            Box::new(|_, _| Vec3::new(0.0, 0.5, 0.0)),
        );
        rig.wait_live();
        rig.sleep(200);
        assert_eq!(rig.end(), Ok(()));
        let log = rig.service.log().unwrap();
        assert_eq!(log.count(Violation::WrongField), 0, "3.{minor}");
        let forces = log.forces("049D");
        assert!(
            forces
                .iter()
                .all(|sent| sent.done && sent.field.as_deref() == Some(field)),
            "3.{minor}"
        );
        assert!(log.largest_displayed("049D") > 0.49, "3.{minor}");
        assert_eq!(log.violations(), [], "3.{minor}");
    }
}

#[test]
fn a_later_version_is_tried_with_one_remark() {
    let options = Options {
        version: Version::new(4, 0, 0),
        ..Options::default()
    };
    let mut rig = Rig::start(
        &options,
        &["049D"],
        Box::new(|_, _| Vec3::new(0.0, 0.5, 0.0)),
    );
    rig.wait_live();
    assert_eq!(rig.end(), Ok(()));
    let remarks = warnings();
    assert_eq!(remarks.len(), 1, "{remarks:?}");
    assert!(remarks[0].contains("has version 4.0"), "{remarks:?}");
    assert_eq!(rig.service.log().unwrap().count(Violation::WrongField), 0);
}

#[test]
fn an_older_version_is_refused() {
    let _alone = alone();
    for version in [Version::new(3, 0, 2), Version::new(2, 1, 0)] {
        let service = service(&Options {
            version,
            ..Options::default()
        });
        let found = backend(&service).list();
        assert_eq!((found.len(), found[0].state), (1, State::WrongVersion));
        assert!(
            found[0].message.contains("expected 3.1 or later"),
            "{}",
            found[0].message
        );
        let error = backend(&service).open(&names(&["049D"])).err().unwrap();
        assert_eq!(error.0, found[0].message);
        assert_eq!(service.log().unwrap().connections(), 0);
    }
}
