//! The measured tables of a document: `report --paper --readme FILE`.
//!
//! All numbers between the markers of the document come from one report. A report that lacks a table replaces nothing.

mod devices;
mod loops;
mod markers;
mod matrix;
mod origin;
mod paper;
mod rows;
mod scenes;
mod table;
mod tissue;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use sulcus_program::{PathText, tell};

use super::paper::Part;
use super::{Asked, Report};
use origin::Origin;
use table::Table;

/// Command of every table that is not one of the paper.
const COMMAND: &str = "sulcus-server report";

/// Maker of a table from a report.
type Make = fn(&Report) -> Table;

/// Tables of every full report, in their order.
const TABLES: [(&str, Make); 14] = [
    ("Whole mouth, by level", scenes::mouth),
    ("Level, tissue, solver and method", matrix::matrix),
    ("Rates", scenes::rates),
    ("Growth with the scene", scenes::growth),
    ("Growth with the scene: bounds", scenes::growth_bounds),
    ("Hard cases", rows::summary),
    ("Hard cases, the slowest", rows::slowest),
    ("Random poses", rows::random_poses),
    ("Passivity over links, the most energy", loops::links),
    ("Passivity over links, by delay", loops::delays),
    ("A hand at rest", loops::rest),
    ("Real devices", devices::couplings),
    ("One degree of freedom", tissue::one_dof),
    ("Tissue against finite elements", tissue::elements),
];

/// A document with markers, and the origin of its next numbers.
pub(crate) struct Readme {
    path: PathBuf,
    origin: Origin,
}

/// Kind of the report that is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    /// Fewer cases and repeats.
    pub(crate) quick: bool,
    /// `None` without the paper, `Some(None)` with all parts of the paper, else one part alone.
    pub(crate) paper: Option<Option<Part>>,
}

impl Readme {
    /// Checks, before anything is measured, that the report can fill the document.
    ///
    /// # Errors
    /// The report would lack tables, the program is a debug build, or the document has no markers.
    pub(crate) fn open(path: &Path, kind: Kind) -> anyhow::Result<Self> {
        let missing = missing(kind);
        ensure!(
            missing.is_empty(),
            "--readme is given to a report without the tables {}: expected --paper without a part, and no --quick",
            quoted(&missing),
        );
        ensure!(
            !cfg!(debug_assertions),
            "--readme is given to a debug build, expected a release build: the times of ticks differ"
        );
        let readme = Self {
            path: path.to_owned(),
            origin: Origin::now(folder_of(path)),
        };
        readme.with("")?;
        Ok(readme)
    }

    /// Replaces the marked part of the document by the tables of `report`, and says so.
    ///
    /// # Errors
    /// A table has no rows, or the document cannot be read or written.
    pub(crate) fn write(&self, report: &Report) -> anyhow::Result<()> {
        let text = self.with(&block(report, &self.origin)?)?;
        std::fs::write(&self.path, text)
            .with_context(|| format!("{}: cannot write it", self.path.shown()))?;
        tell!("wrote the measured tables of {}", self.path.shown());
        Ok(())
    }

    /// The document with `block` between its markers.
    fn with(&self, block: &str) -> anyhow::Result<String> {
        let file = self.path.shown().to_string();
        let text = std::fs::read_to_string(&self.path)
            .with_context(|| format!("{file}: cannot read the document of --readme"))?;
        markers::replaced(&file, &text, block)
    }
}

/// Folder of a file; the working folder for a bare name.
fn folder_of(path: &Path) -> &Path {
    let parent = path.parent();
    parent
        .filter(|parent| !parent.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// Titles of the tables that a report of this kind does not measure in full.
fn missing(kind: Kind) -> Vec<&'static str> {
    let complete = !kind.quick && !matches!(kind.paper, Some(Some(_)));
    let own = TABLES.iter().filter(|_| !complete).map(|(title, _)| *title);
    let paper = paper::TITLES.iter().filter(|(part, ..)| match kind.paper {
        None => true,
        Some(None) => kind.quick,
        Some(Some(measured)) => kind.quick || *part != measured,
    });
    own.chain(paper.map(|(_, title, _)| *title)).collect()
}

/// Titles in quotation marks, with commas.
fn quoted(titles: &[&str]) -> String {
    let each: Vec<String> = titles.iter().map(|title| format!("`{title}`")).collect();
    each.join(", ")
}

/// The marked part: origin and all tables.
///
/// # Errors
/// A table has no rows.
fn block(report: &Report, origin: &Origin) -> anyhow::Result<String> {
    let mut text = format!(
        "Written by `sulcus-server report --paper --readme FILE`; the next report replaces all lines up to the end marker.\n\n{}\n",
        origin.markdown(&report.machine, report.took_s)
    );
    let own = TABLES
        .iter()
        .map(|(title, make)| (*title, Some(make(report))));
    let beside = report.paper.as_ref();
    let paper = paper::TITLES
        .iter()
        .map(|(part, title, make)| (*title, beside.map(|beside| make(beside, *part))));
    let all: Vec<(&str, Option<Table>)> = own.chain(paper).collect();
    let empty: Vec<&str> = all
        .iter()
        .filter(|(_, table)| table.as_ref().is_none_or(|table| table.rows.is_empty()))
        .map(|(title, _)| *title)
        .collect();
    if !empty.is_empty() {
        bail!(
            "the report has no rows for the tables {}, expected some: the document stays as it is",
            quoted(&empty)
        );
    }
    for (title, table) in &all {
        if let Some(table) = table {
            let _ = writeln!(text, "{}", table.markdown(title));
        }
    }
    match &report.peers {
        Some(peers) => text.push_str(&tissue::peers(peers).markdown("Other engines")),
        None => text.push_str(
            "### Other engines\n\nThis report ran without `--peers`: no engine but Sulcus was measured.\n",
        ),
    }
    Ok(text)
}

/// Cells of a bound: found, allowed, and whether it holds.
fn bound_cells(asked: &Asked) -> [String; 3] {
    [
        table::number(asked.found),
        table::number(asked.at_most),
        yes_no(asked.holds()),
    ]
}

/// `yes` or `no`.
fn yes_no(is: bool) -> String {
    if is { "yes" } else { "no" }.to_owned()
}

#[cfg(test)]
mod tests;
