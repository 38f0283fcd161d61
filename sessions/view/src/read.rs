//! What a file for the viewer holds, as its reader finds it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use rerun::StoreKind;
use rerun::external::re_log_encoding::rrd::DecoderApp;
use rerun::log::{Chunk, LogMsg};

use crate::ViewError;

/// Rows of one entity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// Rows that have a time.
    pub timed: u64,
    /// Rows that hold always.
    pub constant: u64,
    /// Chunks in which they come.
    pub chunks: u64,
}

/// Decodes a file from end to end and counts the rows of every entity of its recordings, and its complete blueprints. (The
/// viewer's own check of a file passes although a column cannot be decoded.)
///
/// # Errors
/// When the file cannot be read or any of its messages does not decode.
pub fn count_rows(file: &Path) -> Result<(BTreeMap<String, Rows>, u64), ViewError> {
    let unread = |source: crate::Refusal| ViewError::Read {
        file: file.to_owned(),
        source,
    };
    let reader = BufReader::new(File::open(file).map_err(|error| unread(error.into()))?);
    let mut rows: BTreeMap<String, Rows> = BTreeMap::new();
    let mut blueprints = 0;
    for message in DecoderApp::decode_lazy(reader) {
        match message.map_err(|error| unread(error.into()))? {
            LogMsg::ArrowMsg(store, message) if store.kind() == StoreKind::Recording => {
                let chunk =
                    Chunk::from_arrow_msg(&message).map_err(|error| unread(error.into()))?;
                let of = rows.entry(chunk.entity_path().to_string()).or_default();
                let count = if chunk.is_static() {
                    &mut of.constant
                } else {
                    &mut of.timed
                };
                *count += chunk.num_rows() as u64;
                of.chunks += 1;
            }
            LogMsg::BlueprintActivationCommand(_) => blueprints += 1,
            _ => {}
        }
    }
    Ok((rows, blueprints))
}
