//! The subcommands, one file each.

pub mod patient;
pub mod report;
pub mod scene;
pub mod tissue;
pub mod tree;

use clap::Subcommand;

/// Subcommands of the laboratory.
#[derive(Subcommand)]
#[expect(
    missing_docs,
    reason = "a comment on a variant would take the place of its long help"
)]
pub enum LabCommand {
    Scene(scene::SceneArgs),
    Tree(tree::TreeArgs),
    Patient(patient::PatientArgs),
    Tissue(tissue::TissueArgs),
    Report(report::ReportArgs),
}

/// Runs a subcommand; returns the exit code.
///
/// # Errors
/// Bad input, or a result that cannot be written.
pub fn run(command: &LabCommand) -> anyhow::Result<u8> {
    match command {
        LabCommand::Scene(args) => scene::run(args),
        LabCommand::Tree(args) => tree::run(args),
        LabCommand::Patient(args) => patient::run(args),
        LabCommand::Tissue(args) => tissue::run(args),
        LabCommand::Report(args) => report::run(args),
    }
}
