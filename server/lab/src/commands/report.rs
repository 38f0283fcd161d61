//! `sulcus-server report`: speed against error, on one page.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use sulcus_program::{PathText, say, tell};

use crate::commands::tree::writable;
use crate::page::report;
use crate::report::paper::{Part, paper_part};
use crate::report::{Beside, Kind, Options, Readme, measure};
use sulcus_program::ProgressLines;

/// Measure speed against error on this machine
#[derive(Clone, Debug, Args)]
#[command(
    about = "Measure speed against error on this machine",
    long_about = "Measure speed against error on this machine: does it hold a kilohertz, how wrong is it, where does it break.\n\nRuns the hard cases by the coupled method and as printed, with the tick's solver and with the judge, times whole ticks and their stages, and compares the tissue models with finite elements. Writes one page (report.html, which needs nothing but itself) and one file of numbers (report.json). Leave the machine alone meanwhile: times are those of a machine that others use, else.",
    after_long_help = "Examples:\n  sulcus-server report --quick\n  sulcus-server report --paper --out report --peers peers.json\n  sulcus-server report --paper=whole-mouth\n  sulcus-server report --paper --readme server/lab/README.md\n  sulcus-server report --quick --json | tail -1 | jq '.rows[] | select(.status == \"broken\") | .case'\n\nExit code: 0 all that must hold holds, 1 something does not, 2 usage or bad input."
)]
pub struct ReportArgs {
    /// Measure fewer cases with fewer repeats: under a minute instead of under ten
    #[arg(long)]
    quick: bool,
    /// Measure the numbers of the paper, too. With a part: measure and print this part only
    #[arg(long, value_name = "PART", num_args = 0..=1, require_equals = true)]
    paper: Option<Option<Part>>,
    /// Folder for page and numbers. A missing folder is created
    #[arg(long, value_name = "DIR", default_value = "report")]
    out: PathBuf,
    /// File with the numbers of other engines, written by `cargo bench -p sulcus-peers --features rapier`
    #[arg(long, value_name = "FILE")]
    peers: Option<PathBuf>,
    /// File with the costs of the student's screen, written by the example `cost` of `sulcus-screen` with `--json`
    #[arg(long, value_name = "FILE")]
    screen: Option<PathBuf>,
    /// File with sessions through named networks, written by the example `networks` of `sulcus-client` with `--json`
    #[arg(long, value_name = "FILE")]
    networks: Option<PathBuf>,
    /// Document for the measured tables: replaces all lines between `<!-- begin: measured -->` and `<!-- end: measured -->`
    ///
    /// The tables have machine, commit, date, and the command that measures each again. A full report has all of
    /// them: --readme needs --paper without a part, no --quick, and a release build. The commit is that of the checkout
    /// around the document, by `git`. Numbers of other engines need --peers.
    #[arg(long, value_name = "FILE")]
    readme: Option<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &ReportArgs) -> anyhow::Result<u8> {
    let progress = ProgressLines::default();
    let kind = Kind {
        quick: args.quick,
        paper: args.paper,
    };
    let readme = args.readme.as_deref();
    let readme = readme.map(|file| Readme::open(file, kind)).transpose()?;
    if let Some(Some(part)) = args.paper {
        return one_part(part, args, &progress);
    }
    writable(&args.out)?;
    let options = Options {
        quick: args.quick,
        paper: args.paper.is_some(),
        peers: args.peers.as_deref().map(read_peers).transpose()?,
        screen: args.screen.as_deref().map(read_screen).transpose()?,
        networks: args.networks.as_deref().map(read_networks).transpose()?,
    };
    let found = measure(options, &|what, share| progress.report(what, share))?;
    let json = serde_json::to_string(&found).context("the numbers cannot be written")?;
    let write = |name: &str, text: &str| -> anyhow::Result<PathBuf> {
        let path = args.out.join(name);
        std::fs::write(&path, text)
            .with_context(|| format!("{}: cannot write it", path.shown()))?;
        Ok(path)
    };
    write("report.json", &json)?;
    let page = write("report.html", &report::page(&found)?)?;
    tell!("wrote {} in {:.0} s", page.shown(), found.took_s);
    if let Some(readme) = &readme {
        readme.write(&found)?;
    }
    for answer in report::answers(&found) {
        say!("{} {}", answer.question, answer.short);
    }
    if args.json {
        say!("{json}");
    }
    Ok(u8::from(!report::failures(&found).is_empty()))
}

/// Measures one part of the paper and prints it: no page, no files.
fn one_part(part: Part, args: &ReportArgs, progress: &ProgressLines) -> anyhow::Result<u8> {
    if args.screen.is_some() {
        bail!("--screen is given, expected not with a part of the paper: it goes onto the page");
    }
    if args.networks.is_some() {
        bail!("--networks is given, expected not with a part of the paper: it goes onto the page");
    }
    if args.peers.is_some() {
        bail!("--peers is given, expected not with a part of the paper: it goes onto the page");
    }
    let found = paper_part(part, args.quick, &|what, share| {
        progress.report(what, share)
    })?;
    let found = Beside::of(found, args.quick);
    for row in &found.rows {
        let printed = row.printed.as_deref().unwrap_or("unknown");
        say!("{}, {}", row.place, row.what);
        say!(
            "    printed:  {printed}\n    measured: {}\n    how:      {}",
            row.measured,
            row.how
        );
    }
    if args.json {
        let json = serde_json::to_string(&found).context("the numbers cannot be written")?;
        say!("{json}");
    }
    Ok(0)
}

/// Reads what the bench against other engines wrote.
fn read_peers(path: &Path) -> anyhow::Result<serde_json::Value> {
    let writer = "cargo bench -p sulcus-peers --features rapier";
    read_lists(path, "--peers", &["rows", "ratios"], writer)
}

/// Reads what the example of the screen wrote.
fn read_screen(path: &Path) -> anyhow::Result<serde_json::Value> {
    let writer = "cargo run --release -p sulcus-screen --example cost";
    read_lists(path, "--screen", &["rows", "levels", "bounds"], writer)
}

/// Reads what the example of the networks wrote: its rows.
fn read_networks(path: &Path) -> anyhow::Result<serde_json::Value> {
    let writer = "cargo run --release -p sulcus-client --example networks";
    let mut file = read_lists(path, "--networks", &["networks"], writer)?;
    Ok(file["networks"].take())
}

/// Reads the file of an option. `fields` are lists that the file must have, `writer` is the command that writes it.
fn read_lists(
    path: &Path,
    option: &str,
    fields: &[&str],
    writer: &str,
) -> anyhow::Result<serde_json::Value> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("{}: cannot read the file of {option}", path.shown()))?;
    let value: serde_json::Value =
        serde_json::from_str(&text).with_context(|| format!("{}: is not JSON", path.shown()))?;
    for field in fields {
        if !value.get(field).is_some_and(serde_json::Value::is_array) {
            bail!(
                "{}: has no list `{field}`: expected what `{writer}` writes",
                path.shown()
            );
        }
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_of_the_bench_is_refused_with_its_field() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("peers.json");
        let said = |text: &str| {
            std::fs::write(&path, text).expect("written");
            format!("{:#}", read_peers(&path).expect_err("refused"))
        };
        assert!(said("{").contains("is not JSON"));
        assert!(said("{\"rows\": []}").contains("`ratios`"));
        assert!(said("[1]").contains("`rows`"));
        std::fs::write(&path, "{\"rows\": [], \"ratios\": []}").expect("written");
        assert!(read_peers(&path).is_ok());
        let other = format!("{:#}", read_screen(&path).expect_err("refused"));
        assert!(other.contains("`levels`"), "{other}");
        let other = format!("{:#}", read_networks(&path).expect_err("refused"));
        assert!(other.contains("`networks`"), "{other}");
        let missing = read_peers(&folder.path().join("no.json")).expect_err("refused");
        assert!(format!("{missing:#}").contains("no.json"));
    }
}
