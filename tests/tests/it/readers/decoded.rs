//! A recording through Foxglove's own reader crate and types: what the other readers are compared with.

use std::collections::BTreeMap;
use std::path::Path;

use foxglove::Decode;
use foxglove::messages::{FrameTransforms, Log, PointCloud, PoseInFrame};
use prost::Message as _;
use sulcus_sessions::record::channels::v1;

/// A channel's messages, decoded.
#[derive(Debug, Default)]
pub struct Channel {
    pub schema: String,
    pub times_ns: Vec<u64>,
    /// Number of messages by content: points, transforms, contacts; wrenches with a force; bytes of the exact record.
    pub inner: u64,
    pub clouds: Vec<PointCloud>,
    pub poses: Vec<PoseInFrame>,
    pub wrenches: Vec<v1::Wrench>,
    pub contacts: Vec<v1::Contacts>,
    pub tools: Vec<v1::ToolMetrics>,
    pub lines: Vec<Log>,
    /// Frames that were named as children.
    pub frames: Vec<String>,
}

/// Every channel, each of protobuf messages. Panics at a message that is not of its schema, or has a field that its type has not.
pub fn decoded(path: &Path) -> BTreeMap<String, Channel> {
    let bytes = std::fs::read(path).expect("the recording is there");
    let mut channels: BTreeMap<String, Channel> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).expect("an MCAP file") {
        let message = message.expect("a sound message");
        assert_eq!(message.channel.message_encoding, "protobuf");
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert_eq!(schema.encoding, "protobuf");
        let of = channels.entry(message.channel.topic.clone()).or_default();
        of.schema.clone_from(&schema.name);
        of.times_ns.push(message.log_time);
        let data = &message.data[..];
        match schema.name.as_str() {
            "foxglove.PointCloud" => {
                let cloud = <PointCloud as Decode>::decode(data).expect("a cloud");
                of.inner += cloud.data.len() as u64 / u64::from(cloud.point_stride);
                of.clouds.push(cloud);
            }
            "foxglove.PoseInFrame" => of
                .poses
                .push(<PoseInFrame as Decode>::decode(data).expect("a pose")),
            "foxglove.FrameTransforms" => {
                let frames = <FrameTransforms as Decode>::decode(data).expect("frames");
                of.inner += frames.transforms.len() as u64;
                let children = frames.transforms.into_iter().map(|of| of.child_frame_id);
                of.frames.extend(children);
            }
            "foxglove.Log" => of
                .lines
                .push(<Log as Decode>::decode(data).expect("a line")),
            "sulcus.v1.Wrench" => {
                let wrench = v1::Wrench::decode(data).expect("a wrench");
                of.inner += u64::from(wrench.peak_force_n > 0.0);
                of.wrenches.push(wrench);
            }
            "sulcus.v1.Contacts" => {
                let contacts = v1::Contacts::decode(data).expect("contacts");
                of.inner += contacts.contacts.len() as u64;
                of.contacts.push(contacts);
            }
            "sulcus.v1.ToolMetrics" => of
                .tools
                .push(v1::ToolMetrics::decode(data).expect("metrics of a tool")),
            "sulcus.v1.SessionMetrics" => {
                v1::SessionMetrics::decode(data).expect("metrics");
            }
            "sulcus.v1.ExactRow" => {
                of.inner += v1::ExactRow::decode(data).expect("a row").row.len() as u64;
            }
            "sulcus.v1.ExactState" => {
                of.inner += v1::ExactState::decode(data).expect("a state").state.len() as u64;
            }
            "sulcus.v1.ExactStatement" => {
                let statement = v1::ExactStatement::decode(data).expect("a statement");
                of.inner += statement.statement.len() as u64;
            }
            "sulcus.v1.ExactEvent" => {
                of.inner += v1::ExactEvent::decode(data).expect("an event").event.len() as u64;
            }
            other => panic!(
                "{}: {other} is a type that nobody knows",
                message.channel.topic
            ),
        }
    }
    channels
}
