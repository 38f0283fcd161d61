//! List and opening: one sentence for each obstacle, and no force.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use sulcus_devices::haply::Haply;
use sulcus_devices::{Backend, Found, State};
use sulcus_standin_haply::{ArmStatus, Fault, Omission, Omit, Options, Replies, Service};

use crate::rig::{alone, backend, names, service};

fn only(service: &Service) -> Found {
    let begin = Instant::now();
    let mut found = backend(service).list();
    assert!(
        begin.elapsed() < Duration::from_millis(2500),
        "{:?}",
        begin.elapsed()
    );
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

fn refusal(service: &Service, arms: &[&str]) -> String {
    let error = backend(service)
        .open(&names(arms))
        .err()
        .expect("a refusal");
    assert!(!error.0.contains('\n') && error.0.contains(':'), "{error}");
    error.0
}

#[test]
fn the_list_tells_the_arms_and_moves_none() {
    let _alone = alone();
    let service = service(&Options::pair());
    let found = backend(&service).list();
    assert_eq!(found.len(), 2);
    let [right, left] = [&found[0], &found[1]];
    assert_eq!(
        (right.serial.as_str(), right.hand.as_str()),
        ("049D", "right")
    );
    assert_eq!((left.serial.as_str(), left.hand.as_str()), ("04A1", "left"));
    assert_eq!(
        (right.motion_dof, right.force_dof, right.state),
        (6, 3, State::Ready)
    );
    assert_eq!((right.library, right.model.as_str()), ("haply", "inverse3"));
    assert!(left.message.contains("61577"), "{}", left.message);
    let log = service.stop().unwrap();
    assert_eq!((log.messages(), log.violations().len()), (0, 0));
}

#[test]
fn no_service_and_a_wrong_address_are_sentences() {
    let _alone = alone();
    let gone = service(&Options::default());
    let address = format!("127.0.0.1:{}", gone.port());
    gone.stop().unwrap();
    let found = Haply::at(&address).list();
    assert_eq!(found[0].state, State::NoLibrary);
    assert!(
        found[0]
            .message
            .contains("install and start the Haply software"),
        "{}",
        found[0].message
    );
    let found = Haply::at("nonsense:port").list();
    assert_eq!(found[0].state, State::Error);
    assert!(
        found[0].message.contains("expected host and port"),
        "{}",
        found[0].message
    );
    let error = Haply::at(&address).open(&[]).err().unwrap();
    assert!(error.0.contains("no arm is named"), "{error}");
}

#[test]
fn states_of_an_arm_have_their_sentence() {
    let _alone = alone();
    let status = ArmStatus::default();
    let cases = [
        (
            ArmStatus {
                in_use: true,
                ..status
            },
            State::InUse,
            "another program",
        ),
        (
            ArmStatus {
                power_supply: false,
                ..status
            },
            State::Asleep,
            "power supply",
        ),
        (
            ArmStatus {
                calibrated: false,
                ..status
            },
            State::Uncalibrated,
            "calibrate",
        ),
    ];
    for (status, state, part) in cases {
        let mut options = Options::default();
        options.arms[0].status = status;
        let service = service(&options);
        let found = only(&service);
        assert_eq!(found.state, state);
        assert!(found.message.contains(part), "{}", found.message);
        if state == State::InUse {
            assert!(refusal(&service, &["049D"]).contains(part));
        }
    }
    let mut options = Options::default();
    options.grips[0].awake = false;
    assert_eq!(only(&service(&options)).state, State::Asleep);
    options.arms.clear();
    let none = service(&options);
    let found = only(&none);
    assert_eq!(found.state, State::NoDevice);
    assert!(refusal(&none, &["049D"]).contains("no arm 049D, found none"));
}

#[test]
fn factors_axes_and_unclear_grips_are_refused() {
    let _alone = alone();
    for bare_settings in [false, true] {
        let scaled = service(&Options {
            force_scale: 2.0,
            bare_settings,
            ..Options::default()
        });
        assert_eq!(only(&scaled).state, State::Error);
        assert!(
            refusal(&scaled, &["049D"])
                .contains("force_scale of the Haply service is 2, expected 1")
        );
    }
    for (name, value, part) in [
        (
            "torque_scaling",
            r#"{"enabled":true,"scaling_factor":0.5}"#,
            "torque_scaling of 049D is 0.5",
        ),
        ("basis", r#"{"permutation":"XZY"}"#, "basis of 049D is XZY"),
    ] {
        let changed = service(&Options::default());
        post(&changed, &format!("/inverse3/049D/config/{name}"), value);
        assert!(refusal(&changed, &["049D"]).contains(part));
        assert_eq!(only(&changed).state, State::Error);
    }
    let mut options = Options::pair();
    options.grips.truncate(1);
    let one_grip = service(&options);
    assert!(refusal(&one_grip, &["049D"]).contains("is not clear, found the grips 61576"));
    assert!(refusal(&one_grip, &["049D+7"]).contains("no grip 7, found 61576"));
    let infos = |arms: &[&str]| {
        backend(&one_grip)
            .open(&names(arms))
            .unwrap()
            .info()
            .to_vec()
    };
    let axes: Vec<_> = infos(&["04A1+61576", "049D"])
        .iter()
        .map(|info| info.motion_dof)
        .collect();
    assert_eq!(axes, [6, 3]);
    assert_eq!(infos(&["049D+none"])[0].serial, "049D");
}

#[test]
fn faults_of_the_service_at_the_beginning() {
    let _alone = alone();
    let service = service(&Options::default());
    let ready = |fault: Fault| {
        service.fault(fault).unwrap();
        assert_eq!(only(&service).state, State::Ready);
    };
    ready(Fault::HttpError { requests: 2 });
    ready(Fault::Malformed { replies: 1 });
    ready(Fault::Truncated { replies: 2 });
    service.fault(Fault::HttpError { requests: 9 }).unwrap();
    let found = only(&service);
    assert_eq!(found.state, State::Error);
    assert!(
        found.message.contains("HTTP status 500"),
        "{}",
        found.message
    );
    service.fault(Fault::HttpError { requests: 0 }).unwrap();
    service.fault(Fault::Malformed { replies: 9 }).unwrap();
    let found = only(&service);
    assert_eq!(found.state, State::Error);
    assert!(
        found.message.contains("no list of its devices"),
        "{}",
        found.message
    );
    service.fault(Fault::Malformed { replies: 0 }).unwrap();
    service.fault(Fault::Silence { messages: 9 }).unwrap();
    assert!(refusal(&service, &["049D"]).contains("gives no replies"));
    service.fault(Fault::Silence { messages: 0 }).unwrap();
    service.fault(Fault::Stall { ms: 2500 }).unwrap();
    let found = only(&service);
    assert_eq!(found.state, State::Error);
    assert!(found.message.contains("in time"), "{}", found.message);
}

#[test]
fn an_inventory_without_a_part_still_opens() {
    let _alone = alone();
    for what in [
        Omit::Config,
        Omit::Status,
        Omit::State,
        Omit::Field("handedness".into()),
    ] {
        let service = service(&Options {
            replies: Replies {
                omissions: vec![Omission {
                    what: what.clone(),
                    first: 0,
                    last: 0,
                }],
                ..Replies::default()
            },
            ..Options::default()
        });
        assert_eq!(only(&service).state, State::Ready, "{what:?}");
        let device = backend(&service).open(&names(&["049D"])).unwrap();
        assert_eq!(device.info()[0].model, "inverse3", "{what:?}");
    }
}

fn post(service: &Service, path: &str, body: &str) {
    let mut stream = TcpStream::connect(("127.0.0.1", service.port())).unwrap();
    let length = body.len();
    write!(
        stream,
        "POST {path} HTTP/1.1\r\nHost: x\r\nContent-Length: {length}\r\n\r\n{body}"
    )
    .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
}
