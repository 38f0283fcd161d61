//! Script of a tour: a probe measures whole teeth in turn.
//!
//! The tip enters once on each side of a tooth and walks from zone to zone in short bobs, without leaving the pocket.
//! After the walk through a zone the tip returns to the deepest felt place. There the depth is read and called.
//!
//! The hand uses only the displayed force, and the eye only the drawn probe. Neither knows the depth of a pocket. The
//! path follows the spheres of the teeth, and only the margin of the gingiva is visible.
//!
//! A place is an angle about the tooth's axis, radians from mesial over buccal, and a depth below the margin, metres.

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

/// Height of the tip above the margin before and after an insertion, metres.
const ABOVE: f64 = 2e-3;
/// Height of the tip above the crown on its way through the air, metres.
const OVER: f64 = 3e-3;
/// Distance of that way outward from the tooth, metres.
const OUTSIDE: f64 = 2e-3;
/// Depth of the tip between two stops, below the margin and below the room that the neighbours leave, metres.
const BELOW: f64 = 0.25e-3;
/// Rate at which the hand corrects a tip that is pushed aside along the tooth, 1/s.
const KEEP: f64 = 6.0;
/// Largest correction along the tooth, metres.
const MOST_ASIDE: f64 = 1.2e-3;
/// Time constant of a hand's sense of force, seconds.
const FEEL: f64 = 0.02;
/// Smallest angle between the target of the tip and the mesial or distal midline, radians.
const MIDLINE: f64 = 0.02;
/// Largest rate of change of the tilt, rad/s.
const TURN: f64 = 1.5;
/// Time constant of the eye that reads the bands, seconds.
const LOOK: f64 = 0.1;
/// Time for the way out of the mouth, seconds.
const LEAVING: f64 = 2.5;
/// Largest time for a zone, for the length of the script, seconds.
const MOST_ZONE: f64 = 14.0;
/// Largest further time for an insertion, for the length of the script, seconds.
const MOST_INSERTION: f64 = 8.0;

/// Insertion of the probe: a side of a tooth, or a single zone for a hand that does not walk.
#[derive(Clone, Debug)]
struct Insertion {
    /// Index into the paths of the tour.
    path: usize,
    zones: Vec<Zone>,
}

/// Script of a probe that measures teeth in turn.
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
    // State of the performance.
    time: f64,
    travel: Travel,
    stroke: Stroke,
    /// Indices of insertion, zone and stop under way. The first equals the number of insertions after the last one.
    now: [usize; 3],
    /// Whether the tip returns to the deepest place of the zone.
    returning: bool,
    /// Whether the insertion is at its end.
    leaving: bool,
    /// Places of this insertion at which the floor was felt: target angle, radians, and seen depth, metres. The third
    /// value tells whether the tip was aimed at the zone and seen in it.
    felt: Vec<(f64, f64, bool)>,
    /// Angle at which the tip is seen, radians.
    at: f64,
    /// Target angle of the tip, radians.
    around: f64,
    /// Target depth of the tip, metres.
    depth: f64,
    /// Further tilt away from the tooth at present, radians.
    tilt: f64,
    /// Correction of the target angle against a push along the tooth, radians.
    aside: f64,
    /// Distance along the tooth from the target to the seen tip, metres, never negative.
    beside: f64,
    /// Distance of the seen tip outward from a tip on the tooth's surface, metres.
    away: f64,
    /// Time that the hand has waited for the tip at a stop, seconds.
    waited: f64,
    /// Number of new attempts at the present stop.
    again: u8,
    /// Angle at which the walk goes on when the floor is felt again, radians; `None` if the tip has not slipped out.
    resumes: Option<f64>,
    /// Force along the probe, out of the pocket, with the time constant [`FEEL`], newtons.
    force: f64,
    /// Depth of the tip below the margin as seen, metres.
    seen: f64,
    /// Length of the working end below the margin as seen, with the time constant [`LOOK`], metres.
    length: f64,
}

impl Tour {
    /// Tour of the visits in `tour`, in their order, with the first tool that has bands, else with the first tool.
    ///
    /// # Errors
    /// The scene lacks a tooth of the tour or its gingiva, or the tour has no site.
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
                // The tip enters at the nearest angle with room above, then walks to the first stop.
                let (first, entry) = (zones[0].stops[0], free(&paths[path], zones[0].stops[0]));
                if entry != first {
                    zones[0].stops.insert(0, entry);
                }
                insertions.push(Insertion { path, zones });
            }
        }
        let Some(first) = insertions.first() else {
            return Err(NoPocket(
                "the tour has no site, expected at least one site of a tooth".into(),
            ));
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

    /// Share of finished insertions, 0 to 1. Insertions that [`Tour::break_off`] dropped do not count.
    pub fn progress(&self) -> f64 {
        self.now[0] as f64 / self.insertions.len() as f64
    }

    /// FDI number of the tooth that is probed or approached; `None` after the last insertion.
    pub fn tooth(&self) -> Option<u8> {
        let insertion = self.insertions.get(self.now[0])?;
        Some(self.paths[insertion.path].fdi)
    }

    /// Origin of a tooth's frame, world, metres; `None` for a tooth outside the tour.
    pub fn origin_of(&self, fdi: u8) -> Option<Vec3> {
        let path = self.paths.iter().find(|path| path.fdi == fdi)?;
        Some(path.tooth().origin)
    }

    /// Whether the hand travels through the air, or the tour is finished.
    pub fn is_outside(&self) -> bool {
        matches!(self.stroke, Stroke::Travel | Stroke::Rest)
    }

    /// Paths of the tour, one for each tooth, in the order of the first visits.
    pub fn paths(&self) -> &[PocketPath] {
        &self.paths
    }

    fn path(&self) -> &PocketPath {
        &self.paths[self.insertions[self.now[0]].path]
    }

    fn zone(&self) -> &Zone {
        &self.insertions[self.now[0]].zones[self.now[1]]
    }

    /// Target device pose (`world_from_tool`) in and at the pocket.
    fn meant(&self) -> Pose {
        let off = Vec3::zeros();
        // The correction never leads to the other side of the tooth, where the shaft leans the other way.
        let side = self.around.signum();
        let around = side * (side * (self.around + self.aside)).clamp(MIDLINE, PI - MIDLINE);
        // The height is that at the target angle. The margin at the corrected angle has another height.
        let gingiva = self.path().gingiva();
        let rise = gingiva.margin_at(around) - gingiva.margin_at(self.around);
        self.path().pose(around, self.depth + rise, self.tilt, off)
    }

    /// Device pose (`world_from_tool`) over the crown at an angle, with `times` the clearance [`OVER`].
    fn over(&self, around: f64, times: f64) -> Pose {
        let path = self.path();
        let place = path.place(around, -ABOVE, 0.0);
        let climb = (-ABOVE - path.over(around)).max(0.0) + OVER * times;
        let off = path.tooth().axis * climb + place.outward * OUTSIDE;
        path.pose(around, -ABOVE, 0.0, off)
    }

    /// Distance of the drawn tip outward from a tip on the tooth's surface at the same angle and depth, metres.
    fn away(&self, graphic: &Pose) -> f64 {
        let from = graphic.transform(&self.tool.tip) - self.path().tooth().origin;
        let axis = self.path().tooth().axis;
        (from - axis * from.dot(&axis)).norm() - self.path().radius(self.at, self.seen)
    }

    /// Whether the hand tilts the probe and watches the tip as taught.
    fn is_taught(&self) -> bool {
        self.params.manner == Manner::Taught
    }

    /// Whether the correction holds the tip back from a slide towards the innermost stop of the zone, in the col.
    fn holds_back(&self) -> bool {
        let zone = self.zone();
        let from_midline = |around: f64| from_midline(zone.site, around);
        let stops = zone.stops.iter().map(|stop| from_midline(*stop));
        let inmost = stops.fold(PI, f64::min);
        let outwards = from_midline(self.around + self.aside) > from_midline(self.around);
        // An upright probe never enters the col.
        self.is_taught() && outwards && from_midline(self.at) > inmost
    }

    /// Smallest depth of the tip at an angle, metres, at which it stays in the pocket and clear of the neighbours.
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
                // The floor slopes, so the hand corrects the tip towards the target angle.
                let turned = self.at - self.around;
                let off = turned - TAU * (turned / TAU).round();
                let radius = self.path().radius(self.around, self.depth).max(1e-3);
                let most = MOST_ASIDE / radius;
                self.beside = off.abs() * radius;
                self.away = self.away(graphic);
                self.aside = match self.stroke {
                    Stroke::Travel => 0.0,
                    // The correction fades, because a sudden end would swing the handle by millimetres.
                    Stroke::Out => self.aside * (1.0 - KEEP * self.dt),
                    // During a reading, a correction against a slide towards the col would press the tip into the wall.
                    Stroke::Read(..) if self.holds_back() => self.aside * (1.0 - KEEP * self.dt),
                    _ => {
                        // Beyond the target the correction also decays. Otherwise the tip would swing as far to the
                        // other side.
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

/// Distance of an angle from the mesial or distal midline beside `site`, radians; 0 for a site in the middle of a side.
fn from_midline(site: Site, around: f64) -> f64 {
    match site.is_mesial() {
        Some(true) => around.abs(),
        Some(false) => PI - around.abs(),
        None => 0.0,
    }
}

/// Nearest angle towards the middle of the side at which the tip can leave straight up, in steps of a degree, radians.
///
/// Without such an angle the result is the middle of the side, to a degree.
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
