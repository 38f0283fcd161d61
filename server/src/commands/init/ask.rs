//! Values of a first start: of the options, of a person at a terminal, or the defaults.

use std::io::{BufRead, IsTerminal, Write};

use anyhow::bail;

use super::InitArgs;
use crate::state::classes::change::class_name;

/// Address without an answer.
pub(super) const LISTEN: &str = "0.0.0.0:4433";
/// Exercise without an answer.
const EXERCISE: &str = "probing";
/// Planned hours without an answer: a school day, as of a file of stations without hours.
const HOURS: f64 = 8.0;

/// Values of a first start.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wanted {
    /// UDP address.
    pub listen: String,
    /// Number of stations.
    pub stations: u8,
    /// Exercise of all stations.
    pub exercise: String,
    /// Planned hours of each station.
    pub hours: f64,
    /// Name of the first class; may be empty.
    pub class: String,
    /// Folder of recordings; a relative path begins at the folder of the file.
    pub recordings: String,
}

impl Wanted {
    /// Values of the arguments, and of answers on standard input if it is a terminal.
    pub fn of(args: &InitArgs) -> anyhow::Result<Self> {
        let stdin = std::io::stdin();
        let asks = !args.yes && !args.json && stdin.is_terminal();
        let (mut lines, mut out) = (stdin.lock(), std::io::stderr().lock());
        let mut questions = Questions {
            lines: asks.then_some(&mut lines as &mut dyn BufRead),
            out: &mut out,
        };
        Self::asked(args, &mut questions)
    }

    fn asked(args: &InitArgs, questions: &mut Questions<'_>) -> anyhow::Result<Self> {
        let given = args.stations.map(|count| count.to_string());
        let stations = questions.ask("Number of stations", given, "1")?;
        let Some(stations) = stations
            .parse()
            .ok()
            .filter(|count| (1..=64).contains(count))
        else {
            bail!(
                "the number of stations is `{}`, expected 1 to 64",
                stations.escape_debug()
            );
        };
        let exercise = questions.ask(
            "Exercise (bimanual, crown, probing, retraction, free)",
            args.exercise.clone(),
            EXERCISE,
        )?;
        let given = args.hours.map(|hours| hours.to_string());
        let hours = questions.ask("Planned hours of each station", given, &HOURS.to_string())?;
        let Some(hours) = hours.parse().ok().filter(|h: &f64| (0.1..=1e4).contains(h)) else {
            bail!(
                "the planned hours are `{}`, expected 0.1 to 10000",
                hours.escape_debug()
            );
        };
        let class = questions.ask(
            "Name of the first class, or nothing",
            args.class.clone(),
            "",
        )?;
        let class = match class.trim() {
            "" => String::new(),
            name => class_name(name)?.to_owned(),
        };
        let listen = questions.ask("UDP address of the stations", args.listen.clone(), LISTEN)?;
        let recordings = match &args.recordings {
            Some(folder) => folder.to_str().map(str::to_owned),
            None => Some("recordings".into()),
        };
        let Some(recordings) = recordings else {
            bail!("--recordings is a path that is no text, and no file of stations can name it");
        };
        Ok(Self {
            listen,
            stations,
            exercise,
            hours,
            class,
            recordings,
        })
    }

    /// File of stations.
    pub fn text(&self) -> String {
        let quoted = |text: &str| toml::Value::from(text).to_string();
        let mut text = format!(
            "# Stations of this server, for `sulcus-server serve --config`. `sulcus-server serve --help` has the parts of a plan.\n\
             listen = {}\n\
             recordings = {}\n\
             # Most gigabytes of that folder: no session begins that would exceed it.\n\
             # recordings_quota_gb = 500\n\
             # Recordings of half the size; `sulcus-sessions viewers` makes the channels for viewers again.\n\
             # viewers = \"on-demand\"\n\n\
             [class]\n\
             # Planned hours of each station, for the check of the disk.\n\
             hours = {}\n\n\
             [defaults]\n\
             exercise = {}\n",
            quoted(&self.listen),
            quoted(&self.recordings),
            toml::Value::from(self.hours),
            quoted(&self.exercise),
        );
        for k in 1..=self.stations {
            text.push_str(&format!("\n[[station]]\nname = \"station-{k}\"\n"));
        }
        text
    }
}

/// Questions at a terminal; without one, no question is asked.
struct Questions<'a> {
    lines: Option<&'a mut dyn BufRead>,
    out: &'a mut dyn Write,
}

impl Questions<'_> {
    /// Answer to a question: the value given, else that of the person, else the default.
    fn ask(
        &mut self,
        question: &str,
        given: Option<String>,
        default: &str,
    ) -> anyhow::Result<String> {
        if let Some(given) = given {
            return Ok(given);
        }
        let Some(lines) = &mut self.lines else {
            return Ok(default.to_owned());
        };
        let shown = if default.is_empty() { "none" } else { default };
        write!(self.out, "{question} [{shown}]: ")?;
        self.out.flush()?;
        let mut line = String::new();
        if lines.read_line(&mut line)? == 0 {
            bail!("the questions ended without an answer to `{question}`; nothing was made");
        }
        Ok(match line.trim() {
            "" => default.to_owned(),
            answer => answer.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use clap::Parser;

    use super::*;
    use crate::plan::StationsFile;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        init: InitArgs,
    }

    fn asked(arguments: &[&str], answers: Option<&str>) -> (anyhow::Result<Wanted>, String) {
        let cli = Cli::try_parse_from([&["init"], arguments].concat()).expect("arguments");
        let mut lines = answers.unwrap_or_default().as_bytes();
        let mut out = Vec::new();
        let mut questions = Questions {
            lines: answers.is_some().then_some(&mut lines as &mut dyn BufRead),
            out: &mut out,
        };
        let wanted = Wanted::asked(&cli.init, &mut questions);
        (wanted, String::from_utf8(out).expect("text"))
    }

    #[test]
    fn a_person_is_asked_for_what_no_option_gives() {
        let (wanted, said) = asked(&["--exercise", "crown"], Some("12\n\nYear 4\n\n"));
        let wanted = wanted.expect("valid");
        assert_eq!((wanted.stations, wanted.hours), (12, HOURS));
        assert_eq!(
            (wanted.exercise.as_str(), wanted.class.as_str()),
            ("crown", "Year 4")
        );
        assert_eq!(said.matches(": ").count(), 4, "{said}");
        assert!(!said.contains("Exercise"), "{said}");
        let (cut, _) = asked(&[], Some("12\n"));
        assert!(
            cut.expect_err("no answer")
                .to_string()
                .contains("nothing was made")
        );
    }

    #[test]
    fn without_a_terminal_the_defaults_hold_and_the_text_is_a_file_of_stations() {
        let (wanted, said) = asked(&["--stations", "3", "--class", "a \"b\""], None);
        let wanted = wanted.expect("valid");
        assert_eq!(said, "");
        let file =
            StationsFile::parse(&wanted.text(), Path::new("/srv/stations.toml")).expect("valid");
        assert_eq!(file.stations.len(), 3);
        assert_eq!(file.stations[2].name, "station-3");
        assert_eq!(file.listen.as_deref(), Some(LISTEN));
        assert_eq!(
            file.recordings.as_deref(),
            Some(Path::new("/srv/recordings"))
        );
        assert_eq!(file.hours, HOURS);
    }

    #[test]
    fn values_out_of_range_are_named() {
        for (arguments, answers, words) in [
            (&["--hours", "0"][..], None, "planned hours are `0`"),
            (&["--hours", "NaN"], None, "planned hours are `NaN`"),
            (&[], Some("65\n"), "stations is `65`"),
            (&["--class", "a\nb"], None, "class"),
        ] {
            let error = asked(arguments, answers).0.expect_err(words).to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
