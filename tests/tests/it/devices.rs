//! Haptic devices from outside: the list, and the checks of a station.

use sulcus_tests::{Ended, Place, Program};

/// Runs the client on a computer without any service or library of a vendor.
fn bare(place: &Place, arguments: &[&str]) -> Ended {
    let output = place
        .command(Program::Client.path())
        .args(arguments)
        // No service listens at port 1.
        .env("SULCUS_HAPLY", "127.0.0.1:1")
        .env("SULCUS_HD_LIBRARY", place.path("no-hd.so"))
        .env("SULCUS_DHD_LIBRARY", place.path("no-dhd.so"))
        .output();
    Ended::new(output.expect("the program starts"))
}

#[test]
fn every_back_end_is_listed_without_its_library_and_says_what_is_missing() {
    let place = Place::new();
    let listed = bare(&place, &["devices", "--json"]).ok().json();
    let listed = listed["devices"].as_array().expect("a list");
    for library in ["haply", "openhaptics", "forcedimension"] {
        let found = listed.iter().find(|one| one["library"] == library);
        let found = found.unwrap_or_else(|| panic!("{library}: {listed:?}"));
        for field in ["model", "serial", "hand"] {
            assert_eq!(found[field], "", "{found}");
        }
        for field in ["motion_dof", "force_dof"] {
            assert_eq!(found[field], 0, "{found}");
        }
        assert_eq!(found["state"], "no_library", "{found}");
        let message = found["message"].as_str().expect("a sentence");
        assert!(message.len() > 30, "{found}");
    }
    for library in ["playback", "mouse", "gamepad", "spacenavd"] {
        assert!(
            listed.iter().any(|one| one["library"] == library),
            "{library}"
        );
    }
    // The table for a person has a line for each.
    let table = bare(&place, &["devices"]).ok().stdout;
    assert_eq!(table.lines().count(), listed.len(), "{table}");
}

#[test]
fn the_doctor_has_a_sentence_for_each_check_and_its_exit_code_tells_of_a_finding() {
    let place = Place::new();
    let ended = bare(&place, &["doctor", "--json"]);
    let checks = ended.json();
    let checks = checks["checks"].as_array().expect("a list");
    let mut words = String::new();
    for check in checks {
        let name = check["name"].as_str().expect("a name");
        let message = check["message"].as_str().expect("a sentence");
        assert!(check["ok"].is_boolean() && !message.is_empty(), "{check}");
        words += &format!("{name} ").to_lowercase();
    }
    for part in ["openhaptics", "haply", "udp", "clock", "real", "disk"] {
        assert!(words.contains(part), "`{part}` is not in: {words}");
    }
    let all = checks.iter().all(|check| check["ok"] == true);
    assert_eq!(ended.code, i32::from(!all), "{ended:#?}");
}

#[test]
fn a_device_that_is_not_there_is_refused_with_its_name() {
    let place = Place::new();
    let server = place.serve(&[]);
    for (name, words) in [
        ("haply:049D", &["haply"][..]),
        ("openhaptics", &["openhaptics"]),
        ("playback:nothing.mcap", &["nothing.mcap"]),
        ("nonsense:1", &["nonsense"]),
    ] {
        let run = [
            "run",
            "--server",
            &server.address,
            "--ticket",
            &server.ticket,
        ];
        let arguments = [&run[..], &["--device", name, "--duration", "2"]].concat();
        bare(&place, &arguments).refused(words);
    }
}
