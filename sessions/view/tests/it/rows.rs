//! Content of a file for the viewer, read back.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use rerun::StoreKind;
use rerun::external::re_log_encoding::rrd::DecoderApp;
use rerun::log::{Chunk, LogMsg};

/// Rows of one entity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// Rows with a time.
    pub timed: u64,
    /// Rows without a time.
    pub constant: u64,
    /// Chunks of the rows.
    pub chunks: u64,
}

/// Decodes a file from end to end. Counts the rows of every entity of its recordings, and its complete blueprints. The
/// viewer's own check does not decode columns.
pub fn count_rows(file: &Path) -> Result<(BTreeMap<String, Rows>, u64), Box<dyn Error>> {
    let reader = BufReader::new(File::open(file)?);
    let mut rows: BTreeMap<String, Rows> = BTreeMap::new();
    let mut blueprints = 0;
    for message in DecoderApp::decode_lazy(reader) {
        match message? {
            LogMsg::ArrowMsg(store, message) if store.kind() == StoreKind::Recording => {
                let chunk = Chunk::from_arrow_msg(&message)?;
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
