//! Pictures that a command line asks for: time, view and file of each.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use sulcus_program::PathText;
use sulcus_screen::views::View;

use crate::cli::PictureArgs;

/// Largest number of pictures of one run: ten minutes at 60 a second.
const MOST: usize = 36_000;
/// Largest time in a session, seconds.
const MOST_S: f64 = 3600.0;
/// Pictures of a sequence for each second, without a number.
const USUAL_FPS: f64 = 25.0;

/// Picture to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Time in the session, seconds.
    pub at_s: f64,
    /// View.
    pub view: View,
    /// FDI number of the tooth in the middle of the views of one tooth.
    pub tooth: Option<u8>,
    /// File.
    pub out: PathBuf,
}

/// Pictures in the order of their times.
#[derive(Clone, Debug, PartialEq)]
pub struct Shots {
    /// Pictures.
    pub all: Vec<Shot>,
    /// Whether they are one sequence, whose camera follows its subject slowly.
    pub is_sequence: bool,
}

impl Shots {
    /// Pictures of the command line.
    ///
    /// # Errors
    /// A field is missing or not valid; the message names the field.
    pub fn of(args: &PictureArgs) -> anyhow::Result<Self> {
        let is_sequence = args.from.is_some();
        let mut all = match (&args.list, args.from.zip(args.to)) {
            (Some(list), _) => listed(list)?,
            (None, Some((from, to))) => numbered(args, &times(from, to, args.fps)?)?,
            (None, None) if args.at.is_empty() => numbered(args, &[0.0])?,
            (None, None) => numbered(args, &args.at)?,
        };
        if all.len() > MOST {
            bail!(
                "{} pictures are asked for, expected at most {MOST}",
                all.len()
            );
        }
        all.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        Ok(Self { all, is_sequence })
    }
}

/// Times of a sequence, both ends included.
fn times(from: f64, to: f64, fps: Option<f64>) -> anyhow::Result<Vec<f64>> {
    if to < from {
        bail!("--to is {to}, expected at least --from, which is {from}");
    }
    let fps = fps.unwrap_or(USUAL_FPS);
    // The product may be rounded to just below a whole number.
    let last = ((to - from) * fps + 1e-6).floor();
    if last >= MOST as f64 {
        bail!(
            "the sequence has {} pictures, expected at most {MOST}",
            last + 1.0
        );
    }
    Ok((0..=last as u32)
        .map(|k| from + f64::from(k) / fps)
        .collect())
}

/// Pictures at `times` in the one view of the command line, with numbers from 1 if there are several.
fn numbered(args: &PictureArgs, times: &[f64]) -> anyhow::Result<Vec<Shot>> {
    let view = view(&args.view).context("--view")?;
    let out = args.out.as_deref().context("--out is missing")?;
    let named: Vec<PathBuf> = match times {
        [_] if place(out).is_none() => vec![out.to_owned()],
        times => (1..=times.len())
            .map(|number| with_number(out, number))
            .collect::<anyhow::Result<_>>()?,
    };
    let shot = |(at_s, out): (&f64, PathBuf)| Shot {
        at_s: *at_s,
        view,
        tooth: args.tooth,
        out,
    };
    Ok(times.iter().zip(named).map(shot).collect())
}

/// Pictures of a list. A relative name of a file is one of the folder of the list.
fn listed(list: &Path) -> anyhow::Result<Vec<Shot>> {
    let text = std::fs::read_to_string(list)
        .with_context(|| format!("--list {}: cannot read", list.shown()))?;
    let folder = list.parent().unwrap_or(Path::new(""));
    let lines = text.lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let shots = lines.map(|(k, line)| {
        let shot = of_line(line, folder);
        shot.with_context(|| format!("--list {}: line {}", list.shown(), k + 1))
    });
    shots.collect()
}

/// Picture of a line: seconds, view, tooth or `-`, and file, which may contain spaces.
fn of_line(line: &str, folder: &Path) -> anyhow::Result<Shot> {
    let mut words = line.trim().splitn(4, ' ');
    let mut next = |what: &str| words.next().with_context(|| format!("{what} is missing"));
    let (at, name, tooth, file) = (
        next("the time")?,
        next("the view")?,
        next("the tooth")?,
        next("the file")?,
    );
    let at_s = at
        .parse::<f64>()
        .ok()
        .filter(|s| (0.0..=MOST_S).contains(s));
    let at_s = at_s.with_context(|| format!("the time is `{at}`, expected 0 to {MOST_S} s"))?;
    let tooth = match tooth {
        "-" => None,
        fdi => Some(
            fdi.parse()
                .with_context(|| format!("the tooth is `{fdi}`, expected an FDI number or -"))?,
        ),
    };
    Ok(Shot {
        at_s,
        view: view(name)?,
        tooth,
        out: folder.join(file),
    })
}

fn view(name: &str) -> anyhow::Result<View> {
    name.parse().map_err(|error: String| anyhow!(error))
}

/// Place of a number in a name, such as `%05d`: its bytes, and its least number of digits.
fn place(out: &Path) -> Option<(std::ops::Range<usize>, usize)> {
    let name = out.to_str()?;
    let begin = name.find('%')?;
    let digits = name[begin + 1..].find('d')? + begin + 1;
    let width = &name[begin + 1..digits];
    let is_number = width.bytes().all(|b| b.is_ascii_digit()) && width.len() <= 2;
    let width = match width {
        "" => 0,
        width => width.parse().ok()?,
    };
    is_number.then_some((begin..digits + 1, width))
}

fn with_number(out: &Path, number: usize) -> anyhow::Result<PathBuf> {
    let (range, width) = place(out).with_context(|| {
        format!(
            "--out is `{}`, expected a place for the number of the picture, such as %05d.png",
            out.shown()
        )
    })?;
    let mut name = out.to_str().unwrap_or_default().to_owned();
    name.replace_range(range, &format!("{number:0width$}"));
    Ok(name.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Command};
    use clap::Parser;

    fn shots(arguments: &[&str]) -> anyhow::Result<Shots> {
        let all = [&["sulcus-client", "picture"], arguments].concat();
        match Cli::try_parse_from(all)?.command {
            Some(Command::Picture(args)) => Shots::of(&args),
            _ => bail!("no picture"),
        }
    }

    #[test]
    fn a_sequence_has_both_ends_and_numbered_files() {
        let found = shots(&["--from=2", "--to=2.5", "--fps=10", "--out=a/%03d.png"]);
        let found = found.expect("a sequence");
        assert!(found.is_sequence);
        let times: Vec<f64> = found.all.iter().map(|shot| shot.at_s).collect();
        let wanted = [2.0, 2.1, 2.2, 2.3, 2.4, 2.5];
        assert!(times.len() == 6 && times.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9));
        assert_eq!(found.all[5].out, Path::new("a/006.png"));
    }

    #[test]
    fn several_times_are_put_in_order_and_one_needs_no_number() {
        let found = shots(&["--at=3", "--at=1", "--out=%d.png", "--view=front"]).expect("two");
        let named: Vec<_> = found
            .all
            .iter()
            .map(|shot| (shot.at_s, &shot.out))
            .collect();
        let files = [PathBuf::from("2.png"), PathBuf::from("1.png")];
        assert_eq!(named, [(1.0, &files[0]), (3.0, &files[1])]);
        let one = shots(&["--out", "50 %.png"]).expect("one");
        assert_eq!((one.all[0].at_s, one.all.len()), (0.0, 1));
        assert_eq!(one.all[0].out, Path::new("50 %.png"));
    }

    #[test]
    fn a_list_names_each_picture_and_an_error_its_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let list = folder.path().join("list");
        std::fs::write(
            &list,
            "# worst first\n9.5 lingual 36 b c.png\n1 front - a.png\n",
        )
        .expect("written");
        let argument = format!("--list={}", list.display());
        let found = shots(&[&argument]).expect("two");
        assert_eq!(found.all[0].view, View::Front);
        let last = &found.all[1];
        assert_eq!((last.tooth, last.view), (Some(36), View::Lingual));
        assert_eq!(last.out, folder.path().join("b c.png"));
        for (line, named) in [
            ("x front - a.png", "the time is `x`"),
            ("1 sideways - a.png", "sideways"),
            ("1 front 300 a.png", "the tooth is `300`"),
            ("1 front -", "the file is missing"),
        ] {
            std::fs::write(&list, line).expect("written");
            let told = format!("{:#}", shots(&[&argument]).expect_err(line));
            assert!(told.contains("line 1") && told.contains(named), "{told}");
        }
    }

    #[test]
    fn what_no_run_can_draw_is_refused() {
        for (arguments, named) in [
            (&["--at=1", "--at=2", "--out=a.png"][..], "%05d.png"),
            (&["--from=2", "--to=1", "--out=%d.png"], "--to is 1"),
            (
                &["--from=0", "--to=3600", "--fps=60", "--out=%d.png"],
                "at most",
            ),
            (&["--from=0", "--out=%d.png"], "--to"),
            (&["--at=1"], "--out"),
        ] {
            let told = format!("{:#}", shots(arguments).expect_err(named));
            assert!(told.contains(named), "{told}");
        }
    }
}
