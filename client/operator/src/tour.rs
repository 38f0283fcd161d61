//! Whole teeth probed in turn. On each side of a tooth the tip goes in once, walks from zone to zone in short bobs without
//! leaving the pocket, comes back to the deepest place of each zone, is read there, and a depth is called.
//!
//! The hand goes by what it feels and the eye by what it sees: neither knows how deep a pocket is. The path is laid on the
//! teeth's own spheres, and the margin is what is seen of the gingiva.

mod strokes;

use std::f64::consts::{PI, TAU};

use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Pose, Scene, Tool, Vec3};

use crate::bands::{self, Blur};
use crate::pocket_path::{Manner, NoPocket, PocketPath};
use crate::script::{Call, Felt, Script};
use crate::stops::{Walk, Zone, zones};
use crate::tour_params::{TourParams, Visit};
use crate::travel::Travel;
use strokes::Stroke;

/// How far above the margin the tip waits, metres.
const ABOVE: f64 = 2e-3;
/// How far above the crown it travels, and how far outside.
const OVER: f64 = 3e-3;
const OUTSIDE: f64 = 2e-3;
/// How far below margin and neighbours the tip stays between two places, metres.
const BELOW: f64 = 0.25e-3;
/// How fast the hand brings a tip back that is pushed aside, 1/s, and how far it means it to be then, metres.
const KEEP: f64 = 6.0;
const MOST_ASIDE: f64 = 1.2e-3;
/// Time constant of a hand's sense of force, seconds.
const FEEL: f64 = 0.02;
/// Nearest to the mesial or distal midline that the hand means the tip to be, radians.
const MIDLINE: f64 = 0.02;
/// Fastest change of tilt, rad/s.
const TURN: f64 = 1.5;
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

/// The script.
#[derive(Clone, Debug)]
pub struct Tour {
    params: TourParams,
    tool: Tool,
    slot: usize,
    /// Length of a tick, seconds.
    dt: f64,
    paths: Vec<PocketPath>,
    insertions: Vec<Insertion>,
    blur: Option<Blur>,
    calls: Vec<Call>,
    // What changes while it is performed.
    time: f64,
    travel: Travel,
    stroke: Stroke,
    /// Insertion, zone and stop under way.
    now: [usize; 3],
    /// Whether the zone's deepest place is being gone back to, and whether the insertion is at its end.
    returning: bool,
    leaving: bool,
    /// Angles and depths at which the floor was felt in this insertion, and whether the tip was seen in the zone then.
    felt: Vec<(f64, f64, bool)>,
    /// Angle at which the tip is seen.
    at: f64,
    /// Where the hand means the tip to be.
    around: f64,
    depth: f64,
    tilt: f64,
    /// How far the hand means the tip to be aside of there, radians, to make up for what pushes it aside.
    aside: f64,
    /// How far along the tooth the tip is seen from where the hand means it to be, and how far out from where it lies on the
    /// tooth, metres.
    beside: f64,
    away: f64,
    /// How long the hand has waited for the tip to come along, seconds, and how often it was put in again for one stop.
    waited: f64,
    again: u8,
    /// Where to go on once the floor is felt again, after the tip had slipped out.
    resumes: Option<f64>,
    /// Resistance that the hand feels along the probe, newtons.
    force: f64,
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
            dt: scene.tick_s(),
            blur: params.misread.map(Blur::new),
            calls: Vec::new(),
            time: 0.0,
            travel: Travel::at(Pose::identity()),
            stroke: Stroke::Travel,
            now: [0; 3],
            returning: false,
            leaving: false,
            felt: Vec::new(),
            at: around,
            around,
            depth: -ABOVE,
            tilt: 0.0,
            aside: 0.0,
            beside: 0.0,
            away: 0.0,
            waited: 0.0,
            again: 0,
            resumes: None,
            force: 0.0,
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

    /// How far the tip is out from where it would lie on the tooth at the angle and depth at which it is seen, metres.
    fn away(&self, graphic: &Pose) -> f64 {
        let from = graphic.transform(&self.tool.tip) - self.path().tooth().origin;
        let axis = self.path().tooth().axis;
        (from - axis * from.dot(&axis)).norm() - self.path().radius(self.at, self.seen)
    }

    /// Whether the hand leans and looks as taught.
    fn is_taught(&self) -> bool {
        self.params.manner == Manner::Taught
    }

    /// Whether the hand keeps the tip from sliding on to where the walk into the col ended.
    fn holds_back(&self) -> bool {
        let zone = self.zone();
        let from_midline = |around: f64| from_midline(zone.site, around);
        let stops = zone.stops.iter().map(|stop| from_midline(*stop));
        let inmost = stops.fold(PI, f64::min);
        let outwards = from_midline(self.around + self.aside) > from_midline(self.around);
        // (A hand that probes upright knows of no col.)
        self.is_taught() && outwards && from_midline(self.at) > inmost
    }

    /// Shallowest depth that the tip may have at an angle without leaving the pocket or meeting a neighbour.
    fn ceiling(&self, around: f64) -> f64 {
        let room = self.path().ceiling(around);
        room.map_or(BELOW, |ceiling| ceiling.max(0.0) + BELOW)
    }
}

impl Script for Tour {
    fn feel(&mut self, felt: &Felt) {
        if self.is_done() {
            return;
        }
        self.time += self.dt;
        if self.time >= self.params.duration - LEAVING {
            self.break_off();
        }
        if self.now[0] < self.insertions.len() {
            let place = self.path().place(self.around, self.depth, self.tilt);
            let along = felt.shown.wrenches[self.slot].force.dot(&place.up);
            self.force += (along - self.force) * (self.dt / FEEL);
            if let Some(graphic) = &felt.shown.graphics[self.slot] {
                (self.at, self.seen) = self.path().seen(&graphic.transform(&self.tool.tip));
                // The floor slopes; the hand keeps the tip where it means to be.
                let turned = self.at - self.around;
                let off = turned - TAU * (turned / TAU).round();
                let radius = self.path().radius(self.around, self.depth).max(1e-3);
                let most = MOST_ASIDE / radius;
                self.beside = off.abs() * radius;
                self.away = self.away(graphic);
                self.aside = match self.stroke {
                    Stroke::Travel => 0.0,
                    // (Let go of gently: all at once the handle would swing by millimetres.)
                    Stroke::Out => self.aside * (1.0 - KEEP * self.dt),
                    // Towards the col a tip may slide while it is read: a hand that held it back would press it into the wall.
                    Stroke::Read(..) if self.holds_back() => self.aside * (1.0 - KEEP * self.dt),
                    _ => {
                        // What it was led on to make up for is made up for once it has come past where it is meant to be: led
                        // on, it would go as far to the other side.
                        let past = self.aside * off > 0.0;
                        let kept = if past { 1.0 - KEEP * self.dt } else { 1.0 };
                        (kept * self.aside - KEEP * off * self.dt).clamp(-most, most)
                    }
                };
                self.see_to_it();
                let length = bands::below_margin(self.path(), &self.tool, graphic);
                self.length += (length - self.length) * (self.dt / LOOK);
            }
            let tilt = if self.stroke == Stroke::Travel {
                0.0
            } else {
                self.params.tilt
            };
            self.tilt += (tilt - self.tilt).clamp(-TURN * self.dt, TURN * self.dt);
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

/// How far an angle is from the mesial or distal midline that `site` lies at, radians; nothing in the middle of a side.
fn from_midline(site: Site, around: f64) -> f64 {
    match site.is_mesial() {
        Some(true) => around.abs(),
        Some(false) => PI - around.abs(),
        None => 0.0,
    }
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
