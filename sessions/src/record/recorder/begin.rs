//! Beginning of the file: everything before the first message.

use std::collections::BTreeMap;

use foxglove::messages::Log;
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, WriteOptions};

use super::output::{Mcap, declare};
use super::viewers::Views;
use crate::record::channels::foxglove_types::schema_of;
use crate::record::channels::topics;
use crate::record::format::Layout;
use crate::record::header;
use crate::record::header::SessionHeader;
use crate::record::message::Topic;
use crate::record::storage::{Sink, Storage};

/// Header of a file.
pub(crate) struct Head<'a> {
    /// Constant data of the session.
    pub header: &'a SessionHeader,
    /// Pairs of the metadata record.
    pub metadata: BTreeMap<String, String>,
}

/// A file whose header is written.
pub(super) struct Begun {
    pub writer: Mcap,
    /// Numbers of the exact channels.
    pub ids: [u16; Topic::ALL.len()],
    /// Number of the channel of the log for viewers.
    pub log: u16,
    /// Channels for viewers, with the log declared.
    pub views: Views,
}

/// Writes header, attachments, metadata and channels, and flushes them.
pub(super) fn begin(
    storage: Box<dyn Storage>,
    head: &Head,
    mut views: Views,
) -> mcap::McapResult<Begun> {
    let header = head.header;
    let mut writer = WriteOptions::new()
        .library(format!("sulcus {}", header.program_version))
        // Measured on the exact rows of two hands: zstd leaves 81 % of the size that lz4 leaves, for a few microseconds
        // a tick. Zstd gets no threads of its own.
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        .compression_threads(0)
        .chunk_size(Some(256 << 10))
        // Chunks are appended whole, so the file is a clean prefix however the program ends.
        .disable_seeking(true)
        .create(NoSeek::new(Sink::new(storage)))?;
    for (name, bytes) in header.attachments() {
        writer.attach(&Attachment {
            log_time: header.started_unix_ns,
            create_time: header.started_unix_ns,
            name: name.to_owned(),
            media_type: if name == header::SCENE {
                "application/octet-stream"
            } else {
                "text/plain"
            }
            .to_owned(),
            data: bytes.into(),
        })?;
    }
    writer.write_metadata(&mcap::records::Metadata {
        name: header::METADATA.to_owned(),
        metadata: head.metadata.clone(),
    })?;
    let mut ids = [0; Topic::ALL.len()];
    for topic in Topic::ALL {
        let encoding = topic.encoding(Layout::Protobuf);
        let (_, id) = declare(&mut writer, topic.name(), encoding, &topic.schema())?;
        ids[topic as usize] = id;
    }
    let schema = schema_of::<Log>("foxglove.Log");
    let log = views.declare(&mut writer, topics::LOG, &schema)?;
    writer.flush()?;
    Ok(Begun {
        writer,
        ids,
        log,
        views,
    })
}
