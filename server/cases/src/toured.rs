//! A tour performed in virtual time, and what each tick and each call says of the zones.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};
use sulcus_operator::script::{Call, Script};
use sulcus_operator::{HandParams, Operator, Shown};

/// Force up to which a depth counts as read with a light hand, newtons.
const LIGHT: f64 = 0.26;

/// Ticks outside that make a withdrawal.
const WITHDRAWN: u32 = 300;

/// Largest error of a zone's reading by a good operator, metres (issue of the whole mouth; a millimetre is what a trained
/// hand repeats).
pub const ALLOWED: f64 = 0.3e-3;

/// One zone of one tooth.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    /// FDI number.
    pub tooth: u8,
    /// The zone.
    pub site: Site,
    /// Depth that is prescribed, metres.
    pub prescribed: f64,
    /// The deepest that a light hand reached, metres.
    pub reached: f64,
    /// Largest force on the floor, newtons.
    pub most_force: f64,
    /// Time in the zone below the margin, seconds.
    pub time: f64,
    /// Time with at least half of the force that is taught, seconds.
    pub on_floor: f64,
    /// How often the tip came into the pocket here.
    pub entries: u32,
    /// Angle between working end and tooth axis where a light hand was deepest, radians; 0 where it was not.
    pub tilt: f64,
    /// What the operator called, millimetres.
    pub called: Option<u8>,
}

impl Read {
    /// How much deeper than prescribed, metres.
    pub fn error(&self) -> f64 {
        self.reached - self.prescribed
    }

    /// Whether it was read, and within [`ALLOWED`].
    pub fn holds(&self) -> bool {
        self.called.is_some() && self.error().abs() <= ALLOWED
    }
}

/// A tour as it went.
#[derive(Debug)]
pub struct Toured {
    /// Every zone of the scene.
    pub reads: Vec<Read>,
    /// In their order.
    pub calls: Vec<Call>,
    /// Until the script was done, seconds.
    pub time: f64,
    /// Whether it was.
    pub done: bool,
    /// How often a tip came in from above a margin.
    pub entries: u32,
    /// Ticks in which the probe was short of passes.
    pub exhausted: u32,
}

impl Toured {
    /// The zone of a tooth.
    ///
    /// # Panics
    /// When the scene has no gingiva of that number.
    pub fn of(&self, tooth: u8, site: Site) -> &Read {
        let is = |read: &&Read| read.tooth == tooth && read.site == site;
        self.reads.iter().find(is).expect("every zone has its row")
    }
}

/// Index, number and model of each gingiva.
fn gingivae(scene: &Scene) -> Vec<(usize, u8, &Gingiva)> {
    let objects = scene.objects.iter().enumerate();
    objects
        .filter_map(|(k, object)| match &object.tissue {
            TissueModel::Gingiva(model) => Some((k, object.fdi, &**model)),
            _ => None,
        })
        .collect()
}

/// Performs `script` with the probe in `slot` in the hand of that `seed`; `each` sees every tick.
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
    // Ticks since it was last in a pocket: a bob that comes out of a shallow sulcus is no withdrawal.
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
                let up = tool.graphic.orientation * -scene.tools[slot].tip_axis;
                read.tilt = up.dot(&model.tooth.axis).clamp(-1.0, 1.0).acos();
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

/// A table for people: what was touched or called.
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
