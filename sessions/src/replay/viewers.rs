//! Channels for viewers, made again by a replay of the exact record, byte for byte as a live recording holds them.
//!
//! A replay has the output of every tick and the shapes after it, so almost every message follows from the exact rows
//! and events. Two values do not: the CPU time of the longest tick, and whether the shapes of a due tick reached the
//! recorder, which drops them if it is late. Both are in the messages of one channel, which every recording keeps
//! ([`crate::ViewersPolicy`]). The making takes both values from there, and compares all other values of these
//! messages with the replay.
//!
//! At the end the hash over all made messages is compared with the signed one. The station computed the signed hash
//! from the messages of the live session, whether or not it wrote them.
//!
//! # The made file
//! The exact messages are copied with their bytes, times and order, and so are header, attachments and metadata. Chain
//! and signatures cover these alone, so they stay valid. The file itself is another one with another BLAKE3: a
//! recording that continues the session, and a register of grades, name the original. Keep the original as evidence.

mod error;
mod make;

use std::fs::OpenOptions;
use std::path::Path;

use serde::Serialize;
use sulcus_program::PathText;

use crate::record::header::FORMAT_VERSION;
use crate::record::policy::ViewersPolicy;
use crate::record::read::{Ending, Recording};
use crate::record::recorder::Extent;
use crate::record::signature::Signature;
use crate::record::storage::{FileStorage, Storage};
use crate::record::verify::verify;
use crate::record::viewers::Viewers;

pub use error::ViewersError;

use make::make;

/// Result of making the channels for viewers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Made {
    /// Name of the new file; `None` if the channels were only compared.
    pub out: Option<String>,
    /// Length of the new file, bytes.
    pub bytes: Option<u64>,
    /// Ticks of the replay.
    pub ticks: u64,
    /// Messages of the channels for viewers.
    pub messages: u64,
}

/// Makes the channels of a recording with the policy `on-demand`, and writes exact record and channels to a new file at
/// `out`. `progress` gets the number of finished ticks.
///
/// # Errors
/// The recording has the channels, is not whole, or its signature is invalid; the replay differs; the made channels
/// differ from the signed hash; the file exists or cannot be written. No new file is left then.
pub fn with_viewers(
    recording: &Recording,
    out: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<Made, ViewersError> {
    let found = whole(recording)?;
    if recording.header().viewers == ViewersPolicy::Recorded || found == Viewers::AsSigned {
        return Err(ViewersError::There);
    }
    let failed = |source: std::io::Error| ViewersError::Write {
        path: out.to_owned(),
        source,
    };
    let file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(out)
        .map_err(failed)?;
    let made = FileStorage::new(file).map_err(failed).and_then(|storage| {
        let made = make(recording, Box::new(storage), Extent::All, progress)?;
        // The file is read again from the disk.
        match whole(&Recording::open(out)?)? {
            Viewers::AsSigned => Ok(made),
            _ => Err(ViewersError::Changed),
        }
    });
    let made = made.inspect_err(|_| {
        // An incomplete file has no use.
        let _ = std::fs::remove_file(out);
    })?;
    Ok(Made {
        out: Some(out.shown().to_string()),
        ..made
    })
}

/// Makes the channels in memory, compares them with the signed hash, and writes nothing. The recording may have the
/// channels or not.
///
/// # Errors
/// The recording is not whole, or its signature is invalid; the replay differs; the made channels differ from the
/// signed hash.
pub fn compare_viewers(
    recording: &Recording,
    progress: &mut dyn FnMut(u64),
) -> Result<Made, ViewersError> {
    whole(recording)?;
    let made = make(recording, Box::new(Nowhere), Extent::Policy, progress)?;
    Ok(Made {
        bytes: None,
        ..made
    })
}

/// Checks that a recording is finished, signed and of the present format; state of its channels for viewers.
fn whole(recording: &Recording) -> Result<Viewers, ViewersError> {
    if *recording.ending() != Ending::Finished {
        return Err(ViewersError::NotWhole(recording.ending().clone()));
    }
    if recording.format().to_string() != FORMAT_VERSION {
        return Err(ViewersError::Former(recording.format()));
    }
    let signature = verify(recording, None)?.signature;
    if let Signature::Invalid { reason, .. } = signature {
        return Err(ViewersError::Signature(reason));
    }
    match recording.viewers_by(&signature) {
        Viewers::Changed => Err(ViewersError::Changed),
        Viewers::NotSigned => Err(ViewersError::NotSigned),
        found if recording.facts().damaged_views == 0 => Ok(found),
        _ => Err(ViewersError::Changed),
    }
}

/// Storage that keeps nothing, for a comparison.
struct Nowhere;

impl Storage for Nowhere {
    fn append(&mut self, _: &[u8]) -> std::io::Result<()> {
        Ok(())
    }

    fn truncate(&mut self, _: u64) -> std::io::Result<()> {
        Ok(())
    }

    fn request_sync(&mut self) -> std::io::Result<()> {
        Ok(())
    }

    fn sync(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
