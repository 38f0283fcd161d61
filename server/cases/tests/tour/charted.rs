//! A tour performed in virtual time, and what each tick and each call says of the zones.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{NoProbe, Scene, State, TickInput, Workspace, tick};
use sulcus_operator::script::{Call, Script};
use sulcus_operator::{HandParams, Operator, Shown};

/// Force up to which a depth counts as read with a light hand, newtons.
pub const LIGHT: f64 = 0.26;

/// Ticks outside that make a withdrawal.
const WITHDRAWN: u32 = 300;

/// One zone of one tooth.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    pub tooth: u8,
    pub site: Site,
    /// Depth that is prescribed, and the deepest that a light hand reached, metres.
    pub prescribed: f64,
    pub reached: f64,
    /// Largest force on the floor, newtons.
    pub most_force: f64,
    /// Time in the zone below the margin, and time with at least half of the force that is taught, seconds.
    pub time: f64,
    pub on_floor: f64,
    /// How often the tip came into the pocket here.
    pub entries: u32,
    /// Largest angle between working end and tooth axis while on the floor, radians.
    pub tilt: f64,
    pub called: Option<u8>,
}

/// A tour as it went.
#[derive(Debug)]
pub struct Charted {
    pub reads: Vec<Read>,
    pub calls: Vec<Call>,
    /// Until the script was done, seconds; whether it was.
    pub time: f64,
    pub done: bool,
    /// How often a tip came in from above a margin.
    pub entries: u32,
    pub exhausted: u32,
}

impl Charted {
    pub fn of(&self, tooth: u8, site: Site) -> &Read {
        let is = |read: &&Read| read.tooth == tooth && read.site == site;
        self.reads.iter().find(is).expect("every zone has its row")
    }
}

/// Index, number and model of each gingiva.
pub fn gingivae(scene: &Scene) -> Vec<(usize, u8, &Gingiva)> {
    let of = |(k, object): (usize, &'_ sulcus_core::Object)| match &object.tissue {
        TissueModel::Gingiva(_) => Some((k, object.fdi)),
        _ => None,
    };
    let found: Vec<(usize, u8)> = scene.objects.iter().enumerate().filter_map(of).collect();
    found
        .into_iter()
        .filter_map(|(k, fdi)| match &scene.objects[k].tissue {
            TissueModel::Gingiva(model) => Some((k, fdi, &**model)),
            _ => None,
        })
        .collect()
}

pub fn perform(scene: &Scene, script: Box<dyn Script + Send>, slot: usize, seed: u64) -> Charted {
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
    let mut operator = Operator::new(script, HandParams::default(), seed);
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut shown = Shown::NOTHING;
    let mut charted = Charted {
        reads: Vec::new(),
        calls: Vec::new(),
        time: 0.0,
        done: false,
        entries: 0,
        exhausted: 0,
    };
    // Ticks since it was last in a pocket: a bob that comes out of a shallow sulcus is no withdrawal.
    let mut outside = WITHDRAWN;
    let trace = std::env::var("TRACE").is_ok();
    for k in 0..operator.ticks() {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let output = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        shown = Shown::from(&output);
        let tool = &output.tools[slot];
        charted.exhausted += u32::from(tool.status & sulcus_core::output::status::EXHAUSTED != 0);
        if trace && k % 50 == 0 {
            let tip = tool.graphic.transform(&scene.tools[slot].tip) * 1e3;
            let p = tool.pocket;
            println!(
                "{:.2} tip {:.2} {:.2} {:.2} F {:.3} pocket {:?}",
                k as f64 * 1e-3,
                tip.x,
                tip.y,
                tip.z,
                tool.raw_wrench.force.norm(),
                p.map(|p| (
                    p.object,
                    (p.around.to_degrees() * 10.0).round() / 10.0,
                    (p.depth * 1e5).round() / 100.0,
                    (p.floor_force * 1e3).round()
                ))
            );
        }
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
            charted.entries += u32::from(outside >= WITHDRAWN);
            if pocket.floor_force <= LIGHT {
                read.reached = read.reached.max(pocket.depth);
            }
            if pocket.floor_force > 0.1 {
                read.on_floor += 1e-3;
                let up = tool.graphic.orientation * -scene.tools[slot].tip_axis;
                read.tilt = read
                    .tilt
                    .max(up.dot(&model.tooth.axis).clamp(-1.0, 1.0).acos());
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
            charted.calls.push(call);
        }
        charted.time = (k + 1) as f64 * 1e-3;
        if operator.is_done() {
            charted.done = true;
            break;
        }
    }
    charted.reads = reads;
    charted
}

/// A table for people.
pub fn print(charted: &Charted) {
    for read in charted
        .reads
        .iter()
        .filter(|read| read.time > 0.0 || read.called.is_some())
    {
        println!(
            "{} {:13} prescribed {:.2} reached {:.2} ({:+.2}) called {:?} most {:.3} N, {:.1} s below the margin, {:.1} s on the floor, {} entries, tilt {:.0} deg",
            read.tooth,
            read.site.name(),
            read.prescribed * 1e3,
            read.reached * 1e3,
            (read.reached - read.prescribed) * 1e3,
            read.called,
            read.most_force,
            read.time,
            read.on_floor,
            read.entries,
            read.tilt.to_degrees()
        );
    }
    println!(
        "{:.1} s, done {}, {} entries, {} calls, {} exhausted",
        charted.time,
        charted.done,
        charted.entries,
        charted.calls.len(),
        charted.exhausted
    );
}
