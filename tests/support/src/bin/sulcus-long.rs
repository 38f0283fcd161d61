//! Long proofs: which are behind, and runs of them.

use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

use serde_json::Value;
use sulcus_support::Resource;
use sulcus_support::long::passed::{behind, enter, keys, root};
use sulcus_support::long::{LONG, Long};

const HELP: &str = "\
Long proofs: tests of minutes, whose last passes stand in tests/long.passed

Usage:
  sulcus-long                list the proofs that have not passed on the present sources
  sulcus-long run            run these proofs, and enter each pass
  sulcus-long run NAME...    run the named proofs, and enter each pass

Exit code: 0 success, 1 a proof has failed, 2 wrong argument";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match arguments[..] {
        [] => list(),
        ["run", ref names @ ..] => run(names),
        ["--help" | "-h"] => {
            println!("{HELP}");
            Ok(true)
        }
        _ => Err(format!(
            "argument is `{}`, expected `run`\n\n{HELP}",
            arguments.join(" ")
        )),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn list() -> Result<bool, String> {
    let behind = behind()?;
    let minutes: f64 = behind.iter().map(|row| row.long.minutes).sum();
    println!(
        "{} of {} long proofs have not passed on these sources, about {minutes:.0} minutes:",
        behind.len(),
        LONG.len()
    );
    for row in behind {
        println!(
            "  {} ({}, {} min)",
            row.long.name, row.long.package, row.long.minutes
        );
    }
    Ok(true)
}

/// Runs proofs one after another. Returns whether all have passed.
fn run(names: &[&str]) -> Result<bool, String> {
    let named = |name: &&str| {
        let found = LONG.iter().find(|long| long.name == *name);
        found.ok_or_else(|| format!("no long proof is called `{name}`"))
    };
    let chosen: Vec<&Long> = if names.is_empty() {
        behind()?.into_iter().map(|row| row.long).collect()
    } else {
        names.iter().map(named).collect::<Result<_, _>>()?
    };
    let (keys, binaries) = (keys()?, binaries()?);
    let required = Resource::ALL.map(Resource::name).join(",");
    let mut all = true;
    for long in chosen {
        let began = Instant::now();
        let key = &keys[long.package];
        let (mut passed, mut tests) = (true, 0);
        for (package, binary) in &binaries {
            if package != long.package {
                continue;
            }
            let output = Command::new(binary)
                .args(["long::", "--test-threads", "1"])
                .current_dir(&key.folder)
                .env("CARGO_MANIFEST_DIR", &key.folder)
                .env("SULCUS_LONG", long.name)
                // A proof that a missing resource skips has not passed.
                .env("SULCUS_REQUIRE", &required)
                .output()
                .map_err(|error| format!("{}: {error}", binary.display()))?;
            let told = String::from_utf8_lossy(&output.stdout);
            tests += told.lines().filter(|line| line.ends_with("... ok")).count();
            if !output.status.success() {
                passed = false;
                println!("{told}");
                eprintln!("{}", String::from_utf8_lossy(&output.stderr));
            }
        }
        passed &= tests > 0;
        let minutes = began.elapsed().as_secs_f64() / 60.0;
        let verdict = if passed { "passed" } else { "FAILED" };
        println!("{verdict} {} in {minutes:.1} minutes", long.name);
        if passed {
            enter(long.name, &key.hash, minutes)?;
        }
        all &= passed;
    }
    Ok(all)
}

/// Test binaries of the workspace with their packages, built by cargo.
fn binaries() -> Result<Vec<(String, PathBuf)>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args([
            "test",
            "--locked",
            "--workspace",
            "--no-run",
            "--message-format",
            "json",
        ])
        .current_dir(root())
        .stderr(Stdio::inherit());
    let output = command
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err("the tests do not build".to_owned());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let lines = text
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let binary = |line: Value| {
        let program = line["executable"].as_str()?;
        let manifest = line["manifest_path"].as_str()?;
        let folder = std::path::Path::new(manifest).parent()?;
        let test = line["profile"]["test"] == true;
        test.then(|| (folder.to_owned(), PathBuf::from(program)))
    };
    let found: Vec<(PathBuf, PathBuf)> = lines.filter_map(binary).collect();
    let keys = keys()?;
    let named = |(folder, program): (PathBuf, PathBuf)| {
        let package = keys.iter().find(|(_, key)| key.folder == folder)?;
        Some((package.0.clone(), program))
    };
    Ok(found.into_iter().filter_map(named).collect())
}
