//! The beginning of the file: everything that comes before the first message.

use std::collections::BTreeMap;

use foxglove::messages::Log;
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, WriteOptions};
use sulcus_program::disk;

use crate::record::channels;
use crate::record::channels::Schema;
use crate::record::format::Layout;
use crate::record::header;
use crate::record::header::SessionHeader;
use crate::record::message::Topic;
use crate::record::storage::{Sink, Storage};
use crate::record::viewers::Summing;

/// mcap's own text for an I/O error does not say which.
pub(crate) fn reason(error: &mcap::McapError) -> String {
    match error {
        mcap::McapError::Io(source) => format!("{source}{}", disk::advice(source)),
        other => other.to_string(),
    }
}

/// A file whose header is written.
pub(super) struct Begun {
    pub writer: mcap::Writer<NoSeek<Sink>>,
    /// Channels of what is exact.
    pub ids: [u16; Topic::ALL.len()],
    /// Channel of the log for viewers.
    pub log: u16,
    /// Which knows that one.
    pub viewed: Summing,
}

/// Header, attachments, metadata and channels, flushed.
pub(super) fn begin(
    storage: Box<dyn Storage>,
    header: &SessionHeader,
    metadata: BTreeMap<String, String>,
) -> mcap::McapResult<Begun> {
    let mut writer = WriteOptions::new()
        .library(format!("sulcus {}", header.program_version))
        // Of two hands' exact rows zstd leaves 81 % of what lz4 leaves, for a few microseconds a tick. No threads of its own.
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        .compression_threads(0)
        .chunk_size(Some(256 << 10))
        // Chunks are appended whole: whatever ends the program, the file is a clean prefix.
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
        metadata,
    })?;
    let mut ids = [0; Topic::ALL.len()];
    for topic in Topic::ALL {
        let schema = topic.schema();
        let encoding = topic.encoding(Layout::Protobuf);
        let schema_id = writer.add_schema(schema.name, encoding, schema.data)?;
        ids[topic as usize] =
            writer.add_channel(schema_id, topic.name(), encoding, &BTreeMap::new())?;
    }
    let mut viewed = Summing::default();
    let schema = channels::schema_of::<Log>("foxglove.Log");
    let log = view_channel(&mut writer, &mut viewed, channels::LOG, &schema)?;
    writer.flush()?;
    Ok(Begun {
        writer,
        ids,
        log,
        viewed,
    })
}

/// Declares a channel of protobuf messages for viewers, in the file and to the sum over what they read.
pub(super) fn view_channel(
    writer: &mut mcap::Writer<NoSeek<Sink>>,
    viewed: &mut Summing,
    topic: &str,
    schema: &Schema,
) -> mcap::McapResult<u16> {
    let encoding = "protobuf";
    let schema_id = writer.add_schema(schema.name, encoding, schema.data)?;
    let id = writer.add_channel(schema_id, topic, encoding, &BTreeMap::new())?;
    viewed.schema(schema_id, schema.name, encoding, schema.data);
    viewed.channel(id, schema_id, topic, encoding);
    Ok(id)
}
