//! Protobuf schemas of channels. `build.rs` compiles those of `sulcus.v1` from `proto/sulcus/v1`.

/// Protobuf schema of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Schema {
    /// Full name of the message.
    pub name: &'static str,
    /// `FileDescriptorSet` with all imports.
    pub data: &'static [u8],
}

/// Schema of the message `sulcus.v1.NAME` in `proto/sulcus/v1/FILE.proto`.
macro_rules! schema {
    ($name:literal, $file:literal) => {
        Schema {
            name: concat!("sulcus.v1.", $name),
            data: include_bytes!(concat!(env!("OUT_DIR"), "/", $file, ".bin")),
        }
    };
}

/// Schemas of the exact channels.
pub(crate) mod exact {
    use super::Schema;

    pub(crate) const ROW: Schema = schema!("ExactRow", "exact_row");
    pub(crate) const STATE: Schema = schema!("ExactState", "exact_state");
    pub(crate) const STATEMENT: Schema = schema!("ExactStatement", "exact_statement");
    pub(crate) const EVENT: Schema = schema!("ExactEvent", "exact_event");
}

/// Schemas of the channels for viewers that have no type of Foxglove.
pub(crate) mod view {
    use super::Schema;

    pub(crate) const WRENCH: Schema = schema!("Wrench", "wrench");
    pub(crate) const CONTACTS: Schema = schema!("Contacts", "contacts");
    pub(crate) const TOOL_METRICS: Schema = schema!("ToolMetrics", "tool_metrics");
    pub(crate) const SESSION_METRICS: Schema = schema!("SessionMetrics", "session_metrics");
}
