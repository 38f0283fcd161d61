//! `export`: recordings as files for other programs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use sulcus_program::PathText;

use super::inputs::{open, recordings};
use super::print::{Outcome, Tally, at, object};
use crate::export::{ExportOptions, Exported, MeshFormat, export};

#[derive(Args)]
pub(super) struct ExportArgs {
    /// Recordings, or folders of recordings
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Folder for the output. Several recordings get a folder each inside it
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Write the tables ticks.csv and events.csv, and devices.csv where devices were recorded. Default without --meshes
    ///
    /// Columns of numbers hold numbers. Text that a spreadsheet would read as a number, a date or a formula begins with
    /// an apostrophe, and so does every hash. Programs that read the tables drop a leading apostrophe.
    #[arg(long)]
    pub(super) csv: bool,
    /// Write a line of ticks.csv for every N ticks
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) every_ticks: u64,
    /// Write the deformed meshes in this format
    #[arg(long, value_enum, value_name = "FORMAT", num_args = 0..=1, default_missing_value = "ply")]
    pub(super) meshes: Option<Format>,
    /// Write meshes at this time, seconds from the first tick. The option may be repeated
    #[arg(long, value_name = "SECONDS", requires = "meshes")]
    pub(super) at: Vec<f64>,
    /// Time between meshes, seconds. Default without --at: 1
    #[arg(long, value_name = "SECONDS", requires = "meshes")]
    pub(super) every: Option<f64>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Format {
    /// Wavefront, text
    Obj,
    /// Stanford, binary
    Ply,
}

impl ExportArgs {
    fn options(&self) -> ExportOptions {
        let meshes = self.meshes.map(|format| match format {
            Format::Obj => MeshFormat::Obj,
            Format::Ply => MeshFormat::Ply,
        });
        ExportOptions {
            tables: self.csv || meshes.is_none(),
            every_ticks: self.every_ticks,
            meshes,
            at_s: self.at.clone(),
            every_s: self.every.or(self.at.is_empty().then_some(1.0)),
        }
    }
}

/// Folder of each file. A single file has `out` itself, several files have folders in it with the files' names. The
/// second of two equal names gets `-2`.
fn folders(out: &Path, files: &[PathBuf]) -> Vec<PathBuf> {
    if let [_] = files {
        return vec![out.to_owned()];
    }
    let mut used = BTreeSet::new();
    let folder = |file: &PathBuf| {
        let stem = file.file_stem().unwrap_or_default();
        let mut name = stem.to_owned();
        let mut k = 2;
        while !used.insert(name.clone()) {
            name = stem.to_owned();
            name.push(format!("-{k}"));
            k += 1;
        }
        out.join(name)
    };
    files.iter().map(folder).collect()
}

pub(super) fn run(args: &ExportArgs) -> ExitCode {
    let files = recordings(&args.files);
    let mut tally = Tally::new(args.json);
    for (path, folder) in files.iter().zip(folders(&args.out, &files)) {
        tally.add(path, export_of(path, &folder, args));
    }
    tally.finish("ticks")
}

fn export_of(path: &Path, folder: &Path, args: &ExportArgs) -> anyhow::Result<Outcome> {
    let recording = open(path)?;
    // The bar draws nothing if standard error is no terminal.
    let bar =
        ProgressBar::with_draw_target(Some(recording.facts().rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let done = export(&recording, &args.options(), folder, &mut |ticks| {
        bar.set_position(ticks)
    });
    bar.finish_and_clear();
    let done = done.map_err(|error| at(path, &error))?;
    let mut json = object(serde_json::to_value(&done)?);
    json.insert("file".to_owned(), json!(path.shown().to_string()));
    json.insert("folder".to_owned(), json!(folder.shown().to_string()));
    Ok(Outcome {
        json,
        text: text(path, folder, &done),
        finding: !(done.identical || done.close) || done.unsound.is_some(),
    })
}

fn text(path: &Path, folder: &Path, done: &Exported) -> String {
    let mut lines = vec![format!("{} -> {}", path.shown(), folder.shown())];
    if done.tick_lines > 0 {
        lines.push(format!("  ticks.csv  {} lines", done.tick_lines));
        lines.push(format!("  events.csv {} lines", done.event_lines));
    }
    if done.device_lines > 0 {
        lines.push(format!("  devices.csv {} lines", done.device_lines));
    }
    if done.mesh_files > 0 {
        lines.push(format!(
            "  meshes     {} files, {} times",
            done.mesh_files, done.mesh_frames
        ));
    }
    lines.push(match done.first_divergent_tick {
        None => format!("  replay     identical, {} ticks", done.ticks),
        Some(tick) if done.close => format!(
            "  replay     differs from tick {tick}, as a recording of a former version may; the export is of the replay"
        ),
        Some(tick) => {
            format!("  replay     DIFFERS from tick {tick}; the export is of the replay")
        }
    });
    if let Some(unsound) = &done.unsound {
        lines.push(format!("  WARNING    {unsound}"));
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Before, two recordings of the same name in different folders were written into one folder.
    #[test]
    fn every_recording_has_a_folder_of_its_own() {
        let folders = |files: &[&str]| {
            let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
            folders(Path::new("out"), &files)
        };
        assert_eq!(folders(&["a/x.mcap"]), [PathBuf::from("out")]);
        let several = folders(&["a/x.mcap", "b/x.mcap", "x-2.mcap", "x.mcap"]);
        let expected = ["out/x", "out/x-2", "out/x-2-2", "out/x-3"];
        assert_eq!(several, expected.map(PathBuf::from));
    }
}
