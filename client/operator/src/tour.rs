//! Whole teeth probed in turn. On each side of a tooth the tip goes in once, walks from zone to zone in short bobs without
//! leaving the pocket, comes back to the deepest place of each zone, is read there, and a depth is called.
//!
//! The hand goes by what it feels and the eye by what it sees: neither knows how deep a pocket is. The path is laid on the
//! teeth's own spheres, and the margin is what is seen of the gingiva.

use std::f64::consts::{PI, TAU};

use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Pose, Scene, TICK_S, Tool, Vec3};

use crate::bands::{self, Blur};
use crate::pocket_path::{NoPocket, PocketPath};
use crate::script::{Call, Felt, Script};
use crate::stops::{Walk, Zone, zones};
use crate::tour_params::{TourParams, Visit};
use crate::travel::Travel;

/// How far above the margin the tip waits, metres.
const ABOVE: f64 = 2e-3;
/// How far above the crown it travels, and how far outside; on long ways as far again.
const OVER: f64 = 3e-3;
const OUTSIDE: f64 = 2e-3;
const LONG_WAY: f64 = 15e-3;
/// Forces count as a floor's from this depth seen below the margin on, metres.
const IN_POCKET: f64 = 0.3e-3;
/// How far below margin and neighbours the tip stays between two places, metres; in a shallow sulcus it comes up by half.
const BELOW: f64 = 0.25e-3;
const SHALLOW: f64 = 0.6;
/// Farthest that the hand means the tip to be from where it is seen, metres, and how fast it makes up for it, 1/s.
const STUCK: f64 = 0.7e-3;
const HOLD: f64 = 12.0;
/// Fastest that the handle swings while the tip is in a pocket, m/s.
const HANDLE_SPEED: f64 = 50e-3;
/// How fast the hand brings a tip back that is pushed aside, 1/s, and how far it means it to be then, metres.
const KEEP: f64 = 6.0;
const MOST_ASIDE: f64 = 1.2e-3;
/// Speed at which the hand gives way to a floor that comes up, m/s.
const GIVE: f64 = 8e-3;
/// How fast a way up ends, 1/s.
const NEAR: f64 = 40.0;
/// Time constant of a hand's sense of force, seconds.
const FEEL: f64 = 0.02;
/// Correction of the press by the force missing, m/(N s): slower than the tremor, faster than a reading.
const CORRECTION: f64 = 0.05;
/// A reading counts while the force is so near to what is meant, share.
const STEADY: f64 = 0.15;
/// Most that walls are taken to push back with, newtons.
const MOST_WALLS: f64 = 0.2;
/// A tip that is caught on something before it is in a pocket is pressed no harder than this many times a floor.
const CAUGHT: f64 = 3.0;
/// A tip this far out from where it lies on the tooth is no longer between tooth and gingiva, metres.
const SLIPPED: f64 = 0.9e-3;
/// Nearest to the mesial or distal midline that the hand means the tip to be, radians.
const MIDLINE: f64 = 0.02;
/// Fastest change of tilt, rad/s.
const TURN: f64 = 1.5;
/// Longest that a hand tries for a steady force, in lengths of a reading.
const PATIENCE: f64 = 4.0;
/// Time constant of an eye, seconds.
const LOOK: f64 = 0.1;
/// Time to come out of the mouth, seconds.
const LEAVING: f64 = 2.5;
/// Most that a zone and an insertion take, seconds, for the length of the script.
const MOST_ZONE: f64 = 14.0;
const MOST_INSERTION: f64 = 8.0;

/// One side of a tooth.
#[derive(Clone, Debug)]
struct Insertion {
    path: usize,
    zones: Vec<Zone>,
}

/// What the hand is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stroke {
    /// Through the air to where the next insertion begins, or away.
    Travel,
    /// Down until the floor is felt.
    Down,
    /// Up until the tip is seen at a depth, then on along the tooth to an angle.
    Up(f64, f64),
    /// On along the tooth, at that depth as seen, to that angle.
    On(f64, f64),
    /// Holding the force until it stood for so many seconds; time spent trying.
    Read(f64, f64),
    /// Up and out of the pocket.
    Out,
    /// All is done.
    Rest,
}

/// The script.
#[derive(Clone, Debug)]
pub struct Tour {
    params: TourParams,
    tool: Tool,
    slot: usize,
    paths: Vec<PocketPath>,
    insertions: Vec<Insertion>,
    blur: Option<Blur>,
    calls: Vec<Call>,
    // What changes while it is performed.
    time: f64,
    /// Whether the time is up.
    over: bool,
    travel: Travel,
    stroke: Stroke,
    /// Insertion, zone and stop under way.
    now: [usize; 3],
    /// Whether the zone's deepest place is being gone back to, and whether the insertion is at its end.
    returning: bool,
    leaving: bool,
    /// Angles and depths at which the floor was felt in this insertion.
    felt: Vec<(f64, f64)>,
    /// Where the hand means the tip to be.
    around: f64,
    depth: f64,
    tilt: f64,
    /// How far the hand means the tip to be aside of there, radians, to make up for what pushes it aside.
    aside: f64,
    /// Where to go on once the floor is felt again, after the tip had slipped out.
    resumes: Option<f64>,
    /// What resists the way in, newtons.
    force: f64,
    /// What of that is the walls': least felt on this way down.
    walls: f64,
    /// Where the eye sees the tip below the margin.
    seen: f64,
    /// How long a part of the working end it sees there.
    length: f64,
}

impl Tour {
    /// Probes `tour` in its order with the first tool that has bands.
    ///
    /// # Errors
    /// When the scene lacks a tooth of the tour or its gingiva, or there is nothing to do.
    pub fn new(scene: &Scene, tour: &[Visit], params: TourParams) -> Result<Self, NoPocket> {
        let mut paths: Vec<PocketPath> = Vec::new();
        let mut insertions = Vec::new();
        let walk = Walk {
            advance: params.advance,
            col: params.col,
            single: params.single,
        };
        for visit in tour {
            let path = match paths.iter().position(|path| path.fdi == visit.tooth) {
                Some(path) => path,
                None => {
                    let fdi = Some(visit.tooth);
                    paths.push(PocketPath::new(scene, fdi, params.hug, params.manner)?);
                    paths.len() - 1
                }
            };
            let once = |a: &Site, b: &Site| !params.single && a.is_buccal() == b.is_buccal();
            for sites in visit.sites.chunk_by(once) {
                let mut zones = zones(&paths[path], sites, &walk);
                // In where there is room above, then on.
                let (first, entry) = (zones[0].stops[0], free(&paths[path], zones[0].stops[0]));
                if entry != first {
                    zones[0].stops.insert(0, entry);
                }
                insertions.push(Insertion { path, zones });
            }
        }
        let Some(first) = insertions.first() else {
            return Err(NoPocket("a tour wants at least one site of a tooth".into()));
        };
        let slot = paths[0].slot;
        let around = first.zones[0].stops[0];
        let mut tour = Self {
            tool: scene.tools[slot].clone(),
            slot,
            blur: params.misread.map(Blur::new),
            calls: Vec::new(),
            time: 0.0,
            over: false,
            travel: Travel::at(Pose::identity()),
            stroke: Stroke::Travel,
            now: [0; 3],
            returning: false,
            leaving: false,
            felt: Vec::new(),
            around,
            depth: -ABOVE,
            tilt: 0.0,
            aside: 0.0,
            resumes: None,
            force: 0.0,
            walls: 0.0,
            seen: 0.0,
            length: 0.0,
            params,
            paths,
            insertions,
        };
        tour.travel = Travel::at(tour.over(around, 2.0));
        tour.travel.then(tour.over(around, 1.0), params.air_speed);
        tour.travel.then(tour.meant(), params.air_speed);
        Ok(tour)
    }

    /// Share of the insertions that are begun, 0 to 1.
    pub fn progress(&self) -> f64 {
        self.now[0] as f64 / self.insertions.len() as f64
    }

    /// FDI number of the tooth at hand or headed for; none when all are done.
    pub fn tooth(&self) -> Option<u8> {
        let insertion = self.insertions.get(self.now[0])?;
        Some(self.paths[insertion.path].fdi)
    }

    /// Where a tooth of the tour stands: the origin of its frame, world.
    pub fn origin_of(&self, fdi: u8) -> Option<Vec3> {
        let path = self.paths.iter().find(|path| path.fdi == fdi)?;
        Some(path.tooth().origin)
    }

    /// Whether the tip is out of every pocket, on its way.
    pub fn is_outside(&self) -> bool {
        matches!(self.stroke, Stroke::Travel | Stroke::Rest)
    }

    /// The ways that it goes, one for each tooth.
    pub fn paths(&self) -> &[PocketPath] {
        &self.paths
    }

    fn path(&self) -> &PocketPath {
        &self.paths[self.insertions[self.now[0]].path]
    }

    fn zone(&self) -> &Zone {
        &self.insertions[self.now[0]].zones[self.now[1]]
    }

    /// Where the hand means to be in and at the pocket.
    fn meant(&self) -> Pose {
        let off = Vec3::zeros();
        // Never over to the other side of the tooth, where the shaft leans the other way.
        let side = self.around.signum();
        let around = side * (side * (self.around + self.aside)).clamp(MIDLINE, PI - MIDLINE);
        // As high as where it means the tip to be: aside of there the margin is another.
        let gingiva = self.path().gingiva();
        let rise = gingiva.margin_at(around) - gingiva.margin_at(self.around);
        self.path().pose(around, self.depth + rise, self.tilt, off)
    }

    /// Over the crown at an angle; `times` as far as usual.
    fn over(&self, around: f64, times: f64) -> Pose {
        let path = self.path();
        let place = path.place(around, -ABOVE, 0.0);
        let climb = (-ABOVE - path.over(around)).max(0.0) + OVER * times;
        let off = path.tooth().axis * climb + place.outward * OUTSIDE;
        path.pose(around, -ABOVE, 0.0, off)
    }

    /// Shallowest depth that the tip may have at an angle without leaving the pocket or meeting a neighbour.
    fn ceiling(&self, around: f64) -> f64 {
        let room = self.path().ceiling(around);
        room.map_or(BELOW, |ceiling| ceiling.max(0.0) + BELOW)
    }

    /// Depth at which the way to `to` is free as far as the floor is known.
    fn clear_to(&self, to: f64) -> f64 {
        let (low, high) = (self.around.min(to) - 1e-6, self.around.max(to) + 1e-6);
        let passed = self.felt.iter().filter(|(at, _)| (low..=high).contains(at));
        let shallowest = passed.fold(self.seen, |least, (_, depth)| least.min(*depth));
        let ceiling = self.ceiling(self.around).max(self.ceiling(to));
        (shallowest - self.params.bob)
            .max(SHALLOW * shallowest)
            .max(ceiling)
    }

    /// What the hand takes for the floor's push, newtons.
    fn floor_force(&self) -> f64 {
        self.force - self.walls.clamp(0.0, MOST_WALLS)
    }

    /// One millisecond of the stroke under way.
    fn go_on(&mut self) {
        let p = self.params;
        match self.stroke {
            Stroke::Travel => {
                if self.travel.step() {
                    let all = self.insertions.len();
                    self.walls = f64::INFINITY;
                    self.stroke = if self.now[0] < all {
                        Stroke::Down
                    } else {
                        Stroke::Rest
                    };
                }
            }
            Stroke::Down => {
                self.walls = self.walls.min(self.force);
                let enough = if self.returning {
                    0.95 * p.force
                } else {
                    p.turn_force
                };
                let floor = self.seen > IN_POCKET && self.floor_force() >= enough;
                if floor || self.force >= CAUGHT * enough || self.depth >= p.deepest {
                    self.reached();
                } else {
                    let speed = if self.felt.is_empty() {
                        p.insert_speed
                    } else {
                        p.walk_speed
                    };
                    // The more it feels the slower it goes.
                    let share = (1.2 - self.floor_force() / enough).clamp(0.2, 1.0);
                    let down = speed * share * TICK_S;
                    self.depth += down * self.paced(0.0, down);
                }
            }
            Stroke::Up(held, to) => {
                let near = NEAR * (self.seen - held) + 1e-3;
                let up = p.bob_speed.min(near) * TICK_S;
                self.depth -= up * self.paced(0.0, -up);
                if self.seen <= held || self.depth <= held - STUCK {
                    self.stroke = Stroke::On(held, to);
                }
            }
            Stroke::On(held, to) => {
                let radius = self.path().radius(self.around, self.depth).max(1e-3);
                let (step, way) = (p.bob_speed * TICK_S / radius, to - self.around);
                let step = step * self.paced(step * way.signum(), 0.0);
                // The walls lift the tip; where the floor comes up it is let be lifted.
                let hit = self.force > p.turn_force;
                let pull = if hit {
                    -GIVE
                } else {
                    HOLD * (held - self.seen)
                };
                let wanted = (self.depth + pull * TICK_S).clamp(held - STUCK, held + STUCK);
                // (A hand that pressed against a wall comes back as fast as it goes up, not at once.)
                let most = p.bob_speed * TICK_S;
                self.depth += (wanted - self.depth).clamp(-most, most);
                if way.abs() > step {
                    // It waits until it is clear, or as clear as it gets.
                    let waits = hit && self.depth > held - STUCK;
                    self.around += if waits { 0.0 } else { step * way.signum() };
                } else {
                    self.around = to;
                    self.walls = f64::INFINITY;
                    self.stroke = if self.leaving {
                        Stroke::Out
                    } else {
                        Stroke::Down
                    };
                }
            }
            Stroke::Read(left, tried) => {
                self.depth += CORRECTION * (p.force - self.floor_force()) * TICK_S;
                self.depth = self.depth.min(p.deepest);
                let steady = (self.floor_force() - p.force).abs() < STEADY * p.force;
                let left = if steady { left - TICK_S } else { left };
                self.stroke = Stroke::Read(left, tried + TICK_S);
                if left <= 0.0 || tried > PATIENCE * p.read {
                    self.call();
                }
            }
            Stroke::Out => {
                self.depth -= 2.0 * p.bob_speed * TICK_S;
                if self.depth > -ABOVE {
                    return;
                }
                if self.resumes.is_some() {
                    // Back in where there is room above.
                    let mut travel = Travel::at(self.meant());
                    self.around = free(self.path(), self.around);
                    (self.aside, self.tilt) = (0.0, 0.0);
                    travel.then(self.meant(), p.air_speed);
                    self.travel = travel;
                    self.stroke = Stroke::Travel;
                } else {
                    self.go_away();
                }
            }
            Stroke::Rest => {}
        }
    }

    /// The share of a step (radians along the tooth, metres down) that the hand can make: the handle swings far where the
    /// probe has to turn, and a hand that follows late there pulls the tip away.
    fn paced(&self, along: f64, down: f64) -> f64 {
        let at = |around: f64, depth: f64| {
            let off = Vec3::zeros();
            self.path().pose(around, depth, self.tilt, off).position
        };
        let way = at(self.around + along, self.depth + down) - at(self.around, self.depth);
        (HANDLE_SPEED * TICK_S / way.norm().max(1e-9)).min(1.0)
    }

    /// The floor was felt at a stop: what comes next.
    fn reached(&mut self) {
        if let Some(to) = self.resumes.take() {
            self.go_to(to);
            return;
        }
        if self.returning {
            self.stroke = Stroke::Read(self.params.read, 0.0);
            return;
        }
        let zone = self.zone();
        let (site, walked) = (zone.site, zone.stops.len());
        let next = zone.stops.get(self.now[2] + 1).copied();
        self.felt.push((self.around, self.seen));
        if let Some(next) = next {
            self.now[2] += 1;
            self.go_to(next);
            return;
        }
        self.returning = true;
        let gingiva = self.path().gingiva();
        let ours = self.felt[self.felt.len() - walked..].iter();
        let ours = ours.filter(|(around, _)| gingiva.site_at(*around) == site);
        let here = (self.around, self.seen);
        let deepest = ours.fold(here, |best, at| if at.1 > best.1 { *at } else { best });
        if !self.params.returns || deepest.0 == self.around {
            self.stroke = Stroke::Down;
        } else {
            self.go_to(deepest.0);
        }
    }

    /// Up, and along the tooth to an angle.
    fn go_to(&mut self, to: f64) {
        self.stroke = Stroke::Up(self.clear_to(to), to);
    }

    /// Calls what is read here, and goes on to the next zone or out.
    fn call(&mut self) {
        let right = bands::read(&self.tool.bands, self.length);
        let depth_mm = match &mut self.blur {
            Some(blur) => blur.call(&self.tool.bands, right),
            None => right,
        };
        self.calls.push(Call {
            tooth: self.path().fdi,
            site: self.zone().site,
            depth_mm,
        });
        self.returning = false;
        let next = self.insertions[self.now[0]].zones.get(self.now[1] + 1);
        if let Some(next) = next.map(|zone| zone.stops[0]) {
            self.now = [self.now[0], self.now[1] + 1, 0];
            self.go_to(next);
        } else {
            self.leaving = true;
            self.go_to(free(self.path(), self.around));
        }
    }

    /// The eye sees the tip at an angle and a distance from the tooth's axis, metres: where it has slipped out of the pocket, over
    /// the margin, it is taken up and put in again.
    fn see_to_it(&mut self, at: f64, radius: f64) {
        let walking = match self.stroke {
            Stroke::Down => !self.felt.is_empty(),
            Stroke::Up(..) | Stroke::On(..) | Stroke::Read(..) => true,
            Stroke::Travel | Stroke::Out | Stroke::Rest => false,
        };
        if !walking || radius - self.path().radius(at, self.seen) < SLIPPED {
            return;
        }
        let to = match self.stroke {
            Stroke::Up(_, to) | Stroke::On(_, to) => to,
            _ => self.around,
        };
        // On the way out it just goes out.
        self.resumes = (!self.leaving).then_some(to);
        self.stroke = Stroke::Out;
    }

    /// The time is up: the tip comes out, and this insertion was the last one.
    pub fn break_off(&mut self) {
        self.over = true;
        let begun = (self.now[0] + 1).min(self.insertions.len());
        self.insertions.truncate(begun);
        let inside = !matches!(self.stroke, Stroke::Travel | Stroke::Out | Stroke::Rest);
        if inside && !self.leaving {
            self.leaving = true;
            self.go_to(free(self.path(), self.around));
        }
    }

    /// From over the margin to the next insertion, or away.
    fn go_away(&mut self) {
        let speed = self.params.air_speed;
        let here = self.around;
        let mut travel = Travel::at(self.meant());
        travel.then(self.over(here, 1.0), speed);
        let high = self.over(here, 2.0);
        self.leaving = false;
        self.felt.clear();
        self.stroke = Stroke::Travel;
        if self.now[0] + 1 == self.insertions.len() {
            travel.then(high, speed);
            self.now[0] += 1;
        } else {
            self.now = [self.now[0] + 1, 0, 0];
            self.around = self.zone().stops[0];
            self.tilt = 0.0;
            let next = self.over(self.around, 1.0);
            if (next.position - high.position).norm() > LONG_WAY {
                travel.then(high, speed);
                travel.then(self.over(self.around, 2.0), speed);
            }
            travel.then(next, speed);
            travel.then(self.meant(), speed);
        }
        self.travel = travel;
    }
}

impl Script for Tour {
    fn feel(&mut self, felt: &Felt) {
        if self.is_done() {
            return;
        }
        self.time += TICK_S;
        if self.time >= self.params.duration - LEAVING {
            self.break_off();
        }
        if self.now[0] < self.insertions.len() {
            let place = self.path().place(self.around, self.depth, self.tilt);
            // Against the way in: what the floor pushes back with.
            let along = -felt.shown.wrenches[self.slot].force.dot(&place.inwards);
            self.force += (along - self.force) * (TICK_S / FEEL);
            if let Some(graphic) = &felt.shown.graphics[self.slot] {
                let (at, seen) = self.path().seen(&graphic.transform(&self.tool.tip));
                self.seen = seen;
                // The floor slopes; the hand keeps the tip where it means to be.
                let turned = at - self.around;
                let off = turned - TAU * (turned / TAU).round();
                let radius = self.path().radius(self.around, self.depth).max(1e-3);
                let most = MOST_ASIDE / radius;
                self.aside = match self.stroke {
                    Stroke::Travel => 0.0,
                    // (Let go of gently: all at once the handle would swing by millimetres.)
                    Stroke::Out => self.aside * (1.0 - KEEP * TICK_S),
                    _ => (self.aside - KEEP * off * TICK_S).clamp(-most, most),
                };
                self.see_to_it(
                    at,
                    radius_seen(self.path(), &graphic.transform(&self.tool.tip)),
                );
                let length = bands::below_margin(self.path(), &self.tool, graphic);
                self.length += (length - self.length) * (TICK_S / LOOK);
            }
            let mid = !self.zone().site.is_proximal() && self.stroke != Stroke::Travel;
            let tilt = if mid { self.params.tilt } else { 0.0 };
            self.tilt += (tilt - self.tilt).clamp(-TURN * TICK_S, TURN * TICK_S);
        }
        self.go_on();
    }

    fn targets(&self, _: f64) -> [Option<Pose>; MAX_TOOLS] {
        let mut targets = [None; MAX_TOOLS];
        targets[self.slot] = Some(match self.stroke {
            Stroke::Travel | Stroke::Rest => self.travel.pose(),
            _ => self.meant(),
        });
        targets
    }

    fn duration_s(&self) -> f64 {
        let zones: usize = self
            .insertions
            .iter()
            .map(|insertion| insertion.zones.len())
            .sum();
        let most = zones as f64 * MOST_ZONE + self.insertions.len() as f64 * MOST_INSERTION;
        most.min(self.params.duration)
    }

    fn calls(&mut self) -> Vec<Call> {
        std::mem::take(&mut self.calls)
    }

    fn is_done(&self) -> bool {
        self.stroke == Stroke::Rest
    }
}

/// How far a point is from the tooth's axis, metres.
fn radius_seen(path: &PocketPath, point: &Vec3) -> f64 {
    let from = point - path.tooth().origin;
    (from - path.tooth().axis * from.dot(&path.tooth().axis)).norm()
}

/// The nearest angle towards the middle of the side at which the tip can go straight up and out.
fn free(path: &PocketPath, around: f64) -> f64 {
    let middle = around.signum() * 0.5 * std::f64::consts::PI;
    let step = (middle - around).signum() * 1f64.to_radians();
    let is_free = |at: f64| path.ceiling(at).is_some_and(|ceiling| ceiling <= -ABOVE);
    let mut at = around;
    while !is_free(at) && (middle - at).abs() > step.abs() {
        at += step;
    }
    at
}
