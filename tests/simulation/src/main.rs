//! `sulcus-simulation`: sessions in virtual time, with faults by seed.

use std::process::ExitCode;
use std::time::Instant;

use clap::{Parser, ValueEnum};
use serde::Serialize;
use sulcus_program::{say, tell};
use sulcus_simulation::class::{Class, hash};
use sulcus_simulation::invariants::{Broken, INVARIANTS};
use sulcus_simulation::known::{KNOWN, Known, MANY, known};
use sulcus_simulation::run::Outcome;

/// Sessions in virtual time, with faults drawn from seeds.
///
/// The loops of server and client run in steps over a network in memory. After each event, invariants are checked.
/// Each failing seed prints the command that shows it again. The first one prints the events of its last second, too.
///
/// Known faults are listed in `known.rs`. The exit code is 1 for a broken invariant that is not listed. It is also 1
/// for a listed one that none of 20 seeds or more shows.
#[derive(Parser)]
#[command(name = "sulcus-simulation", version)]
struct Args {
    /// Hall: `a` has no QUIC between client and server.
    #[arg(long, value_enum, default_value_t = Hall::A)]
    hall: Hall,
    /// First and last seed, or one seed.
    #[arg(long, value_name = "FROM..TO", default_value = "1..20", value_parser = seeds)]
    seeds: Seeds,
    /// Length of a session, seconds of virtual time.
    #[arg(long, value_name = "S", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=3600))]
    seconds: u64,
    /// Number of stations of each seed.
    #[arg(long, value_name = "COUNT", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=30))]
    stations: u32,
    /// Scene of the stations.
    #[arg(long, value_enum, default_value_t = Scene::Small)]
    scene: Scene,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Hall {
    A,
}

#[derive(Clone, Copy, ValueEnum)]
enum Scene {
    /// Two balls over a plate of spheres.
    Small,
}

/// First and last seed.
#[derive(Clone, Copy)]
struct Seeds(u64, u64);

fn seeds(text: &str) -> Result<Seeds, String> {
    let refuse = || format!("found `{text}`, expected two numbers such as 1..200, or one");
    let (from, to) = text.split_once("..").unwrap_or((text, text));
    let number = |text: &str| text.parse().map_err(|_| refuse());
    let (from, to) = (number(from)?, number(to)?);
    if from > to {
        return Err(refuse());
    }
    Ok(Seeds(from, to))
}

/// Broken invariant of a session.
#[derive(Serialize)]
struct Failed {
    seed: u64,
    station: u32,
    invariant: u8,
    text: String,
    at_s: f64,
    command: String,
}

#[derive(Serialize)]
struct Report {
    seeds: u64,
    failed: Vec<Failed>,
    /// Faults that are listed with an issue: the first session that shows each.
    known: Vec<Failed>,
    /// Numbers of listed faults that no session shows, of many seeds.
    vanished: Vec<u8>,
    ticks: u64,
    virtual_s: f64,
    wall_s: f64,
    events_hash: String,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let (Hall::A, Scene::Small) = (args.hall, args.scene);
    let Seeds(from, to) = args.seeds;
    let class = Class {
        from,
        to,
        stations: args.stations,
        seconds: args.seconds,
    };
    let began = Instant::now();
    let done = |outcome: &Outcome| {
        if !outcome.broken.is_empty() {
            tell!(
                "seed {}, station {}: {} broken",
                outcome.name.seed,
                outcome.name.station,
                outcome.broken.len()
            );
        }
    };
    let outcomes = match class.run(done) {
        Ok(outcomes) => outcomes,
        Err(text) => {
            tell!("error: {text}");
            return ExitCode::from(2);
        }
    };
    let broken = |outcome: &Outcome| {
        outcome
            .broken
            .first()
            .map(|first| failed(outcome, first, &args))
    };
    let shown = |one: &Known| {
        outcomes.iter().find_map(|outcome| {
            let first = outcome
                .known
                .iter()
                .find(|(_, broken)| broken.number == one.invariant)?;
            Some(failed(outcome, first, &args))
        })
    };
    let is_gone = |one: &&Known| to - from + 1 >= MANY && shown(one).is_none();
    let report = Report {
        seeds: to - from + 1,
        known: KNOWN.iter().filter_map(shown).collect(),
        vanished: KNOWN
            .iter()
            .filter(is_gone)
            .map(|one| one.invariant)
            .collect(),
        ticks: outcomes.iter().map(|outcome| outcome.ticks).sum(),
        virtual_s: outcomes
            .iter()
            .map(|outcome| outcome.virtual_ns as f64 / 1e9)
            .sum(),
        wall_s: began.elapsed().as_secs_f64(),
        events_hash: hex(&hash(&outcomes)),
        failed: outcomes.iter().filter_map(broken).collect(),
    };
    if args.json {
        match serde_json::to_string_pretty(&report) {
            Ok(text) => say!("{text}"),
            Err(error) => tell!("error: {error}"),
        }
    } else {
        print(&report, &outcomes);
    }
    ExitCode::from(u8::from(
        !report.failed.is_empty() || !report.vanished.is_empty(),
    ))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A broken invariant of a session, with the command that shows it again.
fn failed(outcome: &Outcome, (at_ns, broken): &(u64, Broken), args: &Args) -> Failed {
    let (seed, station) = (outcome.name.seed, outcome.name.station);
    Failed {
        seed,
        station,
        invariant: broken.number,
        text: broken.text.clone(),
        at_s: *at_ns as f64 / 1e9,
        command: format!(
            "cargo run --release -p sulcus-simulation -- --hall a --seeds {seed} --seconds {} --stations {}",
            args.seconds,
            station + 1
        ),
    }
}

fn print(report: &Report, outcomes: &[Outcome]) {
    for failed in &report.failed {
        say!(
            "seed {}, station {}, {:.6} s: invariant {}: {}",
            failed.seed,
            failed.station,
            failed.at_s,
            failed.invariant,
            failed.text
        );
        let sentence = INVARIANTS
            .iter()
            .find(|(number, _)| *number == failed.invariant);
        if let Some((_, sentence)) = sentence {
            say!("  {sentence}");
        }
        say!("  {}", failed.command);
    }
    for one in &report.known {
        let issue = known(one.invariant).map_or("", |known| known.issue);
        say!(
            "known, by the issue \"{issue}\": invariant {}, seed {}, station {}, {:.6} s",
            one.invariant,
            one.seed,
            one.station,
            one.at_s
        );
    }
    for number in &report.vanished {
        say!(
            "invariant {number} is listed as a known fault, and no seed shows it: remove it from known.rs"
        );
    }
    if let Some(first) = outcomes.iter().find(|outcome| !outcome.broken.is_empty()) {
        say!(
            "\nlast second of seed {}, station {}",
            first.name.seed,
            first.name.station
        );
        for line in &first.lines {
            say!("  {line}");
        }
    }
    say!(
        "{} seeds, {} failed sessions; {} ticks, {:.0} s of virtual time in {:.1} s; events {}",
        report.seeds,
        report.failed.len(),
        report.ticks,
        report.virtual_s,
        report.wall_s,
        &report.events_hash[..16]
    );
}
