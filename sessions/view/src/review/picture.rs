//! Content of a review as plain data: millimetres, newtons, x anterior, y to the patient's left, z up.

/// Triangle mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPicture {
    /// Vertices, mm.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as vertex indices, outward by the right hand.
    pub triangles: Vec<[u32; 3]>,
    /// Colour of the mesh, sRGB.
    pub colour: [u8; 3],
    /// Colours of the vertices, sRGB: one for each vertex, or none.
    pub vertex_colours: Vec<[u8; 3]>,
}

/// Kind of a part of the mouth. The kind decides in which views the part is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PartKind {
    /// A tooth.
    Tooth,
    /// Gingiva round a tooth, transparent in the close-up.
    Gingiva,
    /// Tongue, left out of the close-up.
    Tongue,
    /// Jaw, and any other part.
    Other,
}

impl PartKind {
    /// Folder of the kind in the file.
    pub(crate) fn folder(self) -> &'static str {
        match self {
            PartKind::Tooth => "/mouth/teeth",
            PartKind::Gingiva => "/mouth/gingiva",
            PartKind::Tongue => "/mouth/tongue",
            PartKind::Other => "/mouth/jaw",
        }
    }
}

/// Part of the mouth.
#[derive(Clone, Debug, PartialEq)]
pub struct PartPicture {
    /// Kind of the part.
    pub kind: PartKind,
    /// Name of the part.
    pub name: String,
    /// Mesh at rest, world axes.
    pub mesh: MeshPicture,
    /// Whether the part can move. Its vertices then come by [`crate::ReviewFile::part`].
    pub yields: bool,
}

/// Tool of a review.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolPicture {
    /// Name of the tool.
    pub name: String,
    /// Mesh in the tool's own frame.
    pub mesh: MeshPicture,
    /// Tip in the tool's own frame, mm.
    pub tip: [f32; 3],
}

/// Text at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Place, world axes, mm.
    pub at: [f32; 3],
    /// The text.
    pub text: String,
}

/// Eye and its target, world axes, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Place of the eye.
    pub at: [f32; 3],
    /// Place at which the eye looks.
    pub on: [f32; 3],
}

/// Position of the slider when the file is opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slider {
    /// Beginning of the file, to be played.
    Start,
    /// End of the file, for a picture of that moment.
    End,
}

/// Constant part of a review.
#[derive(Clone, Debug, PartialEq)]
pub struct ReviewPicture {
    /// Name of the session.
    pub name: String,
    /// Text about the session, Markdown.
    pub about: String,
    /// One or two tools.
    pub tools: Vec<ToolPicture>,
    /// Index of the probing tool, whose tip the close-up follows.
    pub probe: usize,
    /// Parts of the mouth.
    pub parts: Vec<PartPicture>,
    /// Numbers at the teeth.
    pub teeth: Vec<Label>,
    /// First and last time of the review, nanoseconds since the session began.
    pub span_ns: [i64; 2],
    /// Force on the floor at which a depth should be read, N; `None` without pockets to probe, and then neither force
    /// on a floor nor depth is plotted.
    pub reading_band_n: Option<[f64; 2]>,
    /// Force on the floor from which healthy tissue bleeds, N.
    pub trauma_n: Option<f64>,
    /// Eye on the whole mouth.
    pub overview: Eye,
    /// Eye on the tongue; `None` without a tongue.
    pub retraction: Option<Eye>,
    /// Eye of the close-up in the frame that follows the tip; `None` without a probing tip.
    pub close_up: Option<Eye>,
    /// Length of an arrow for one newton, mm.
    pub arrow_mm_per_n: f32,
    /// Names of the numbers of work, for the legend.
    pub work: Vec<String>,
    /// Position of the slider when the file is opened.
    pub slider: Slider,
}

/// Time of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment {
    /// Number of the tick.
    pub tick: i64,
    /// Time since the session began, nanoseconds.
    pub session_ns: i64,
}

/// Numbers of a tick. A NaN is a gap in the plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Force on each hand, N.
    pub force_n: Vec<f64>,
    /// Torque on each hand, N mm.
    pub torque_nmm: Vec<f64>,
    /// Depth of the probe's tip, mm.
    pub depth_mm: f64,
    /// Prescribed depth at the place of the tip, mm.
    pub prescribed_mm: f64,
    /// Force on the floor of the pocket, N.
    pub floor_n: f64,
    /// Numbers of work, as many as the picture has names.
    pub work: Vec<f64>,
}

/// Place and orientation in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Place of the origin, mm.
    pub at: [f32; 3],
    /// Quaternion x, y, z, w.
    pub turned: [f32; 4],
}

/// Tool in a frame of the review.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolStanding {
    /// Graphic tool.
    pub graphic: Standing,
    /// Haptic tool, the place of the hand; `None` at the place of the graphic tool.
    pub haptic: Option<Standing>,
    /// Tips of the graphic and of the haptic tool, world axes, mm.
    pub tips: [[f32; 3]; 2],
    /// Total force on the tool and its place.
    pub push: Option<Arrow>,
}

/// Force as an arrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Place, world axes, mm.
    pub at: [f32; 3],
    /// Force on the tool, N, world axes.
    pub force_n: [f32; 3],
    /// Kind of the part that pushes.
    pub by: PartKind,
}

/// Picture of all moving things except tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePicture {
    /// Tools in the order of the constant part; `None` for a tool that no hand holds.
    pub tools: Vec<Option<ToolStanding>>,
    /// Contacts under load of each tool.
    pub contacts: Vec<Vec<Arrow>>,
    /// Frame of the close-up.
    pub close_up: Standing,
}

/// Importance of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Information.
    Info,
    /// Fault of the learner.
    Warning,
    /// Failure.
    Error,
}

/// Coloured lane over time, which shows a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lane {
    /// Site of the probe.
    Site,
    /// Zone of force on the floor.
    Zone,
    /// Visibility of the target past the tongue.
    Target,
}

impl Lane {
    /// Entity of the lane.
    pub(crate) fn path(self) -> &'static str {
        match self {
            Lane::Site => "/lanes/site",
            Lane::Zone => "/lanes/force_on_floor",
            Lane::Target => "/lanes/target",
        }
    }
}
