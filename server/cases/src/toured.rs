//! A tour in virtual time, and the readings and calls of each zone.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick};
use sulcus_operator::script::{Call, Script};
use sulcus_operator::{HandParams, Operator, Shown};

/// Largest force on the floor at which a depth counts, newtons.
const LIGHT: f64 = 0.26;

/// Number of ticks outside a pocket that make a withdrawal.
const WITHDRAWN: u32 = 300;

/// Largest error of a zone's reading by a good operator, metres; chosen. A trained hand repeats a depth to a
/// millimetre.
pub const ALLOWED: f64 = 0.3e-3;

/// Readings of one zone of one tooth.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site of the zone.
    pub site: Site,
    /// Prescribed depth, metres.
    pub prescribed: f64,
    /// Deepest reading with at most 0.26 N on the floor, metres.
    pub reached: f64,
    /// Largest force on the floor, newtons.
    pub most_force: f64,
    /// Time of the tip in the zone below the margin, seconds at 1 kHz.
    pub time: f64,
    /// Time with more than 0.1 N on the floor, seconds at 1 kHz.
    pub on_floor: f64,
    /// Number of entries into the pocket in this zone.
    pub entries: u32,
    /// Angle between working end and tooth axis at the reading [`Read::reached`], radians; 0 without a reading.
    pub tilt: f64,
    /// Unit vector up along the working end at the reading [`Read::reached`], world; the zero vector without a reading.
    pub up: Vec3,
    /// Depth that the operator called last, millimetres; `None`: no call.
    pub called: Option<u8>,
}

impl Read {
    /// Error of [`Read::reached`], metres; positive: deeper than prescribed.
    pub fn error(&self) -> f64 {
        self.reached - self.prescribed
    }

    /// Whether the zone was read, with an error within [`ALLOWED`].
    pub fn holds(&self) -> bool {
        self.called.is_some() && self.error().abs() <= ALLOWED
    }
}

/// Result of a tour.
#[derive(Debug)]
pub struct Toured {
    /// Readings of every zone of the scene.
    pub reads: Vec<Read>,
    /// Calls in their order.
    pub calls: Vec<Call>,
    /// Length of the run, seconds at 1 kHz.
    pub time: f64,
    /// Whether the script finished all its tasks.
    pub done: bool,
    /// Number of entries into pockets after a withdrawal.
    pub entries: u32,
    /// Number of ticks in which the probe's substeps ran out.
    pub exhausted: u32,
}

impl Toured {
    /// Readings of a zone of a tooth.
    ///
    /// # Panics
    /// The scene has no gingiva with that FDI number.
    pub fn of(&self, tooth: u8, site: Site) -> &Read {
        let is = |read: &&Read| read.tooth == tooth && read.site == site;
        self.reads.iter().find(is).expect("every zone has its row")
    }
}

/// Object index, FDI number and model of each gingiva.
fn gingivae(scene: &Scene) -> Vec<(usize, u8, &Gingiva)> {
    let objects = scene.objects.iter().enumerate();
    objects
        .filter_map(|(k, object)| match &object.tissue {
            TissueModel::Gingiva(model) => Some((k, object.fdi, &**model)),
            _ => None,
        })
        .collect()
}

/// Performs `script` with the probe in `slot` and a hand with `seed`, to its end or until its tasks are finished.
/// `each` receives the output of every tick.
pub fn perform(
    scene: &Scene,
    script: Box<dyn Script + Send>,
    (slot, seed): (usize, u64),
    mut each: impl FnMut(&TickOutput),
) -> Toured {
    let all = gingivae(scene);
    let mut reads: Vec<Read> = all
        .iter()
        .flat_map(|(_, tooth, model)| {
            Site::ALL.map(|site| Read {
                tooth: *tooth,
                site,
                prescribed: model.prescribed(site).depth,
                reached: 0.0,
                most_force: 0.0,
                time: 0.0,
                on_floor: 0.0,
                entries: 0,
                tilt: 0.0,
                up: Vec3::zeros(),
                called: None,
            })
        })
        .collect();
    let hand = HandParams {
        period_s: scene.tick_s(),
        ..HandParams::default()
    };
    let mut operator = Operator::new(script, hand, seed);
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut shown = Shown::NOTHING;
    let mut toured = Toured {
        reads: Vec::new(),
        calls: Vec::new(),
        time: 0.0,
        done: false,
        entries: 0,
        exhausted: 0,
    };
    // Number of ticks since the tip was in a pocket. A bob that leaves a shallow sulcus is no withdrawal.
    let mut outside = WITHDRAWN;
    for k in 0..operator.ticks() {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let output = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        shown = Shown::from(&output);
        let tool = &output.tools[slot];
        toured.exhausted += u32::from(tool.status & sulcus_core::output::status::EXHAUSTED != 0);
        each(&output);
        if let Some(pocket) = tool.pocket {
            let (index, found) = all
                .iter()
                .enumerate()
                .find(|(_, (k, ..))| *k == usize::from(pocket.object))
                .expect("a gingiva");
            let model = found.2;
            let read = &mut reads[6 * index + model.site_at(pocket.around) as usize];
            read.time += 1e-3;
            read.most_force = read.most_force.max(pocket.floor_force);
            read.entries += u32::from(outside >= WITHDRAWN);
            toured.entries += u32::from(outside >= WITHDRAWN);
            if pocket.floor_force <= LIGHT && pocket.depth > read.reached {
                read.reached = pocket.depth;
                read.up = tool.graphic.orientation * -scene.tools[slot].tip_axis;
                read.tilt = read.up.dot(&model.tooth.axis).clamp(-1.0, 1.0).acos();
            }
            if pocket.floor_force > 0.1 {
                read.on_floor += 1e-3;
            }
        }
        outside = if tool.pocket.is_some() {
            0
        } else {
            outside + 1
        };
        for call in operator.calls() {
            let is = |read: &&mut Read| read.tooth == call.tooth && read.site == call.site;
            if let Some(read) = reads.iter_mut().find(is) {
                read.called = Some(call.depth_mm);
            }
            toured.calls.push(call);
        }
        toured.time = (k + 1) as f64 * 1e-3;
        if operator.is_done() {
            toured.done = true;
            break;
        }
    }
    toured.reads = reads;
    toured
}

impl std::fmt::Display for Read {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} {:13} prescribed {:5.2} reached {:5.2} ({:+.2}) mm, called {}, most {:.2} N, {:4.1} s on the floor, {} entries, tilt {:2.0} deg",
            self.tooth,
            self.site.name(),
            self.prescribed * 1e3,
            self.reached * 1e3,
            self.error() * 1e3,
            self.called.map_or("-".into(), |called| called.to_string()),
            self.most_force,
            self.on_floor,
            self.entries,
            self.tilt.to_degrees()
        )
    }
}

/// A table for people: the zones that were touched or called.
impl std::fmt::Display for Toured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let touched = |read: &&Read| read.time > 0.0 || read.called.is_some();
        for read in self.reads.iter().filter(touched) {
            writeln!(f, "{read}")?;
        }
        write!(
            f,
            "{:.1} s, done {}, {} entries, {} calls, {} exhausted",
            self.time,
            self.done,
            self.entries,
            self.calls.len(),
            self.exhausted
        )
    }
}
