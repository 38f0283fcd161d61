//! `sulcus-server tissue`: fits tissue models to finite elements, and judges them by finite elements.

mod evaluate;
mod fit;

use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;

/// Fit tissue models to finite elements, and judge them by finite elements.
#[derive(Clone, Debug, Args)]
pub struct TissueArgs {
    /// Action.
    #[command(subcommand)]
    pub action: TissueAction,
}

/// What `tissue` can do.
#[derive(Clone, Debug, Subcommand)]
#[expect(
    missing_docs,
    reason = "a comment on a variant would take the place of its long help"
)]
pub enum TissueAction {
    Fit(fit::FitArgs),
    Evaluate(evaluate::EvaluateArgs),
}

/// The models that are judged here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[value(rename_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Springs between 64 nodes under a skin of spheres
    Skeleton,
    /// The same exactly by the paper: one stiffness for all springs, each sphere after one node
    PrintedSkeleton,
    /// The folder's finite elements condensed to their surface; linear cases without the term for large displacements
    SurfaceCompliance,
}

/// Runs the command; the exit code is 0.
///
/// # Errors
/// If a folder or file cannot be used, or the result cannot be written.
pub fn run(args: &TissueArgs) -> anyhow::Result<u8> {
    match &args.action {
        TissueAction::Fit(args) => fit::run(args),
        TissueAction::Evaluate(args) => evaluate::run(args),
    }
}
