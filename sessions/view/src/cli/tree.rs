//! `sulcus-review tree`: writes the picture of a sphere tree from standard input.

use std::io::{BufReader, stdin};
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::Args;

use crate::tree::write_tree;
use crate::tree_picture::TreePicture;

#[derive(Args)]
pub(super) struct TreeArgs {
    /// File to write
    #[arg(long, value_name = "FILE.rrd")]
    out: PathBuf,
}

pub(super) fn run(args: &TreeArgs) -> anyhow::Result<ExitCode> {
    let picture: TreePicture = serde_json::from_reader(BufReader::new(stdin()))
        .context("standard input: not the JSON picture of a sphere tree")?;
    write_tree(&args.out, &picture)?;
    Ok(ExitCode::SUCCESS)
}
