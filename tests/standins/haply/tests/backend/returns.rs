//! Lost connections, and services that are gone for a while.

use sulcus_standin_haply::{Entry, Fault, Version, What};

use crate::capture::warnings;
use crate::faults::{ABSENT, ARM, judge, leads_to, start};

#[test]
fn lost_connections_return() {
    leads_to(Fault::DropConnections, None, ABSENT, 1);
    leads_to(Fault::CloseConnections, None, ABSENT, 1);
}

#[test]
fn a_service_that_is_gone_for_a_while_returns() {
    let mut rig = start();
    rig.service
        .fault(Fault::RefuseConnections { on: true })
        .unwrap();
    rig.service.fault(Fault::DropConnections).unwrap();
    rig.wait("absence", || rig.stage(0) == ABSENT);
    let sequence = rig.seen(0).sample.sequence;
    rig.sleep(1000);
    let periods = rig.seen(0).sample.sequence - sequence;
    assert!(
        (500..1500).contains(&periods),
        "{periods} periods without a service"
    );
    assert_eq!(rig.stage(0), ABSENT);
    rig.service
        .fault(Fault::RefuseConnections { on: false })
        .unwrap();
    rig.wait_live();
    assert_eq!(rig.end(), Ok(()));
    let all = warnings();
    assert_eq!(
        all.iter().filter(|line| line.contains("is lost")).count(),
        1,
        "{all:?}"
    );
    let log = rig.service.log().unwrap();
    assert_eq!(log.connections(), 2);
    judge(&log, &"gone for a while");
    // The first message of each connection has no force.
    for connection in [1, 2] {
        let first = log
            .forces(ARM)
            .into_iter()
            .find(|sent| sent.connection == connection)
            .unwrap();
        assert_eq!(first.force, Some([0.0; 3]));
    }
}

/// A service that comes back with another version gets the field of that version.
#[test]
fn a_service_that_returns_with_another_version_gets_its_field() {
    let mut rig = start();
    rig.service
        .fault(Fault::RefuseConnections { on: true })
        .unwrap();
    rig.service.fault(Fault::DropConnections).unwrap();
    // A message of the old connection that came after the change would lose its force by the service.
    let has_ended = |entry: &Entry| matches!(entry.what, What::Ended { .. });
    rig.wait("end of the connection", || {
        rig.service.log().unwrap().entries.iter().any(has_ended)
    });
    rig.service
        .fault(Fault::Version {
            version: Version::V3_4,
        })
        .unwrap();
    rig.sleep(100);
    rig.service
        .fault(Fault::RefuseConnections { on: false })
        .unwrap();
    rig.wait_live();
    assert_eq!(rig.end(), Ok(()));
    let log = rig.service.log().unwrap();
    let fields = |connection| {
        let forces = log
            .forces(ARM)
            .into_iter()
            .filter(move |sent| sent.connection == connection);
        forces
            .map(|sent| sent.field.unwrap_or_default())
            .collect::<Vec<_>>()
    };
    assert!(fields(1).iter().all(|field| field == "vector"));
    assert!(fields(2).len() > 100 && fields(2).iter().all(|field| field == "values"));
    judge(&log, &"version");
}
