//! The `probing` exercise: one tooth's buccal sites, as taught. The tip comes over the gingival margin, goes
//! down along the tooth with its side on the surface until the floor gives the force that is taught, is read
//! for a second, then walks on in short bobbing strokes without leaving the pocket.
//!
//! The hand goes by what it feels: it does not know how deep the pocket is. The path is laid on the tooth's own
//! spheres, and the margin is found on those of the gingiva.

use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, Object, Pose, Scene, TICK_S, Tool, Vec3, Wrench};

use crate::frame::ToolFrame;
use crate::script::{Script, smoothstep};
use crate::sounding::{bearing_vector, first_touch, tip_radius};

/// How a pocket is probed. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbingParams {
    /// Length of the exercise, seconds. Default 20.
    pub duration: f64,
    /// Force on the floor at which the hand stops and reads, newtons. Default 0.2: depth is taught to be
    /// read at 0.20 to 0.25 N.
    pub force: f64,
    /// Speed of insertion along the tooth, m/s. Default 3 mm/s.
    pub insert_speed: f64,
    /// How long a reading takes once the force stands, seconds. Default 1.
    pub read: f64,
    /// Height of a bob of the walking stroke. Default 1.5 mm (1 to 2 are taught).
    pub bob: f64,
    /// How far a bob goes on along the margin. Default 1 mm.
    pub advance: f64,
    /// How far inside the tooth's surface the hand means the tip to be, so that its side stays on it. Default
    /// 0.15 mm: about 0.03 N.
    pub hug: f64,
    /// Largest tilt to and fro while reading, towards the tooth and away from it, radians. Default 0; a test of
    /// the pocket takes 10 degrees.
    pub turning: f64,
    /// Bearings of the sites to read, degrees from mesial over buccal, in the order of the visit. Default
    /// distobuccal, buccal, mesiobuccal.
    pub sites: [f64; 3],
    /// Deepest that the hand goes looking for a floor below the margin. Default 12 mm.
    pub deepest: f64,
}

impl Default for ProbingParams {
    fn default() -> Self {
        Self {
            duration: 20.0,
            force: 0.2,
            insert_speed: 3e-3,
            read: 1.0,
            bob: 1.5e-3,
            advance: 1e-3,
            hug: 0.15e-3,
            turning: 0.0,
            sites: [135.0, 90.0, 45.0],
            deepest: 12e-3,
        }
    }
}

/// Why the exercise cannot be performed in a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoPocket(pub String);

/// Time to come in and to leave, seconds.
const TRANSIT: f64 = 1.2;
/// How far above the margin the tip waits.
const ABOVE: f64 = 2e-3;
/// How far outside and above that the approach begins.
const STANDOFF: [f64; 2] = [8e-3, 10e-3];
/// Floor forces count from this depth below the margin on: above it the crown's slope bears too.
const IN_POCKET: f64 = 0.6e-3;
/// Time constant of a hand's sense of force, seconds.
const FEEL: f64 = 0.02;
/// Correction of the press by the force missing, m/(N s): slower than the tremor, faster than a reading.
const CORRECTION: f64 = 0.03;
/// Force that ends the stroke of a bob, as a share of the reading's.
const BOB_FORCE: f64 = 0.6;
/// Speed of bobs, m/s.
const BOB_SPEED: f64 = 8e-3;
/// Period of the tilting to and fro, seconds.
const TILT_PERIOD: f64 = 2.0;
/// Bearings and heights at which the tooth is sounded.
const BEARINGS: usize = 72;
const BEARING_STEP: f64 = 360.0 / BEARINGS as f64;
const HEIGHT_STEP: f64 = 0.25e-3;

/// What the hand is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stroke {
    /// Down until the floor is felt; at a site it is then read.
    Down,
    /// Holding the force for so many seconds yet.
    Read(f64),
    /// Up by the bob; how far is left.
    Up(f64),
    /// On along the margin to a bearing, degrees.
    On(f64),
}

/// The script.
#[derive(Clone, Debug)]
pub struct Probing {
    params: ProbingParams,
    slot: usize,
    tool: ToolFrame,
    tooth: Sounded,
    /// Bearings of the sites to visit, to and fro.
    tour: Vec<f64>,
    /// Radius of the shaft by distance from the tip.
    shaft: Vec<(f64, f64)>,
    // What changes while it is performed.
    time: f64,
    stroke: Stroke,
    stop: usize,
    bearing: f64,
    /// Where the hand means the tip to be below the margin, metres.
    depth: f64,
    force: f64,
    /// Direction out of the tip, world axes.
    pointing: Vec3,
    /// Time spent reading, for the tilting.
    reading: f64,
}

/// The tooth's surface and the margin around it.
#[derive(Clone, Debug)]
struct Sounded {
    axis: Vec3,
    bottom: f64,
    /// Distance from the axis at which the tip's centre touches, by bearing and height above `bottom`.
    radius: Vec<Vec<f64>>,
    margin: [f64; BEARINGS],
}

impl Probing {
    /// The exercise on the tooth with FDI number `fdi`, or the first tooth that has gingiva around it, with the
    /// first tool that has bands, or the first.
    ///
    /// # Errors
    /// When the scene has no tooth, nothing that yields around it, or the tooth has no wall where the sites are.
    pub fn new(scene: &Scene, fdi: Option<u8>, params: ProbingParams) -> Result<Self, NoPocket> {
        let wanted = |object: &&Object| fdi.map_or(object.fdi != 0, |fdi| object.fdi == fdi);
        let is_tooth = |object: &&Object| object.tissue.is_rigid() && wanted(object);
        let tooth = scene.objects.iter().find(is_tooth).ok_or_else(|| {
            NoPocket(format!(
                "scene `{}` has no tooth to probe (a rigid object with an FDI number)",
                scene.name
            ))
        })?;
        let slot = scene
            .tools
            .iter()
            .position(|tool| !tool.bands.is_empty())
            .unwrap_or(0);
        let tool = &scene.tools[slot];
        let sounded = Sounded::of(scene, tooth, tool, &params)?;
        // Buccal is to the patient's left on the left side of the mouth, which y points to.
        let left = matches!(tooth.fdi / 10, 0 | 2 | 3 | 6 | 7);
        let bearing = |site: f64| if left { site } else { 360.0 - site };
        let there: Vec<f64> = params.sites.iter().map(|site| bearing(*site)).collect();
        // To the last site and back, over and over: no site twice in a row.
        let back = there[1..there.len() - 1].iter().rev().copied();
        let tour: Vec<f64> = there.iter().copied().chain(back).collect();
        let frame = ToolFrame::of(tool);
        let shaft = shaft_of(tool);
        Ok(Self {
            slot,
            tool: frame,
            bearing: tour[0],
            tour,
            tooth: sounded,
            shaft,
            time: 0.0,
            stroke: Stroke::Down,
            stop: 0,
            depth: -ABOVE,
            force: 0.0,
            pointing: -Vec3::z(),
            reading: 0.0,
            params,
        })
    }

    /// Tip and pointing for a bearing (degrees), a depth below the margin, and a tilt away from the tooth.
    fn place(&self, bearing: f64, depth: f64, tilt: f64) -> (Vec3, Vec3) {
        let out = bearing_vector(bearing);
        let z = self.tooth.margin_at(bearing) - depth;
        let r = self.tooth.radius_at(bearing, z) - self.params.hug;
        let lean = self.lean(bearing, r, z);
        // The tip stays where it is; the shaft tilts in the plane through the tooth's axis.
        let angle = lean + tilt;
        let up = Vec3::z() * libm::cos(angle) + out * libm::sin(angle);
        let tip = Vec3::new(self.tooth.axis.x, self.tooth.axis.y, z) + out * r;
        (tip, -up)
    }

    /// Smallest outward lean, radians, with which the shaft clears the crown above a tip at `r` and `z`.
    fn lean(&self, bearing: f64, r: f64, z: f64) -> f64 {
        let least = self.shaft[0].1;
        let mut lean: f64 = 0.0;
        for (along, radius) in &self.shaft[1..] {
            let above = z + along;
            if above > self.tooth.top() {
                break;
            }
            let needed = self.tooth.radius_at(bearing, above) + (radius - least) - r;
            lean = lean.max(libm::atan2(needed - self.params.hug, *along));
        }
        lean
    }

    /// Bearing one bob further towards `site`, degrees.
    fn next_bearing(&self, site: f64) -> f64 {
        let z = self.tooth.margin_at(self.bearing) - self.depth.max(0.0);
        let degrees =
            (self.params.advance / self.tooth.radius_at(self.bearing, z).max(1e-3)).to_degrees();
        let way = site - self.bearing;
        if way.abs() <= 1.3 * degrees {
            site
        } else {
            self.bearing + degrees * way.signum()
        }
    }

    /// One millisecond of the stroke under way.
    fn go_on(&mut self) {
        let p = self.params;
        let site = self.tour[self.stop % self.tour.len()];
        let at_site = (self.bearing - site).abs() < 1e-6;
        let in_pocket = self.depth > IN_POCKET;
        match self.stroke {
            Stroke::Down => {
                let enough = if at_site { 0.95 } else { BOB_FORCE } * p.force;
                if (in_pocket && self.force >= enough) || self.depth >= p.deepest {
                    self.stroke = if at_site {
                        self.reading = 0.0;
                        Stroke::Read(p.read)
                    } else {
                        Stroke::Up(p.bob)
                    };
                } else {
                    self.depth += p.insert_speed * TICK_S;
                }
            }
            Stroke::Read(left) => {
                self.depth += CORRECTION * (p.force - self.force) * TICK_S;
                self.depth = self.depth.min(p.deepest);
                self.reading += TICK_S;
                self.stroke = if left > 0.0 {
                    Stroke::Read(left - TICK_S)
                } else {
                    self.stop += 1;
                    Stroke::Up(p.bob)
                };
            }
            Stroke::Up(left) => {
                let step = (BOB_SPEED * TICK_S).min(left);
                self.depth -= step;
                self.stroke = if left > step {
                    Stroke::Up(left - step)
                } else {
                    Stroke::On(self.next_bearing(site))
                };
            }
            Stroke::On(to) => {
                let radius = self.tooth.radius_at(self.bearing, self.tooth.margin_at(to));
                let step = (BOB_SPEED * TICK_S / radius.max(1e-3)).to_degrees();
                let way = to - self.bearing;
                if way.abs() <= step {
                    self.bearing = to;
                    self.stroke = Stroke::Down;
                } else {
                    self.bearing += step * way.signum();
                }
            }
        }
    }
}

impl Script for Probing {
    fn feel(&mut self, felt: &[Wrench; MAX_TOOLS], _: &[Option<Pose>; MAX_TOOLS]) {
        self.time += TICK_S;
        // Against the way in: what the floor pushes back with.
        let along = -felt[self.slot].force.dot(&self.pointing);
        self.force += (along - self.force) * (TICK_S / FEEL);
        let leaves = self.params.duration - TRANSIT;
        if self.time > TRANSIT && self.time < leaves {
            self.go_on();
        } else if self.time >= leaves && self.depth > -ABOVE {
            // Out along the tooth before going away.
            self.depth -= 2.0 * BOB_SPEED * TICK_S;
        }
        let (_, pointing) = self.place(self.bearing, self.depth, 0.0);
        self.pointing = pointing;
    }

    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        let tilt = if matches!(self.stroke, Stroke::Read(_)) {
            self.params.turning * libm::sin(std::f64::consts::TAU * self.reading / TILT_PERIOD)
        } else {
            0.0
        };
        let (tip, pointing) = self.place(self.bearing, self.depth, tilt);
        let out = bearing_vector(self.bearing);
        // Half of the time to leave is for the way out of the pocket.
        let leaving = smoothstep((t - self.params.duration + 0.5 * TRANSIT) / (0.5 * TRANSIT));
        let away = 1.0 - smoothstep(t / TRANSIT) + leaving;
        let tip = tip + (out * STANDOFF[0] + Vec3::z() * STANDOFF[1]) * away.min(1.0);
        let mut targets = [None; MAX_TOOLS];
        targets[self.slot] = Some(self.tool.at(&tip, &pointing, &out));
        targets
    }

    fn duration_s(&self) -> f64 {
        self.params.duration
    }
}

impl Sounded {
    fn of(
        scene: &Scene,
        tooth: &Object,
        tool: &Tool,
        params: &ProbingParams,
    ) -> Result<Self, NoPocket> {
        let spheres: Vec<_> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| node.sphere())
            .collect();
        let huge = Vec3::repeat(f64::INFINITY);
        let (low, high) = spheres.iter().fold((huge, -huge), |(low, high), s| {
            let r = Vec3::repeat(s.radius);
            (low.inf(&(s.centre - r)), high.sup(&(s.centre + r)))
        });
        let mut axis = (low + high) * 0.5;
        axis.z = 0.0;
        let gingiva = gingiva_around(scene, &axis).ok_or_else(|| {
            NoPocket(format!(
                "scene `{}` has no gingiva around tooth `{}` (an object that yields)",
                scene.name, tooth.name
            ))
        })?;
        let tip_radius = tip_radius(tool);
        let heights = ((high.z - low.z) / HEIGHT_STEP).ceil() as usize + 1;
        let mut radius = Vec::with_capacity(BEARINGS);
        for b in 0..BEARINGS {
            let out = bearing_vector(b as f64 * BEARING_STEP);
            let at = |k: usize| {
                let centre = Vec3::new(axis.x, axis.y, low.z + k as f64 * HEIGHT_STEP);
                spheres
                    .iter()
                    .filter_map(|s| first_touch(&centre, &out, &s.centre, s.radius + tip_radius))
                    .fold(0.0, f64::max)
            };
            radius.push((0..heights).map(at).collect());
        }
        let mut sounded = Self {
            axis,
            bottom: low.z,
            radius,
            margin: [f64::NEG_INFINITY; BEARINGS],
        };
        // The margin is the highest gingiva close to the tooth.
        for (_, node) in gingiva.tree.shape_at(gingiva.level) {
            let from = node.centre - axis;
            let bearing = libm::atan2(from.y, from.x).to_degrees().rem_euclid(360.0);
            let distance = libm::hypot(from.x, from.y) - node.contact_radius;
            if distance > sounded.radius_at(bearing, node.centre.z) + 1.5e-3 {
                continue;
            }
            let b = (bearing / BEARING_STEP).round() as usize;
            for near in [b + BEARINGS - 1, b, b + 1] {
                let margin = &mut sounded.margin[near % BEARINGS];
                *margin = margin.max(node.centre.z + node.contact_radius);
            }
        }
        for site in params.sites {
            let b = (site / BEARING_STEP).round() as usize % BEARINGS;
            if !sounded.margin[b].is_finite() {
                return Err(NoPocket(format!(
                    "gingiva `{}` has no margin at {site} degrees round tooth `{}`",
                    gingiva.name, tooth.name
                )));
            }
        }
        Ok(sounded)
    }

    fn top(&self) -> f64 {
        self.bottom + (self.radius[0].len() - 1) as f64 * HEIGHT_STEP
    }

    /// Distance from the axis at which the tip's centre touches.
    fn radius_at(&self, bearing: f64, z: f64) -> f64 {
        let rows = self.radius[0].len();
        let row = ((z - self.bottom) / HEIGHT_STEP).clamp(0.0, (rows - 1) as f64);
        let (k, f) = (row.floor() as usize, row - row.floor());
        around(bearing, |b| {
            self.radius[b][k] * (1.0 - f) + self.radius[b][(k + 1).min(rows - 1)] * f
        })
    }

    fn margin_at(&self, bearing: f64) -> f64 {
        around(bearing, |b| self.margin[b])
    }
}

/// Linear between the bearings that were sounded.
fn around(bearing: f64, value: impl Fn(usize) -> f64) -> f64 {
    let at = bearing.rem_euclid(360.0) / BEARING_STEP;
    let (b, f) = (at.floor() as usize % BEARINGS, at - at.floor());
    value(b) * (1.0 - f) + value((b + 1) % BEARINGS) * f
}

/// The yielding object whose middle is nearest to a tooth's axis.
fn gingiva_around<'a>(scene: &'a Scene, axis: &Vec3) -> Option<&'a Object> {
    let middle = |object: &Object| {
        let root = &object.tree.nodes()[0].centre;
        let from = root - axis;
        norm(&Vec3::new(from.x, from.y, 0.0))
    };
    scene
        .objects
        .iter()
        .filter(|object| !object.tissue.is_rigid())
        .min_by(|a, b| middle(a).total_cmp(&middle(b)))
}

/// Largest radius of the working end by distance from the tip, every half millimetre: how far its surface is
/// from the straight line out of the tip.
fn shaft_of(tool: &Tool) -> Vec<(f64, f64)> {
    const STEP: f64 = 0.5e-3;
    let back = -tool.tip_axis;
    let mut shaft: Vec<(f64, f64)> = (0..32).map(|k| (f64::from(k) * STEP, 0.0)).collect();
    for (_, node) in tool.tree.shape_at(tool.level) {
        let from = node.centre - tool.tip;
        let along = from.dot(&back);
        let k = (along / STEP).round();
        if k >= 0.0 && k < shaft.len() as f64 {
            let off = norm(&(from - back * along)) + node.contact_radius;
            let radius = &mut shaft[k as usize].1;
            *radius = radius.max(off);
        }
    }
    // No sphere at a distance means no more than beside it.
    for k in 1..shaft.len() {
        shaft[k].1 = shaft[k].1.max(shaft[k - 1].1);
    }
    shaft
}
