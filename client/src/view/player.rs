//! Sounds of contact, played by a program of the system.
//!
//! The program is `paplay` of PulseAudio, which PipeWire serves as well, else `aplay` of ALSA. A program needs no
//! headers in the build, unlike a library of sound. A thread starts the program for each sound; the window never waits.
//! Without a program, or after its first failure, one sentence is told and no sound is played.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{SyncSender, sync_channel};

use sulcus_program::{PathText, tell};
use sulcus_proto::TOOLS;
use sulcus_proto::display::DisplayScene;
use sulcus_screen::moment::Moment;
use sulcus_screen::sound::Ears;

use super::programs::{Row, find};

/// Programs that play samples from their standard input: 16 bits, little-endian, one channel, 44,100 in a second.
const PROGRAMS: [Row; 2] = [
    (
        "paplay",
        &[
            "--raw",
            "--rate=44100",
            "--format=s16le",
            "--channels=1",
            "--latency-msec=20",
        ],
    ),
    (
        "aplay",
        &["-q", "-t", "raw", "-f", "S16_LE", "-r", "44100", "-c", "1"],
    ),
];

/// Player with an ear for each tool.
pub struct Player {
    ears: Ears,
    to: SyncSender<Vec<i16>>,
}

impl Player {
    /// Player by the first program that the folders of `PATH` hold.
    ///
    /// # Errors
    /// There is no such program, or no thread for it. The error is a sentence.
    pub fn begin() -> Result<Self, String> {
        let found = find(&PROGRAMS);
        let (program, options) =
            found.ok_or("neither `paplay` nor `aplay` is installed; contacts are silent")?;
        Self::by(program, options)
    }

    fn by(program: PathBuf, options: &'static [&'static str]) -> Result<Self, String> {
        let (to, sounds) = sync_channel::<Vec<i16>>(1);
        std::thread::Builder::new()
            .name("sulcus-sound".into())
            .spawn(move || {
                for sound in sounds {
                    if let Err(why) = play(&program, options, &sound) {
                        tell!("warning: the sound ends: {}: {why}", program.shown());
                        return;
                    }
                }
            })
            .map_err(|error| format!("no thread for the sound: {error}"))?;
        Ok(Self {
            ears: Ears::default(),
            to,
        })
    }

    /// Takes a picture: its time, seconds, and the force of each tool, newtons. The function never waits.
    pub fn follow(
        &mut self,
        now_s: f64,
        scene: &DisplayScene,
        moment: &Moment,
        forces: [f64; TOOLS],
    ) {
        for sound in self.ears.hear(now_s, scene, moment, forces) {
            // A busy player leaves a sound out: a late sound would be wrong.
            let _ = self.to.try_send(sound);
        }
    }
}

/// Plays a sound to its end.
fn play(program: &Path, options: &[&str], sound: &[i16]) -> Result<(), String> {
    let mut child = Command::new(program)
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| error.to_string())?;
    let bytes: Vec<u8> = sound
        .iter()
        .flat_map(|sample| sample.to_le_bytes())
        .collect();
    // The exit status tells more than a broken pipe.
    let written = child.stdin.take().map(|mut to| to.write_all(&bytes));
    let ended = child.wait().map_err(|error| error.to_string())?;
    match written {
        _ if !ended.success() => Err(ended.to_string()),
        Some(Err(error)) => Err(error.to_string()),
        _ => Ok(()),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::sync::mpsc::TrySendError;
    use std::time::{Duration, Instant};

    /// Player by a line of shell.
    fn player(line: &str) -> Player {
        let line: &'static str = line.to_owned().leak();
        Player::by("sh".into(), vec!["-c", line].leak()).expect("a player")
    }

    fn waits_for(met: impl Fn() -> bool) {
        let begin = Instant::now();
        while !met() {
            assert!(begin.elapsed() < Duration::from_secs(120), "too long");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    #[test]
    fn all_samples_reach_the_program_in_their_order() {
        let folder = tempfile::tempdir().expect("folder");
        let heard = folder.path().join("heard");
        let player = player(&format!("cat > '{}'", heard.display()));
        player.to.try_send(vec![1, -2, 300]).expect("a free player");
        let bytes = [1, 0, 0xfe, 0xff, 0x2c, 0x01];
        waits_for(|| std::fs::read(&heard).is_ok_and(|heard| heard == bytes));
    }

    #[test]
    fn a_program_that_fails_ends_the_sound() {
        let player = player("exit 1");
        player.to.try_send(vec![1; 9]).expect("a free player");
        waits_for(|| {
            let sent = player.to.try_send(vec![1]);
            matches!(sent, Err(TrySendError::Disconnected(_)))
        });
    }
}
