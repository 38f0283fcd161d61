//! The check of a machine: every part is said, and a fault is a problem with advice.

use std::net::UdpSocket;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use super::*;
use crate::capacity::{Cost, Load, Machine};
use crate::check::plans::{StationLoad, capacity_on};
use crate::plan::{Plan, PlanChange};
use crate::state::tokens::{NewToken, Place, TokenStore};
use crate::state::{ServerIdentity, StateFolder, date};

fn station(name: &str, change: &str) -> Station {
    let change: PlanChange = crate::exact::read(change).expect("a change");
    Station {
        name: name.into(),
        plan: Plan::of(&change).expect("a plan"),
    }
}

fn input(place: &Path) -> CheckInput {
    CheckInput {
        listen: "127.0.0.1:0".into(),
        state: Some(place.join("state")),
        recordings: place.join("recordings"),
        viewers: ViewersPolicy::Recorded,
        recordings_quota: None,
        key: None,
        stations: vec![station("a", "")],
        hours: 0.5,
        real_time: true,
        has_own_token: false,
    }
}

fn of<'a>(findings: &'a [Finding], subject: &str) -> &'a Finding {
    let found = findings.iter().find(|one| one.subject == subject);
    found.unwrap_or_else(|| panic!("no finding about {subject}: {findings:#?}"))
}

fn load(mean_us: f64, tools: usize) -> StationLoad {
    StationLoad {
        station: "a".into(),
        tools,
        load: Load {
            cost: Cost {
                mean_us,
                p50_us: mean_us,
                p99_us: mean_us,
                p999_us: mean_us,
            },
            rate_hz: 1000,
        },
    }
}

#[test]
fn a_new_machine_and_a_ready_one_are_told_apart() {
    let place = tempfile::tempdir().expect("temporary folder");
    let input = input(place.path());
    let before = check(&input, &|_, _| ());
    assert_eq!(of(&before, "state").level, Level::Warning, "{before:#?}");
    assert!(
        !place.path().join("state").exists(),
        "the check makes no folder"
    );
    assert!(!place.path().join("recordings").exists());

    let folder = StateFolder::open(input.state.as_deref()).expect("creates");
    ServerIdentity::load_or_create(&folder, date::now_s()).expect("makes");
    let token = NewToken {
        role: sulcus_proto::Role::Student,
        station: Place::Station("a".into()),
        learner: String::new(),
        class: String::new(),
        expires_unix_s: date::now_s() + date::DAY_S,
    };
    TokenStore::of(&folder)
        .add(&[token], date::now_s())
        .expect("adds");
    let after = check(&input, &|_, _| ());
    for subject in [
        "port",
        "state",
        "certificate",
        "tokens",
        "key",
        "plan",
        "capacity",
        "recordings",
        "disk",
    ] {
        assert_eq!(of(&after, subject).level, Level::Ok, "{after:#?}");
    }
    // These two depend on the rights of the test.
    for subject in ["real time", "memory"] {
        let found = of(&after, subject);
        assert_eq!(
            found.level == Level::Ok,
            found.advice.is_empty(),
            "{found:?}"
        );
        assert_ne!(found.level, Level::Problem);
    }
    assert_eq!((report(&after, true), report(&after, false)), (0, 0));
}

#[test]
fn each_fault_is_a_problem_with_advice() {
    let place = tempfile::tempdir().expect("temporary folder");
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let folder = StateFolder::open(Some(&place.path().join("state"))).expect("creates");
    let old = date::now_s() - 4000 * date::DAY_S;
    ServerIdentity::load_or_create(&folder, old).expect("makes");
    let tokens = folder.file("tokens.json");
    std::fs::write(&tokens, "{}").expect("writes");
    std::fs::set_permissions(&tokens, std::fs::Permissions::from_mode(0o644)).expect("own file");
    std::fs::write(place.path().join("recordings"), "no folder").expect("writes");
    let bad = CheckInput {
        listen: taken.local_addr().expect("bound").to_string(),
        stations: vec![
            station("a", "exercise = \"juggling\""),
            station("b", "scene = \"/no/such.toml\""),
        ],
        hours: 1e9,
        ..input(place.path())
    };
    let findings = check(&bad, &|_, _| ());
    for (subject, told) in [
        ("port", "uses"),
        ("certificate", "expired"),
        ("tokens", "mode"),
        ("plan", "juggling"),
        ("recordings", "no folder"),
    ] {
        let found = of(&findings, subject);
        assert_eq!(found.level, Level::Problem, "{found:?}");
        assert!(
            found.text.contains(told) && !found.advice.is_empty(),
            "{found:?}"
        );
    }
    let plans = findings.iter().filter(|one| one.subject == "plan").count();
    assert_eq!(plans, 2);
    assert_eq!(report(&findings, true), 1);
    assert_eq!(
        of(
            &check(
                &CheckInput {
                    listen: "nowhere".into(),
                    ..bad
                },
                &|_, _| ()
            ),
            "port"
        )
        .level,
        Level::Problem
    );
}

#[test]
fn a_folder_without_the_right_to_write_is_a_problem() {
    let place = tempfile::tempdir().expect("temporary folder");
    let folder = place.path().join("recordings");
    std::fs::create_dir(&folder).expect("creates");
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o500)).expect("own folder");
    let is_root = rustix::process::geteuid().is_root();
    let found = disk::recordings(&folder);
    // The administrator may write everywhere.
    assert_eq!(found.level == Level::Problem, !is_root, "{found:?}");
    assert_eq!(std::fs::read_dir(&folder).expect("lists").count(), 0);
}

#[test]
fn the_disk_needs_room_for_all_hours_of_all_stations() {
    let loads = [load(50.0, 2), load(50.0, 1)];
    let found = disk::room_of(20e9, ViewersPolicy::Recorded, &loads, 2, 10.0);
    assert_eq!(found.level, Level::Ok, "{found:?}");
    let found = disk::room_of(18e9, ViewersPolicy::Recorded, &loads, 2, 10.0);
    assert_eq!(found.level, Level::Problem);
    assert!(
        found.text.contains("19.0 GB needed, 18.0 GB free"),
        "{found:?}"
    );
    assert!(found.advice.contains("9.5 h"), "{found:?}");
    let found = disk::room_of(18e9, ViewersPolicy::Recorded, &[], 2, 10.0);
    assert!(found.text.contains("24.0 GB needed"), "{found:?}");
    // The same stations without the channels for viewers.
    let found = disk::room_of(18e9, ViewersPolicy::OnDemand, &loads, 2, 10.0);
    assert_eq!(found.level, Level::Ok, "{found:?}");
    assert!(found.text.contains("10.0 GB needed"), "{found:?}");
    let found = disk::room_of(18e9, ViewersPolicy::OnDemand, &[], 2, 10.0);
    assert!(found.text.contains("12.0 GB needed"), "{found:?}");
    // The advice names the policy where the policy helps.
    let found = disk::room_of(9e9, ViewersPolicy::Recorded, &loads, 2, 10.0);
    assert!(found.advice.contains("--viewers on-demand"), "{found:?}");
    let found = disk::room_of(9e9, ViewersPolicy::OnDemand, &[], 2, 10.0);
    assert!(!found.advice.contains("--viewers"), "{found:?}");
}

#[test]
fn the_quota_of_the_recordings_is_said_with_its_rest() {
    let place = tempfile::tempdir().expect("temporary folder");
    let folder = place.path().join("recordings");
    let loads = [load(50.0, 2), load(50.0, 1)];
    let quota = |most, hours| disk::quota(&folder, most, ViewersPolicy::Recorded, &loads, hours);
    let found = quota(None, 1.0);
    assert_eq!(found.level, Level::Ok);
    assert!(found.text.contains("recordings_quota_gb"), "{found:?}");
    // The start makes the folder: all of the quota is left.
    let found = quota(Some(2_000_000_000), 1.0);
    assert_eq!(found.level, Level::Ok, "{found:?}");
    std::fs::create_dir(&folder).expect("creates");
    let file = std::fs::File::create(folder.join("a.mcap")).expect("a file");
    file.set_len(500_000_000).expect("a sparse file");
    let found = quota(Some(2_000_000_000), 1.0);
    assert_eq!(found.level, Level::Warning, "{found:?}");
    for words in ["0.500 GB used, 1.5 GB left of 2.0 GB", "need 1.9 GB"] {
        assert!(found.text.contains(words), "{found:?}");
    }
    let found = quota(Some(400_000_000), 0.1);
    assert_eq!(found.level, Level::Problem, "{found:?}");
    assert!(found.advice.contains("class expire"), "{found:?}");
}

#[test]
fn stations_that_do_not_fit_are_a_problem_with_the_number_that_fits() {
    let machine = Machine::of(vec![0, 1], &crate::capacity::Throttle::default());
    let few: Vec<StationLoad> = (0..4).map(|_| load(100.0, 1)).collect();
    let found = capacity_on(machine.clone(), &few, 4);
    assert_eq!(found.level, Level::Ok);
    assert!(found.text.contains("4 of 4"), "{found:?}");
    let many: Vec<StationLoad> = (0..40).map(|_| load(100.0, 1)).collect();
    let found = capacity_on(machine, &many, 40);
    assert_eq!(found.level, Level::Problem);
    assert!(found.text.contains("room for"), "{found:?}");
}
