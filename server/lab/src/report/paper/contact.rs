//! A scene under one operator in closed loop, and what contact in it looks like.

use sulcus_cases::statistics::percentile;
use sulcus_cases::{Measures, Observer};
use sulcus_core::math::norm;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick,
};
use sulcus_operator::script::OneTool;
use sulcus_operator::{HandParams, Operator, Script, Shown};

/// Seed of the hand's tremor in every run of this report.
pub(super) const SEED: u64 = 7;
/// Ticks between two independent looks for penetration where it is asked for: each takes longer than a tick.
pub(super) const LOOKED: u64 = 10;

/// One tick of a run.
pub(super) struct Seen<'a> {
    /// Seconds since the beginning.
    pub(super) t: f64,
    pub(super) scene: &'a Scene,
    pub(super) ws: &'a Workspace,
    pub(super) out: &'a TickOutput,
}

impl Seen<'_> {
    /// Force and torque on the hand about the working point of the first tool, newtons and newton metres.
    pub(super) fn wrench(&self) -> (Vec3, Vec3) {
        let out = &self.out.tools[0];
        let lever = out.haptic.orientation * self.scene.tools[0].working_point;
        let there = out.raw_wrench.moved(&-lever);
        (there.force, there.torque)
    }

    /// How far each sphere of object `k` that is touched is from its rest, metres.
    fn displaced(&self, k: usize) -> Vec<f64> {
        let object = &self.scene.objects[k];
        let shape: Vec<_> = object.tree.shape_at(object.level).collect();
        let ids: Vec<u32> = shape.iter().map(|(id, _)| *id).collect();
        let mut centres = vec![Vec3::zeros(); ids.len()];
        if !self.ws.centres_of(k, &ids, &mut centres) {
            return Vec::new();
        }
        let moved = centres.iter().zip(&shape);
        moved
            .map(|(c, (_, node))| norm(&(c - node.centre)))
            .collect()
    }

    /// Farthest that a sphere of object `k` is from its rest, metres.
    pub(super) fn indentation(&self, k: usize) -> f64 {
        self.displaced(k).into_iter().fold(0.0, f64::max)
    }

    /// Share of the spheres of object `k` that are displaced by more than `least` metres.
    pub(super) fn extent(&self, k: usize, least: f64) -> f64 {
        let displaced = self.displaced(k);
        let count = displaced.iter().filter(|d| **d > least).count();
        count as f64 / displaced.len().max(1) as f64
    }

    /// Number of separate places in which tool `t` bears load: contacts of one object within `apart` metres are one place.
    pub(super) fn regions(&self, t: usize, apart: f64) -> usize {
        let loaded = self
            .ws
            .contacts()
            .filter(|(c, load)| usize::from(c.tool) == t && *load > 0.0);
        let mut places: Vec<(u16, Vec3)> = loaded.map(|(c, _)| (c.object, c.arm)).collect();
        let mut count = 0;
        while let Some(first) = places.pop() {
            count += 1;
            let mut region = vec![first];
            while let Some(at) = region.pop() {
                let near = |p: &(u16, Vec3)| p.0 == at.0 && norm(&(p.1 - at.1)) < apart;
                region.extend(places.iter().copied().filter(near));
                places.retain(|p| !near(p));
            }
        }
        count
    }
}

/// A script for the first tool.
pub(super) fn hand_at(
    pose: impl Fn(f64) -> Pose + Send + 'static,
    duration_s: f64,
) -> Box<dyn Script + Send> {
    Box::new(OneTool { pose, duration_s })
}

/// Runs `scene` under an operator with that script in closed loop for so many seconds; `look` sees every tick. Penetration is
/// looked for every `looked` ticks.
pub(super) fn by_hand(
    scene: &Scene,
    script: Box<dyn Script + Send>,
    (seconds, looked): (f64, u64),
    mut look: impl FnMut(&Seen),
) -> (Measures, Vec<TickInput>) {
    let mut operator = Operator::new(script, HandParams::default(), SEED);
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut observer = Observer::new(scene);
    observer.residual_every = looked;
    let mut shown = Shown::NOTHING;
    let ticks = (seconds / scene.tick_s()) as usize;
    let inputs = (0..ticks).map(|k| {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let out = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        observer.observe(scene, &input, &out, &ws);
        shown = Shown::from(&out);
        look(&Seen {
            t: k as f64 * scene.tick_s(),
            scene,
            ws: &ws,
            out: &out,
        });
        input
    });
    let inputs = inputs.collect();
    (observer.measures(), inputs)
}

/// Numbers tick by tick, and their percentiles.
#[derive(Default)]
pub(super) struct Counts(Vec<u32>);

impl Counts {
    pub(super) fn add(&mut self, count: impl Into<u32>) {
        self.0.push(count.into());
    }

    /// Median, 99th percentile, most.
    pub(super) fn percentiles(&mut self) -> [f64; 3] {
        self.0.sort_unstable();
        [0.5, 0.99, 1.0].map(|share| percentile(&self.0, share).map_or(0.0, f64::from))
    }
}

/// Tool slots of a scene.
pub(super) fn slots(scene: &Scene) -> std::ops::Range<usize> {
    0..scene.tools.len().min(MAX_TOOLS)
}
