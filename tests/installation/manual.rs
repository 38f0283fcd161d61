//! The commands of the server's manual, as they stand there, on bare machines: from nothing to a graded remote session.

use std::path::Path;

use sulcus_sessions::Recording;
use sulcus_support::Resource;
use sulcus_tests::files_with;

use crate::machine::{Debian, Machine};
use crate::packages::{file, packages};

/// Heading of the section.
const SECTION: &str = "## Installation in ten minutes";
/// Largest number of commands.
const COMMANDS: usize = 12;

/// Blocks of commands of the section, without remarks: those of the server, of a station, and of the server after the session.
fn blocks() -> Vec<Vec<String>> {
    let manual = Path::new(env!("CARGO_MANIFEST_DIR")).join("../server/README.md");
    let manual = std::fs::read_to_string(manual).expect("the manual");
    let (_, section) = manual.split_once(SECTION).expect(SECTION);
    let section = section.split("\n## ").next().unwrap_or_default();
    let mut blocks: Vec<Vec<String>> = Vec::new();
    let mut was_command = false;
    for line in section.lines() {
        let command = line.strip_prefix("    ");
        if let Some(command) = command {
            if !was_command {
                blocks.push(Vec::new());
            }
            let command = command.split("  #").next().unwrap_or_default();
            let block = blocks.last_mut().expect("a block");
            block.push(command.trim().to_owned());
        }
        was_command = command.is_some();
    }
    blocks
}

fn run(machine: &mut Machine, commands: &[String], values: &[(&str, &str)]) -> String {
    let mut told = String::new();
    for command in commands {
        let mut command = command.clone();
        for (name, value) in values {
            command = command.replace(name, value);
        }
        told += &machine.ok(&command);
    }
    told
}

#[test]
fn bare_machines_have_a_graded_session_after_the_commands_of_the_manual() {
    let Some(debian) = Resource::Image.or_skip(Debian::new()) else {
        return;
    };
    let blocks = blocks();
    let count: usize = blocks.iter().map(Vec::len).sum();
    assert!(count <= COMMANDS, "{count} commands");
    let [at_server, at_station, after] = blocks.as_slice() else {
        panic!("three blocks: server, station, results; found {blocks:?}")
    };

    let mut server = debian.machine("server");
    server.receive(&file(packages(), "sulcus-server_", ".deb"));
    let table = run(&mut server, at_server, &[]);
    let ticket = |role: &str| {
        let line = table.lines().find(|line| line.starts_with(role));
        let line = line.unwrap_or_else(|| panic!("a ticket of {role} in {table}"));
        line.rsplit(',').next().unwrap_or_default().to_owned()
    };

    let mut station = debian.machine("station");
    let values = [("SERVER", "127.0.0.1"), ("TICKET", &ticket("student"))];
    let told = run(&mut station, at_station, &values);
    assert!(told.contains("session"), "{told}");

    let told = run(&mut server, after, &values);
    assert!(told.contains("Score") || told.contains("score"), "{told}");

    // The backup before an upgrade, as the manual of the installation has it.
    server.ok("sulcus-school backup /var/lib/sulcus/before-upgrade.backup");

    // The service ends in order, and the recording is whole and signed.
    server.ok("systemctl stop sulcus-server");
    let recordings = files_with(&server.path("/var/lib/sulcus/school/recordings"), "mcap");
    assert_eq!(recordings.len(), 1, "{recordings:?}");
    let recording = Recording::open(&recordings[0]).expect("a recording");
    assert!(recording.facts().rows > 1000, "{:?}", recording.facts());

    // Folders and secrets belong to the service's user alone; a removal of the package keeps them.
    let owner = server.ok("stat -c '%U %a' /var/lib/sulcus /var/lib/sulcus/school/tickets.csv");
    assert_eq!(owner.trim(), "sulcus 700\nsulcus 600");
    server.ok("apt-get purge --yes sulcus-server");
    server.ok("test -f /var/lib/sulcus/state/station.key && test ! -e /usr/bin/sulcus-server");
}
