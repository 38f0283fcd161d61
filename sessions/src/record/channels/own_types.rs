//! The messages of `sulcus.v1`, as the build made them of `proto/`, and their schemas.

use super::foxglove_types::Schema;

/// Messages for which Foxglove has no type; units stand in the names of the fields.
#[allow(missing_docs, clippy::all)]
pub mod v1 {
    include!(concat!(env!("OUT_DIR"), "/sulcus.v1.rs"));
}

macro_rules! schema {
    ($name:literal, $file:literal) => {
        Schema {
            name: concat!("sulcus.v1.", $name),
            data: include_bytes!(concat!(env!("OUT_DIR"), "/", $file, ".bin")),
        }
    };
}

pub(super) const WRENCH: Schema = schema!("Wrench", "wrench");
pub(super) const CONTACTS: Schema = schema!("Contacts", "contacts");
pub(super) const TOOL_METRICS: Schema = schema!("ToolMetrics", "tool_metrics");
pub(super) const SESSION_METRICS: Schema = schema!("SessionMetrics", "session_metrics");

/// Schemas of the exact channels.
pub(crate) mod exact {
    use super::Schema;

    pub(crate) const ROW: Schema = schema!("ExactRow", "exact_row");
    pub(crate) const STATE: Schema = schema!("ExactState", "exact_state");
    pub(crate) const STATEMENT: Schema = schema!("ExactStatement", "exact_statement");
    pub(crate) const EVENT: Schema = schema!("ExactEvent", "exact_event");
}

/// A vector, narrowed.
pub(super) fn vector(v: &sulcus_core::Vec3) -> Option<v1::Vector> {
    Some(v1::Vector {
        x: v.x as f32,
        y: v.y as f32,
        z: v.z as f32,
    })
}
