//! Motion of the tools, live, as the console sees them.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;
use sulcus_proto::live::Hands;
use tokio::sync::{broadcast, watch};

/// Motion of the tools, live.
pub trait Feeds: Send + Sync + 'static {
    /// Newest state of a station's tools. `None`: the server has no such station.
    fn glance(&self, station: &str) -> Option<Glance>;

    /// Shapes of a station's session for the flat picture. Takes some 50 ms. `None`: there is no session.
    fn outlines(&self, station: &str) -> Option<Outlines>;

    /// Depths of all sites of a station's session by the scene.
    fn depths(&self, station: &str) -> Vec<SiteDepth>;

    /// Stream of a station for the viewer. The first viewer of a session starts the program that draws it.
    ///
    /// # Errors
    /// A sentence for the person: no session runs, or the program is missing.
    fn live(&self, station: &str) -> Result<Live, String>;

    /// Files of the viewer. The first call takes some seconds.
    ///
    /// # Errors
    /// A sentence for the person: the program that holds them is missing, or fails.
    fn viewer(&self) -> Result<Arc<Viewer>, String>;
}

/// Newest state of a station's tools.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Glance {
    /// Number of the session at the station; 0 before the first one.
    pub begun: u64,
    /// State of the tools; `None` before the first tick.
    pub hands: Option<Hands>,
}

/// Depth of a site by the scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SiteDepth {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Name of the site.
    pub site: &'static str,
    /// Depth, millimetres.
    pub depth_mm: f32,
}

/// Shapes for the flat picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outlines {
    /// Number of the session, as in [`Glance::begun`].
    pub begun: u64,
    /// Duration of a tick, seconds.
    pub tick_s: f64,
    /// Tools, in the order of the slots.
    pub tools: Vec<ToolOutline>,
    /// Teeth with their margins.
    pub teeth: Vec<ToothOutline>,
}

/// Shape of a tool, in the tool's own frame, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolOutline {
    /// Name.
    pub name: String,
    /// Line from the grip to the tip.
    pub line: Vec<[f32; 3]>,
    /// Rim of a mirror's glass; empty for other tools.
    pub rim: Vec<[f32; 3]>,
}

/// Shape of a tooth, world axes, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToothOutline {
    /// FDI number.
    pub fdi: u8,
    /// Outermost points in many directions. Their convex hull is the outline in each projection.
    pub points: Vec<[f32; 3]>,
    /// Gingival margin at the six sites, in the order round the tooth; empty without a gingiva.
    pub margin: Vec<[f32; 3]>,
}

/// Part of a stream for the viewer.
pub type Segment = Arc<[u8]>;

/// Number of parts that a slow viewer may lag behind. Older parts are dropped.
pub const QUEUE: usize = 4;

/// Stream for a viewer: the first part, then further parts. Each part is a complete file for the viewer.
pub struct Live {
    /// First part; `None`: it is still being made. A closed channel without it: the stream has ended.
    pub begin: watch::Receiver<Option<Segment>>,
    /// Further parts, at most [`QUEUE`] of them waiting. A closed channel is the end of the stream.
    pub further: broadcast::Receiver<Segment>,
}

/// Files of the viewer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Viewer {
    /// Version.
    pub version: String,
    /// Contents by name, compressed by gzip.
    pub files: BTreeMap<String, Arc<[u8]>>,
}
