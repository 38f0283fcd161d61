//! What a review shows, as plain data: millimetres, newtons, x anterior, y to the patient's left, z up.

/// A triangle mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPicture {
    /// Vertices, mm.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as vertex indices, outward by the right hand.
    pub triangles: Vec<[u32; 3]>,
    /// Colour of all of it, sRGB.
    pub colour: [u8; 3],
    /// Colours of the vertices, where they differ: one each, or none.
    pub vertex_colours: Vec<[u8; 3]>,
}

/// What a part of the mouth is: decides in which views it stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PartKind {
    /// A tooth.
    Tooth,
    /// The gingiva round a tooth: see-through in the close-up.
    Gingiva,
    /// The tongue: left out of the close-up.
    Tongue,
    /// The jaw and whatever else there is.
    Other,
}

impl PartKind {
    /// Its folder in the file.
    pub(crate) fn folder(self) -> &'static str {
        match self {
            PartKind::Tooth => "/mouth/teeth",
            PartKind::Gingiva => "/mouth/gingiva",
            PartKind::Tongue => "/mouth/tongue",
            PartKind::Other => "/mouth/jaw",
        }
    }
}

/// A part of the mouth.
#[derive(Clone, Debug, PartialEq)]
pub struct PartPicture {
    /// What it is.
    pub kind: PartKind,
    /// Name, for people.
    pub name: String,
    /// At rest, world axes.
    pub mesh: MeshPicture,
    /// Whether it can move: then its vertices come with [`crate::ReviewFile::part`].
    pub yields: bool,
}

/// A tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolPicture {
    /// Name, for people.
    pub name: String,
    /// In the tool's own frame.
    pub mesh: MeshPicture,
    /// Where its tip is, in the same frame.
    pub tip: [f32; 3],
}

/// A word at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Where, world axes.
    pub at: [f32; 3],
    /// The word.
    pub text: String,
}

/// An eye and what it looks at, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Where it is.
    pub at: [f32; 3],
    /// What it looks at.
    pub on: [f32; 3],
}

/// Where the slider stands when the file is opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slider {
    /// Where the file begins: to be played.
    Start,
    /// Where it ends: for a picture of that moment.
    End,
}

/// All of a review that does not change.
#[derive(Clone, Debug, PartialEq)]
pub struct ReviewPicture {
    /// Name of the session.
    pub name: String,
    /// What is said about the session, Markdown.
    pub about: String,
    /// One or two tools.
    pub tools: Vec<ToolPicture>,
    /// Which of them probes: its tip is what the close-up follows.
    pub probe: usize,
    /// The mouth.
    pub parts: Vec<PartPicture>,
    /// Numbers of the teeth.
    pub teeth: Vec<Label>,
    /// First and last moment of what is shown, nanoseconds since the session began.
    pub span_ns: [i64; 2],
    /// Force on the floor at which a depth is to be read, N; none where no pocket is probed: neither force on a floor nor depth is
    /// plotted then.
    pub reading_band_n: Option<[f64; 2]>,
    /// Force on the floor from which healthy tissue bleeds, N.
    pub trauma_n: Option<f64>,
    /// Where the whole mouth is seen from.
    pub overview: Eye,
    /// Where the tongue's retraction is seen from, where there is a tongue.
    pub retraction: Option<Eye>,
    /// Where the close-up's eye stands and what it looks at, in the frame that follows the tip; none where no tip is at work.
    pub close_up: Option<Eye>,
    /// How long an arrow is for a newton, mm.
    pub arrow_mm_per_n: f32,
    /// Numbers of work of a tick, for the legend.
    pub work: Vec<String>,
    /// Where the slider stands when the file is opened.
    pub slider: Slider,
}

/// A moment of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment {
    /// Number of the tick.
    pub tick: i64,
    /// Time since the session began, nanoseconds.
    pub session_ns: i64,
}

/// What a tick says in numbers; what is no number is a gap in the plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Force on each hand, N.
    pub force_n: Vec<f64>,
    /// Torque on each hand, N mm.
    pub torque_nmm: Vec<f64>,
    /// Depth at which the probe's tip is, mm.
    pub depth_mm: f64,
    /// Depth that the patient's chart prescribes where the tip is, mm.
    pub prescribed_mm: f64,
    /// Force on the floor of the pocket, N.
    pub floor_n: f64,
    /// Work of the tick, as many as the picture has names for.
    pub work: Vec<f64>,
}

/// Where something is: `world_from_it`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Of its origin, mm.
    pub at: [f32; 3],
    /// Quaternion x, y, z, w.
    pub turned: [f32; 4],
}

/// A tool in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolStanding {
    /// Where the tool is (graphic tool).
    pub graphic: Standing,
    /// Where the hand is (haptic tool), if it is not just there.
    pub haptic: Option<Standing>,
    /// Tip of the tool and of the hand's, world axes, mm.
    pub tips: [[f32; 3]; 2],
    /// What pushes on the tool in all, newtons, and where.
    pub push: Option<Arrow>,
}

/// A force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where it acts, world axes, mm.
    pub at: [f32; 3],
    /// Force on the tool, N, world axes.
    pub force_n: [f32; 3],
    /// What pushes.
    pub by: PartKind,
}

/// A picture of everything that moves but tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePicture {
    /// In the order of the picture's tools; none where no hand holds it.
    pub tools: Vec<Option<ToolStanding>>,
    /// Single contacts that bear load, of each tool.
    pub contacts: Vec<Vec<Arrow>>,
    /// The frame in which the close-up is seen.
    pub close_up: Standing,
}

/// How much an event matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Good to know.
    Info,
    /// What a teacher would speak of.
    Warning,
    /// Something failed.
    Error,
}

/// What is in a state for a while, shown as a coloured lane over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lane {
    /// The site that the probe is in.
    Site,
    /// How heavy the hand is on the floor.
    Zone,
    /// Whether the target can be seen past the tongue.
    Target,
}

impl Lane {
    /// Its entity.
    pub(crate) fn path(self) -> &'static str {
        match self {
            Lane::Site => "/lanes/site",
            Lane::Zone => "/lanes/force_on_floor",
            Lane::Target => "/lanes/target",
        }
    }
}
