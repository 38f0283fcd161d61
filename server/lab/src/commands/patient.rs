//! `sulcus-server patient`: patient files generated and checked.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use sulcus_program::{PathText, say};
use sulcus_scene::anatomy::mouth;
use sulcus_scene::anatomy::patient::{Condition, Patient, as_text, generate};

/// Make and check patient files: what a mouth's pockets are like, site by site.
#[derive(Clone, Debug, Args)]
pub struct PatientArgs {
    /// Action.
    #[command(subcommand)]
    pub action: PatientAction,
}

/// What `patient` can do.
#[derive(Clone, Debug, Subcommand)]
pub enum PatientAction {
    /// Write a generated patient to a file. A scene file names it by `patient = "FILE"` under `[mouth]`.
    ///
    /// Example: sulcus-server patient make --condition periodontitis --seed 7 --out patient.toml
    Make {
        /// Condition: healthy, gingivitis or periodontitis
        #[arg(long, value_name = "NAME", default_value = "periodontitis")]
        condition: Condition,
        /// Random seed of the patient. A seed gives the same patient on every machine
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// File to write. An existing file is not overwritten
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Read a patient file, check it, and print its chart.
    ///
    /// Example: sulcus-server patient check patient.toml
    Check {
        /// Patient file (TOML)
        file: PathBuf,
    },
}

/// Runs the command; the exit code is 0.
///
/// # Errors
/// If the file cannot be used or written.
pub fn run(args: &PatientArgs) -> anyhow::Result<u8> {
    match &args.action {
        PatientAction::Make {
            condition,
            seed,
            out,
        } => {
            let patient = generate(*seed, *condition);
            let written = OpenOptions::new()
                .write(true)
                .create_new(true)
                .open(out)
                .and_then(|mut file| file.write_all(patient.to_toml().as_bytes()));
            written.with_context(|| format!("{}: cannot write the patient", out.shown()))?;
            say!("{}", as_text(&patient).trim_end());
        }
        PatientAction::Check { file } => {
            let (patient, _) = Patient::read(file)?;
            mouth::check(&patient).with_context(|| file.shown().to_string())?;
            say!("{}", as_text(&patient).trim_end());
        }
    }
    Ok(0)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn make(out: &Path, seed: u64) -> anyhow::Result<u8> {
        run(&PatientArgs {
            action: PatientAction::Make {
                condition: Condition::Periodontitis,
                seed,
                out: out.to_owned(),
            },
        })
    }

    #[test]
    fn what_is_made_can_be_read_again_and_is_never_overwritten() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("patient.toml");
        make(&file, 7).expect("writes");
        let made = generate(7, Condition::Periodontitis);
        assert_eq!(Patient::read(&file).expect("valid").0, made);
        let told = format!("{:#}", make(&file, 8).expect_err("it is there"));
        assert!(told.contains("patient.toml: cannot write"), "{told}");
        assert_eq!(Patient::read(&file).expect("untouched").0, made);
    }
}
