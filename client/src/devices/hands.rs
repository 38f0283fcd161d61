//! Hands of a session by the arguments of `run`: simulated operator, screen, recording, or haptic devices.

use std::path::Path;

use anyhow::bail;
use sulcus_demo::seat::{self, Seat};

use super::choose::{Named, PLAYBACK};
use super::opened::{self, Opened};
use super::recorded::{self, Recorded};
use super::settings::Hand;
use super::stored;
use crate::cli::RunArgs;

/// Hands of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Hands {
    /// Simulated operator, or a person at the screen of the seat.
    InStep,
    /// Hands of a recording.
    Playback(String),
    /// Haptic devices.
    Devices(Vec<Named>),
}

impl Hands {
    /// Hands that the arguments name.
    ///
    /// # Errors
    /// The arguments name kinds of hands that exclude each other.
    pub fn of(args: &RunArgs, seat: Seat<'_>) -> anyhow::Result<Self> {
        let is_simulated = |named: &Named| named.name == "simulated";
        if args.device.iter().all(is_simulated) {
            return Ok(Self::InStep);
        }
        if let Some(name) = seat.and_then(|screen| screen.device) {
            bail!("--device and --{name} both move the tools, expected one of them");
        }
        let of_recording = |named: &Named| named.name.starts_with(PLAYBACK);
        match args.device.as_slice() {
            [one] if of_recording(one) => Ok(Self::Playback(one.name[PLAYBACK.len()..].to_owned())),
            several
                if several
                    .iter()
                    .any(|named| is_simulated(named) || of_recording(named)) =>
            {
                bail!(
                    "`simulated` and `playback` move both hands, expected no other --device beside them"
                )
            }
            several => Ok(Self::Devices(several.to_vec())),
        }
    }

    /// Name of hands that need no opened device, for the server's log.
    pub fn name(&self, seat: Seat<'_>) -> &'static str {
        match self {
            Self::InStep => seat::device(seat),
            Self::Playback(_) => recorded::NAME,
            Self::Devices(_) => "device",
        }
    }

    /// Opens devices or recording. `probe` is the hand that holds the first tool.
    ///
    /// # Errors
    /// A device cannot be opened, or the recording cannot be read.
    pub fn open(&self, probe: Hand) -> anyhow::Result<(Option<Opened>, Option<Recorded>)> {
        Ok(match self {
            Self::InStep => (None, None),
            Self::Playback(file) => (None, Some(Recorded::read(Path::new(file))?)),
            Self::Devices(named) => (Some(opened::open(named, &stored()?.0, probe)?), None),
        })
    }
}
