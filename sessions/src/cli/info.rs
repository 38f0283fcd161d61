//! `info`: what recordings hold.

use std::path::{Path, PathBuf};

use clap::Args;

use super::print::{Outcome, at, object};
use crate::info::info;
use crate::read::Recording;

#[derive(Args)]
pub(super) struct InfoArgs {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn info_of(path: &Path) -> anyhow::Result<Outcome> {
    let recording = Recording::open(path).map_err(|error| at(path, &error))?;
    let info = info(path, &recording).map_err(|error| at(path, &error))?;
    Ok(Outcome {
        json: object(serde_json::to_value(&info)?),
        text: info.to_string(),
        finding: info.is_finding(),
    })
}
