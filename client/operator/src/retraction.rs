//! The `retraction` exercise: the mouth mirror comes down flat on the upper flank of the tongue, presses
//! some millimetres in, pushes it aside, holds it, slides along it, and lets go.
//!
//! The hand goes by what it sees and feels: it presses until the disc is as far in as it means to hold it, or
//! until the tongue resists more than a gentle hand would press.

use sulcus_core::{MAX_TOOLS, Object, Pose, Scene, Tool, Vec3};

use crate::frame::ToolFrame;
use crate::script::{Felt, Script, smoothstep};

/// How a tongue is held aside. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RetractionParams {
    /// Length of the exercise, seconds. Default 20.
    pub duration: f64,
    /// Angle between the press and straight down, radians: 0 on the back of the tongue, more on its flank.
    /// Default 0.46 (27 degrees).
    pub flank: f64,
    /// How far the disc goes in. Default 7 mm (5 to 10 are usual).
    pub press: f64,
    /// Force that the hand does not press beyond, newtons. Default 2.
    pub most_force: f64,
    /// Speed of pressing, m/s. Default 10 mm/s.
    pub press_speed: f64,
    /// How far the tongue is pushed aside. Default 4 mm.
    pub aside: f64,
    /// How long it is held, seconds; infinite: until told ([`Retraction::let_go`]). Default 1.5.
    pub hold: f64,
    /// How far the disc slides to each side along the tongue. Default 5 mm.
    pub slide: f64,
    /// Speed of sliding, m/s. Default 8 mm/s.
    pub slide_speed: f64,
    /// How often it is done at most. Default: until the time is up.
    pub times: u32,
    /// The place that is to be free, world, metres: the tongue is held on that side of it, and as far back. Default: the
    /// side of the first tooth, a little in front of the tongue's middle.
    pub work: Option<Vec3>,
}

impl Default for RetractionParams {
    fn default() -> Self {
        Self {
            duration: 20.0,
            flank: 0.46,
            press: 7e-3,
            most_force: 2.0,
            press_speed: 10e-3,
            aside: 4e-3,
            hold: 1.5,
            slide: 5e-3,
            slide_speed: 8e-3,
            times: u32::MAX,
            work: None,
        }
    }
}

/// Why the exercise cannot be performed in a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoTongue(pub String);

/// Time to come in and to leave, seconds.
const TRANSIT: f64 = 1.2;
/// How far off the surface the disc waits, metres.
const OFF: f64 = 3e-3;
/// How far off that the approach begins.
const STANDOFF: f64 = 20e-3;
/// Time constant of a hand's sense of force, seconds.
const FEEL: f64 = 0.02;
/// Farthest that a hand means to be inside, metres: then something else is wrong.
const MOST_PRESS: f64 = 40e-3;
/// Speed of the push aside, and of letting go, m/s.
const ASIDE_SPEED: f64 = 6e-3;
const LET_GO_SPEED: f64 = 80e-3;

/// Stretch of the tongue that can be held, as shares of its length from behind.
const WORKABLE: [f64; 2] = [0.4, 0.75];

/// What the hand is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Press,
    Aside,
    Hold(f64),
    /// Along, to each of these in turn.
    Slide(usize),
    LetGo,
    Rest(f64),
}

/// The script.
#[derive(Clone, Debug)]
pub struct Retraction {
    params: RetractionParams,
    slot: usize,
    /// Length of a tick, seconds.
    dt: f64,
    tool: ToolFrame,
    /// Disc's centre in the tool's frame.
    disc: Vec3,
    /// Where the disc's centre is when its face first touches, world.
    touch: Vec3,
    /// Unit vectors, world: into the tongue, sideways in the disc's plane, along the tongue.
    inward: Vec3,
    sideways: Vec3,
    along: Vec3,
    /// From the disc's centre to its far edge, and to its face.
    reach: f64,
    thickness: f64,
    // What changes while it is performed.
    time: f64,
    /// When it goes away, seconds.
    leaves: f64,
    phase: Phase,
    force: f64,
    /// How often it let go.
    done: u32,
    /// How far in the hand sees the disc, metres.
    seen: f64,
    /// Where the hand means the disc to be: in, aside, along.
    meant: [f64; 3],
}

impl Retraction {
    /// The exercise on the largest thing that yields, with the first tool without bands (a mirror).
    ///
    /// # Errors
    /// When the scene has nothing that yields, no such tool, or the disc would not meet it.
    pub fn new(scene: &Scene, params: RetractionParams) -> Result<Self, NoTongue> {
        let slot = scene
            .tools
            .iter()
            .position(|tool| tool.bands.is_empty())
            .ok_or_else(|| {
                NoTongue(format!(
                    "scene `{}` has no mouth mirror (a tool without bands)",
                    scene.name
                ))
            })?;
        let tool = &scene.tools[slot];
        let size = |object: &Object| object.tree.nodes()[0].bound_radius;
        let tongue = scene
            .objects
            .iter()
            .filter(|object| !object.tissue.is_rigid())
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .ok_or_else(|| {
                NoTongue(format!(
                    "scene `{}` has no tongue (an object that yields)",
                    scene.name
                ))
            })?;
        // The flank towards the teeth, else the left one.
        let middle = tongue.tree.nodes()[0].centre;
        let tooth = scene.objects.iter().find(|object| object.fdi != 0);
        let tooth = tooth.map(|tooth| tooth.tree.nodes()[0].centre);
        let side = params
            .work
            .or(tooth)
            .map_or(1.0, |work| (work.y - middle.y).signum());
        let (sine, cosine) = (libm::sin(params.flank), libm::cos(params.flank));
        let inward = Vec3::new(0.0, -side * sine, -cosine);
        let sideways = Vec3::new(0.0, -side * cosine, sine);
        // The disc's far edge points back into the mouth, the handle comes out of it.
        let along = -Vec3::x();
        let frame = ToolFrame::of(tool);
        let disc = tool.working_point;
        let reach = (tool.tip - disc).norm();
        let thickness = face_height(tool, &disc, &-frame.basis.column(1).into_owned(), reach);
        let touch =
            touching(tongue, &inward, reach, side * sine, params.work).ok_or_else(|| {
                NoTongue(format!(
                    "the mirror would not meet `{}` from above: is z up, and is it a tongue?",
                    tongue.name
                ))
            })? - inward * thickness;
        Ok(Self {
            params,
            slot,
            dt: scene.tick_s(),
            tool: frame,
            disc,
            touch,
            inward,
            sideways,
            along,
            reach,
            thickness,
            time: 0.0,
            leaves: params.duration - TRANSIT,
            phase: Phase::Press,
            force: 0.0,
            done: 0,
            seen: 0.0,
            meant: [-OFF, 0.0, 0.0],
        })
    }

    /// Where the middle of the disc's face first touches the tongue at rest, world.
    pub fn touch(&self) -> Vec3 {
        self.touch + self.inward * self.thickness
    }

    /// Device pose with the disc's face `deep` metres into the tongue as it is at rest, set off sideways and
    /// along it.
    pub fn pose(&self, deep: f64, aside: f64, along: f64) -> Pose {
        let centre = self.touch + self.inward * deep + self.sideways * aside + self.along * along;
        // The tool's tip is the disc's far edge; its face looks away from the handle's side.
        let edge = centre + self.along * self.reach;
        self.tool.at(&edge, &self.along, &-self.inward)
    }

    /// Slot of the mirror.
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// Whether the tongue is held aside.
    pub fn holds(&self) -> bool {
        matches!(self.phase, Phase::Hold(_) | Phase::Slide(_))
    }

    /// Lets go now, and goes away.
    pub fn let_go(&mut self) {
        self.leaves = self.leaves.min(self.time);
    }

    /// One millisecond of the phase under way.
    fn go_on(&mut self) {
        let (p, dt) = (self.params, self.dt);
        let mut towards = |axis: usize, goal: f64, speed: f64| {
            let way = goal - self.meant[axis];
            let step = (speed * dt).min(way.abs());
            self.meant[axis] += step * way.signum();
            way.abs() <= speed * dt
        };
        self.phase = match self.phase {
            Phase::Press => {
                let there = self.seen >= p.press || self.force >= p.most_force;
                if there || towards(0, MOST_PRESS, p.press_speed) {
                    Phase::Aside
                } else {
                    Phase::Press
                }
            }
            Phase::Aside if towards(1, p.aside, ASIDE_SPEED) => Phase::Hold(p.hold),
            Phase::Hold(left) if left <= 0.0 => Phase::Slide(0),
            Phase::Hold(left) => Phase::Hold(left - dt),
            Phase::Slide(k) => {
                let stops = [p.slide, -p.slide, 0.0];
                match stops.get(k) {
                    Some(stop) if towards(2, *stop, p.slide_speed) => Phase::Slide(k + 1),
                    Some(_) => Phase::Slide(k),
                    None => Phase::LetGo,
                }
            }
            Phase::LetGo if towards(0, -OFF, LET_GO_SPEED) => {
                self.done += 1;
                Phase::Rest(0.8)
            }
            Phase::Rest(left) if left <= 0.0 && self.done < p.times => Phase::Press,
            Phase::Rest(left) => {
                towards(1, 0.0, ASIDE_SPEED);
                Phase::Rest(left - dt)
            }
            same => same,
        };
    }
}

impl Script for Retraction {
    fn feel(&mut self, felt: &Felt) {
        self.time += self.dt;
        let wrench = &felt.shown.wrenches[self.slot];
        let back = -wrench.force.dot(&self.inward);
        self.force += (back - self.force) * (self.dt / FEEL);
        if let Some(graphic) = felt.shown.graphics[self.slot] {
            self.seen = (graphic.transform(&self.disc) - self.touch).dot(&self.inward);
        }
        if self.time > TRANSIT && self.time < self.leaves {
            self.go_on();
        } else if self.time >= self.leaves {
            self.phase = Phase::LetGo;
            self.meant[0] = (self.meant[0] - LET_GO_SPEED * self.dt).max(-OFF);
        }
    }

    fn targets(&self, _: f64) -> [Option<Pose>; MAX_TOOLS] {
        // By its own clock: another script may start it late.
        let t = (self.time - self.dt).max(0.0);
        let leaving = smoothstep((t - self.leaves - 0.5 * TRANSIT) / (0.5 * TRANSIT));
        let away = (1.0 - smoothstep(t / TRANSIT) + leaving).min(1.0);
        let [deep, aside, along] = self.meant;
        let mut targets = [None; MAX_TOOLS];
        targets[self.slot] = Some(self.pose(deep - STANDOFF * away, aside, along));
        targets
    }

    fn duration_s(&self) -> f64 {
        self.params.duration
    }

    fn is_done(&self) -> bool {
        self.time >= self.leaves + TRANSIT
    }
}

/// How far the disc's pressing face stands out from its centre, metres.
fn face_height(tool: &Tool, disc: &Vec3, face: &Vec3, reach: f64) -> f64 {
    tool.tree
        .shape_at(tool.level)
        .filter(|(_, node)| (node.centre - disc).norm() < 0.6 * reach)
        .map(|(_, node)| (node.centre - disc).dot(face) + node.contact_radius)
        .fold(0.0, f64::max)
}

/// Where a flat disc of radius `reach` that comes along `inward` first meets the tongue, `side` of the way to
/// its left flank: the middle of its face.
fn touching(
    tongue: &Object,
    inward: &Vec3,
    reach: f64,
    side: f64,
    work: Option<Vec3>,
) -> Option<Vec3> {
    let leaves = || tongue.tree.shape_at(tongue.level).map(|(_, node)| node);
    let huge = Vec3::repeat(f64::INFINITY);
    let (low, high) = leaves().fold((huge, -huge), |(low, high), node| {
        (low.inf(&node.centre), high.sup(&node.centre))
    });
    // A little in front of the middle: the root behind is stiff, the tip too thin for the disc. A flank lies
    // off the middle.
    let share = work.map_or(0.6, |work| {
        let share = (work.x - low.x) / (high.x - low.x);
        share.clamp(WORKABLE[0], WORKABLE[1])
    });
    let aim = Vec3::new(
        low.x + share * (high.x - low.x),
        0.5 * (low.y + high.y) + 0.45 * side * (high.y - low.y),
        0.5 * (low.z + high.z),
    );
    let near = leaves().filter(|node| {
        let from = node.centre - aim;
        (from - inward * from.dot(inward)).norm() < reach
    });
    let first = near
        .map(|node| (node.centre - aim).dot(inward) - node.contact_radius)
        .fold(f64::INFINITY, f64::min);
    first.is_finite().then(|| aim + inward * first)
}
