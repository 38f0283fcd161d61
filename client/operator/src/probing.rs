//! The `probing` exercise: one tooth's buccal sites, as taught. The tip comes over the gingival margin, goes
//! down along the tooth with its side on the surface until the floor gives the force that is taught, is read
//! for a second, then walks on in short bobbing strokes without leaving the pocket.
//!
//! The hand goes by what it feels: it does not know how deep the pocket is. The path is laid on the tooth's own
//! spheres, and the margin is found on those of the gingiva.

use sulcus_core::{MAX_TOOLS, Pose, Scene, TICK_S, Vec3, Wrench};

use crate::pocket_path::{NoPocket, PocketPath};
use crate::script::{Script, smoothstep};
use crate::sounding::bearing_vector;

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
    /// Bearings of the sites to read, degrees from mesial over buccal, in the order of the visit (see [`PocketPath::bearing`]). Default
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
    path: PocketPath,
    /// Bearings of the sites to visit, to and fro.
    tour: Vec<f64>,
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

impl Probing {
    /// The exercise on the tooth with FDI number `fdi`, or the first tooth that has gingiva around it, with the
    /// first tool that has bands, or the first.
    ///
    /// # Errors
    /// When the scene has no tooth, nothing that yields around it, or the tooth has no wall where the sites are.
    pub fn new(scene: &Scene, fdi: Option<u8>, params: ProbingParams) -> Result<Self, NoPocket> {
        let path = PocketPath::new(scene, fdi, params.hug)?;
        let there = params.sites.map(|site| path.bearing(site));
        if let Some(closed) = there.iter().find(|bearing| !path.is_open(**bearing)) {
            return Err(NoPocket(format!(
                "the gingiva in scene `{}` has no margin at {closed} degrees round the tooth",
                scene.name
            )));
        }
        // To the last site and back, over and over: no site twice in a row.
        let back = there[1..there.len() - 1].iter().rev().copied();
        let tour: Vec<f64> = there.iter().copied().chain(back).collect();
        Ok(Self {
            path,
            bearing: tour[0],
            tour,
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

    /// Bearing one bob further towards `site`, degrees.
    fn next_bearing(&self, site: f64) -> f64 {
        let radius = self.path.radius(self.bearing, self.depth.max(0.0));
        let degrees = (self.params.advance / radius.max(1e-3)).to_degrees();
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
                let radius = self.path.radius(self.bearing, 0.0);
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
        let along = -felt[self.path.slot].force.dot(&self.pointing);
        self.force += (along - self.force) * (TICK_S / FEEL);
        let leaves = self.params.duration - TRANSIT;
        if self.time > TRANSIT && self.time < leaves {
            self.go_on();
        } else if self.time >= leaves && self.depth > -ABOVE {
            // Out along the tooth before going away.
            self.depth -= 2.0 * BOB_SPEED * TICK_S;
        }
        let (_, pointing) = self.path.place(self.bearing, self.depth, 0.0);
        self.pointing = pointing;
    }

    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        let tilt = if matches!(self.stroke, Stroke::Read(_)) {
            self.params.turning * libm::sin(std::f64::consts::TAU * self.reading / TILT_PERIOD)
        } else {
            0.0
        };
        let out = bearing_vector(self.bearing);
        // Half of the time to leave is for the way out of the pocket.
        let leaving = smoothstep((t - self.params.duration + 0.5 * TRANSIT) / (0.5 * TRANSIT));
        let away = 1.0 - smoothstep(t / TRANSIT) + leaving;
        let off = (out * STANDOFF[0] + Vec3::z() * STANDOFF[1]) * away.min(1.0);
        let mut targets = [None; MAX_TOOLS];
        targets[self.path.slot] = Some(self.path.pose(self.bearing, self.depth, tilt, off));
        targets
    }

    fn duration_s(&self) -> f64 {
        self.params.duration
    }
}
