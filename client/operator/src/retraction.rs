//! The `retraction` exercise: the mouth mirror presses flat on the upper flank of the tongue, pushes it aside, holds
//! it, slides along it and lets go.
//!
//! The hand presses until the disc, as drawn, has its depth, or until the force reaches the limit of a gentle hand.

use sulcus_core::{MAX_TOOLS, Object, Pose, Scene, Tool, Vec3};

use crate::frame::ToolFrame;
use crate::script::{Felt, Script, smoothstep};

/// Parameters of the exercise, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RetractionParams {
    /// Length of the exercise, seconds. Default 20.
    pub duration: f64,
    /// Angle between the press and the downward direction, radians: 0 on the back of the tongue, larger on its flank.
    /// Default 0.46, which is 27 degrees.
    pub flank: f64,
    /// Depth of the disc in the tongue at rest, metres. Default 7 mm; 5 to 10 mm are usual.
    pub press: f64,
    /// Force at which the press ends, newtons. Default 2.
    pub most_force: f64,
    /// Speed of the press, m/s. Default 10 mm/s.
    pub press_speed: f64,
    /// Distance of the push aside, metres. Default 4 mm.
    pub aside: f64,
    /// Duration of the hold, seconds; infinite: until [`Retraction::let_go`]. Default 1.5.
    pub hold: f64,
    /// Distance of the slide to each side along the tongue, metres. Default 5 mm.
    pub slide: f64,
    /// Speed of the slide, m/s. Default 8 mm/s.
    pub slide_speed: f64,
    /// Largest number of presses. Default: as many as the duration allows.
    pub times: u32,
    /// Place that must be free, world, metres. The tongue is pressed on that side, and as far back as the place.
    /// Default: the side of the first tooth, a little in front of the tongue's middle.
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

/// Error of a scene without a mirror or a tongue for the exercise; one sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoTongue(pub String);

/// Time of the approach, and of the retreat, seconds.
const TRANSIT: f64 = 1.2;
/// Distance from the surface at which the disc waits, metres.
const OFF: f64 = 3e-3;
/// Distance from the waiting position at which the approach begins, metres.
const STANDOFF: f64 = 20e-3;
/// Time constant of a hand's sense of force, seconds.
const FEEL: f64 = 0.02;
/// Largest target depth of the disc, metres. The press ends there in any case.
const MOST_PRESS: f64 = 40e-3;
/// Speed of the push aside, m/s.
const ASIDE_SPEED: f64 = 6e-3;
/// Speed of the release, m/s.
const LET_GO_SPEED: f64 = 80e-3;

/// Part of the tongue that can be held, as shares of its length from behind.
const WORKABLE: [f64; 2] = [0.4, 0.75];

/// Phase of the hand's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Press,
    Aside,
    /// Time left, seconds.
    Hold(f64),
    /// Index of the present target of the slide.
    Slide(usize),
    LetGo,
    /// Time left, seconds.
    Rest(f64),
}

/// Script of the `retraction` exercise.
#[derive(Clone, Debug)]
pub struct Retraction {
    params: RetractionParams,
    slot: usize,
    /// Length of a tick, seconds.
    dt: f64,
    tool: ToolFrame,
    /// Centre of the disc in the tool's frame, metres.
    disc: Vec3,
    /// Centre of the disc at the first touch of its face, world, metres.
    touch: Vec3,
    /// Unit vector into the tongue, world.
    inward: Vec3,
    /// Unit vector sideways in the plane of the disc, world.
    sideways: Vec3,
    /// Unit vector along the tongue, world.
    along: Vec3,
    /// Distance from the disc's centre to its far edge, metres.
    reach: f64,
    /// Distance from the disc's centre to its face, metres.
    thickness: f64,
    // The fields below change during the exercise.
    time: f64,
    /// Time at which the retreat begins, seconds.
    leaves: f64,
    phase: Phase,
    /// Filtered force against the press, newtons.
    force: f64,
    /// Number of releases.
    done: u32,
    /// Depth of the disc as drawn, metres.
    seen: f64,
    /// Target of the disc, metres: inward, sideways, along.
    meant: [f64; 3],
}

impl Retraction {
    /// Script for the largest deformable object, with the first tool without bands, which is a mirror.
    ///
    /// # Errors
    /// The scene has no deformable object or no such tool, or the disc does not meet the object from above.
    pub fn new(scene: &Scene, params: RetractionParams) -> Result<Self, NoTongue> {
        let slot = scene
            .tools
            .iter()
            .position(|tool| tool.bands.is_empty())
            .ok_or_else(|| {
                NoTongue(format!(
                    "scene `{}` has no mouth mirror, expected a tool without bands",
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
                    "scene `{}` has no tongue, expected a deformable object",
                    scene.name
                ))
            })?;
        // The flank towards the place or the first tooth, else the left flank.
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
        // The far edge of the disc points into the mouth, the handle out of it.
        let along = -Vec3::x();
        let frame = ToolFrame::of(tool);
        let disc = tool.working_point;
        let reach = (tool.tip - disc).norm();
        let thickness = face_height(tool, &disc, &-frame.basis.column(1).into_owned(), reach);
        let touch =
            touching(tongue, &inward, reach, side * sine, params.work).ok_or_else(|| {
                NoTongue(format!(
                    "the mirror does not meet `{}` from above; expected a tongue whose back faces along z",
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

    /// Centre of the disc's face at the first touch of the tongue at rest, world, metres.
    pub fn touch(&self) -> Vec3 {
        self.touch + self.inward * self.thickness
    }

    /// Device pose (`world_from_tool`) with the disc's face `deep` metres inside the tongue at rest, moved `aside`
    /// metres sideways and `along` metres along the tongue.
    pub fn pose(&self, deep: f64, aside: f64, along: f64) -> Pose {
        let centre = self.touch + self.inward * deep + self.sideways * aside + self.along * along;
        // The tip of the tool is the far edge of the disc; the face points away from the handle.
        let edge = centre + self.along * self.reach;
        self.tool.at(&edge, &self.along, &-self.inward)
    }

    /// Slot of the mirror.
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// Whether the mirror holds the tongue aside.
    pub fn holds(&self) -> bool {
        matches!(self.phase, Phase::Hold(_) | Phase::Slide(_))
    }

    /// Begins the release and the retreat now.
    pub fn let_go(&mut self) {
        self.leaves = self.leaves.min(self.time);
    }

    /// Advances the present phase by one tick.
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
        // The script has its own clock, because another script may start it late.
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

/// Distance from the disc's centre to its pressing face, metres.
fn face_height(tool: &Tool, disc: &Vec3, face: &Vec3, reach: f64) -> f64 {
    tool.tree
        .shape_at(tool.level)
        .filter(|(_, node)| (node.centre - disc).norm() < 0.6 * reach)
        .map(|(_, node)| (node.centre - disc).dot(face) + node.contact_radius)
        .fold(0.0, f64::max)
}

/// Centre of the face of a flat disc of radius `reach` that comes along `inward`, at the first touch of the tongue,
/// world.
///
/// `side` is the position between the middle, 0, and the left flank, 1. `None`: the disc meets nothing.
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
    // The default is a little in front of the middle: the root behind is stiff, and the tip is too thin for the disc.
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
