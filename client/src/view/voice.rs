//! Voice of the tour: a program of the system speaks the next step.
//!
//! The program is `espeak-ng`, else `spd-say` of Speech Dispatcher. A thread starts the program for each text and waits
//! for its end. The window never waits. A failure is told once, and ends the voice.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::time::{Duration, Instant};

use sulcus_program::{PathText, tell};

use super::programs::{Row, find};

/// Programs that speak, with the options before the text.
const PROGRAMS: [Row; 2] = [
    ("espeak-ng", &["-v", "en", "--"]),
    ("spd-say", &["--wait", "--language", "en", "--"]),
];
/// Time for which a text must stand before it is spoken. Chosen: a hand that trembles about a limit changes the text
/// several times in a second.
const STANDS: Duration = Duration::from_millis(700);

/// Voice.
pub struct Voice {
    pace: Pace,
    to: SyncSender<String>,
}

impl Voice {
    /// Voice by the first program that the folders of `PATH` hold.
    ///
    /// # Errors
    /// There is no such program, or no thread for it. The error is a sentence.
    pub fn begin() -> Result<Self, String> {
        let found = find(&PROGRAMS);
        let (program, options) = found
            .ok_or("neither `espeak-ng` nor `spd-say` is installed; sentences are only shown")?;
        Self::by(program, options)
    }

    fn by(program: PathBuf, options: &'static [&'static str]) -> Result<Self, String> {
        let (to, texts) = sync_channel::<String>(1);
        std::thread::Builder::new()
            .name("sulcus-voice".into())
            .spawn(move || {
                for text in texts {
                    if let Err(why) = speak(&program, options, &text) {
                        tell!("warning: the voice ends: {}: {why}", program.shown());
                        return;
                    }
                }
            })
            .map_err(|error| format!("no thread for the voice: {error}"))?;
        Ok(Self {
            pace: Pace::default(),
            to,
        })
    }

    /// Takes the present text, once for each picture. The function never waits.
    pub fn follow(&mut self, text: Option<&str>, now: Instant) {
        let Some(text) = self.pace.due(text, now) else {
            return;
        };
        // A busy voice gets the newest text later.
        if !matches!(self.to.try_send(text.clone()), Err(TrySendError::Full(_))) {
            self.pace.spoken = Some(text);
        }
    }
}

fn speak(program: &Path, options: &[&str], text: &str) -> Result<(), String> {
    let ended = Command::new(program)
        .args(options)
        .arg(text)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map_err(|error| error.to_string())?;
    if ended.success() {
        Ok(())
    } else {
        Err(ended.to_string())
    }
}

/// Pace of a voice: a text is due when it has stood for a while, once until another text is spoken.
#[derive(Debug, Default)]
struct Pace {
    stands: Option<(String, Instant)>,
    spoken: Option<String>,
}

impl Pace {
    fn due(&mut self, text: Option<&str>, now: Instant) -> Option<String> {
        let Some(text) = text else {
            self.stands = None;
            return None;
        };
        match &self.stands {
            Some((stands, since)) if stands == text => {
                let is_due = now.saturating_duration_since(*since) >= STANDS;
                let is_new = self.spoken.as_deref() != Some(text);
                (is_due && is_new).then(|| text.to_owned())
            }
            _ => {
                self.stands = Some((text.to_owned(), now));
                None
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// Voice by a line of shell; the text is `$1`.
    fn voice(line: &str) -> Voice {
        let line: &'static str = line.to_owned().leak();
        Voice::by("sh".into(), vec!["-c", line, "sh"].leak()).expect("a voice")
    }

    fn waits_for(mut met: impl FnMut() -> bool) {
        let begin = Instant::now();
        while !met() {
            assert!(begin.elapsed() < Duration::from_secs(120), "too long");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    #[test]
    fn a_text_that_stands_is_spoken_once() {
        let (mut pace, begin) = (Pace::default(), Instant::now());
        let at = |ms| begin + Duration::from_millis(ms);
        for (text, ms, is_due) in [
            ("a", 0, false),
            ("a", 699, false),
            ("b", 700, false),
            ("a", 800, false),
            ("a", 1400, false),
            ("a", 1500, true),
            ("a", 2000, false),
            ("b", 2100, false),
            ("b", 2900, true),
            ("a", 3000, false),
            ("a", 3800, true),
        ] {
            let due = pace.due(Some(text), at(ms));
            assert_eq!(due.is_some(), is_due, "{text} {ms}");
            pace.spoken = due.or(pace.spoken.take());
        }
        assert_eq!(pace.due(None, at(9000)), None);
    }

    #[test]
    fn texts_reach_the_program_and_a_slow_one_delays_nobody() {
        let folder = tempfile::tempdir().expect("folder");
        let [said, begun, gate] = ["said", "begun", "gate"].map(|name| folder.path().join(name));
        // The program waits for the gate, at the longest two minutes: a window that waits for it finds a failed voice.
        let line = format!(
            "touch '{}'; n=0; until [ -e '{}' ]; do n=$((n + 1)); [ $n -lt 1200 ] || exit 1; sleep 0.1; done; \
             echo \"$1\" >> '{}'",
            begun.display(),
            gate.display(),
            said.display()
        );
        let mut voice = voice(&line);
        let begin = Instant::now();
        let at = |ms| begin + Duration::from_millis(ms);
        voice.follow(Some("Read the band."), at(0));
        voice.follow(Some("Read the band."), at(800));
        waits_for(|| begun.exists());
        // One text waits for the program, and a further one finds the voice busy.
        voice.follow(Some("Press a little more."), at(2000));
        voice.follow(Some("Press a little more."), at(2800));
        voice.follow(Some("Ease off."), at(2900));
        voice.follow(Some("Ease off."), at(3700));
        let waiting = voice.pace.spoken.as_deref();
        assert_eq!(waiting, Some("Press a little more."));
        let read = || std::fs::read_to_string(&said).unwrap_or_default();
        assert_eq!(read(), "", "the window waited");
        std::fs::write(&gate, "").expect("a gate");
        // A text that finds the voice busy comes with a later picture.
        waits_for(|| {
            voice.follow(Some("Ease off."), at(3800));
            read() == "Read the band.\nPress a little more.\nEase off.\n"
        });
    }

    #[test]
    fn a_program_that_fails_ends_the_voice() {
        let mut voice = voice("exit 3");
        let begin = Instant::now();
        voice.follow(Some("a"), begin);
        voice.follow(Some("a"), begin + STANDS);
        // The thread of an ended voice takes no text, and following is still harmless.
        waits_for(|| {
            matches!(
                voice.to.try_send(String::new()),
                Err(TrySendError::Disconnected(_))
            )
        });
        voice.follow(Some("b"), begin);
        voice.follow(Some("b"), begin + STANDS);
        assert_eq!(voice.pace.spoken.as_deref(), Some("b"));
    }
}
