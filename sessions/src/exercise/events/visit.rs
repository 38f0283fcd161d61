//! Visits of a probe's tip to the zones of pockets.
//!
//! The tip enters a pocket below the margin and near the tooth. It leaves the pocket high above the margin,
//! or after a time above the margin longer than a bob of the walking stroke, or far from the tooth. The zone
//! changes when the tip is two degrees past the border. So a tremor at an edge is no event, and neither is a bob in a
//! shallow sulcus.

use serde_json::json;
use sulcus_core::math::{fmax, fmin};
use sulcus_core::output::{ForceZone, PocketReading};
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{Scene, Vec3};

use super::angle::{STEADY_S, Tilt, Watch};
use super::kinds::{ANGLE, FLOOR_FELT, LEFT_SITE, SITE_REACHED, WITHDRAWN};
use super::pocket::Pocket;
use super::standing::Standing;
use crate::exercise::ProbingTask;
use crate::record::occurrence::Occurrence;

/// Largest distance of a tip in a pocket from the tooth's surface, metres.
const NEAR: f64 = 2e-3;
/// Bounds of leaving a pocket: height over the margin (metres) for a time (seconds), and height without a time
/// (metres). Chosen, because a bob is 1 to 2 mm high, and a shallow sulcus is as deep.
const ABOVE: f64 = 0.5e-3;
const STAYS: f64 = 0.1;
const HIGH: f64 = 1.5e-3;
/// Angle past a border at which the zone changes, radians.
const PAST: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// Distance by which another tooth must be nearer before the tip is in its pocket, metres.
const NEARER: f64 = 2e-4;
/// Share of the reading force below which the tip leaves the floor.
const LET_GO: f64 = 0.5;
/// Least time below the margin for a stay in a zone, seconds. A shorter visit is a passage.
pub const STAYED_S: f64 = 0.2;

/// Probe in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Tip, world axes, metres.
    pub tip: Vec3,
    /// Unit vector out of the tip.
    pub out_of_tip: Vec3,
    /// Reading of the pocket.
    pub reading: Option<&'a PocketReading>,
    /// Whether the hand feels the force, and no ramp behind a gap of the connection reduces it.
    pub felt: bool,
}

/// Visit to a zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visit {
    /// Index of the pocket.
    pub pocket: usize,
    /// Zone of the visit.
    pub site: Site,
    since: u64,
    /// Largest depth at a force in the reading band, metres.
    deepest: Option<f64>,
    /// Largest force on the floor, newtons.
    pub max_force: f64,
    /// Heaviest zone of force.
    pub heaviest: ForceZone,
    /// Whether the tip has felt the floor and has not left it since.
    felt: bool,
    watch: Watch,
    /// Tick at which the tip came above the margin, while it is above.
    above: Option<u64>,
    /// Number of ticks below the margin; below, the number of the last tick.
    below: u64,
    last: u64,
    /// Whether the visit is a stay.
    stayed: bool,
}

/// Side of a tooth: zone of the last stay, and tick at which the tip came out of the pocket since then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Side {
    stayed: Option<Site>,
    out: Option<u64>,
}

/// Both sides of a tooth, and the side of the last stay. On its way out the tip may slip over another zone or round to
/// the other side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Walk {
    sides: [Side; 2],
    last: usize,
}

/// State of one probe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Probe {
    visit: Option<Visit>,
    /// Sides by pocket.
    walks: Vec<Walk>,
    /// Visit that ended in this tick.
    ended: Option<Visit>,
    standing: Option<Standing>,
    /// Whether a gap of the connection has ended before the next tick.
    returned: bool,
}

/// Place of a tip in a pocket.
struct Spot<'a> {
    pocket: usize,
    around: f64,
    depth: f64,
    reading: Option<&'a PocketReading>,
}

impl Probe {
    /// Probe that has been in none of the pockets.
    pub fn new(pockets: usize) -> Self {
        Self {
            walks: vec![Walk::default(); pockets],
            ..Self::default()
        }
    }

    /// Visit that ended in the last tick.
    pub fn ended(&self) -> Option<&Visit> {
        self.ended.as_ref()
    }

    /// Place of the tip in the last tick.
    pub fn standing(&self) -> Option<&Standing> {
        self.standing.as_ref()
    }

    /// Takes the end of a gap of `ticks` ticks. No time has passed in the gap.
    pub fn returns(&mut self, ticks: u64) {
        let later = |tick: &mut u64| *tick = tick.saturating_add(ticks);
        if let Some(visit) = &mut self.visit {
            later(&mut visit.since);
            later(&mut visit.last);
            visit.above.iter_mut().for_each(later);
            visit.watch.shifts(ticks);
        }
        let sides = self.walks.iter_mut().flat_map(|walk| &mut walk.sides);
        sides.filter_map(|side| side.out.as_mut()).for_each(later);
        self.returned = true;
    }

    /// Processes a tick of tool `t`. `seen` is `None` if no hand holds the tool.
    pub fn observe(
        &mut self,
        (tick, tool): (u64, usize),
        seen: Option<&Seen<'_>>,
        pockets: &[Pocket],
        scene: &Scene,
        task: &ProbingTask,
        said: &mut Vec<Occurrence>,
    ) {
        self.ended = None;
        self.standing = None;
        let spot = seen.and_then(|seen| self.locate(tick, seen, pockets, scene));
        if std::mem::take(&mut self.returned)
            && let Some(visit) = &self.visit
            && spot.as_ref().is_none_or(|spot| spot.pocket != visit.pocket)
        {
            self.leave((tick, tool), pockets, scene, true, said);
            // Nobody saw how the tip came out, so no walk has been broken off.
            self.walks.fill(Walk::default());
        }
        self.enter((tick, tool), spot.zip(seen), (pockets, scene), task, said);
    }

    /// Processes a tick with the tip at a spot; `None` outside of all pockets.
    fn enter(
        &mut self,
        (tick, tool): (u64, usize),
        at: Option<(Spot<'_>, &Seen<'_>)>,
        (pockets, scene): (&[Pocket], &Scene),
        task: &ProbingTask,
        said: &mut Vec<Occurrence>,
    ) {
        let Some((spot, seen)) = at else {
            self.leave((tick, tool), pockets, scene, true, said);
            return;
        };
        let Some(gingiva) = pockets[spot.pocket].gingiva(scene) else {
            return;
        };
        let fdi = pockets[spot.pocket].fdi;
        let site = {
            let [before, here, after] =
                [-PAST, 0.0, PAST].map(|d| gingiva.site_at(spot.around + d));
            // Above the margin the zone does not change either.
            let undecided = before != after || spot.depth <= 0.0;
            match &self.visit {
                Some(visit) if visit.pocket == spot.pocket && undecided => visit.site,
                _ => here,
            }
        };
        let moved = |visit: &Visit| visit.pocket != spot.pocket || visit.site != site;
        if self.visit.as_ref().is_some_and(moved) {
            let other_tooth = self.visit.is_some_and(|visit| visit.pocket != spot.pocket);
            self.leave((tick, tool), pockets, scene, other_tooth, said);
        }
        if self.visit.is_none() {
            say(
                said,
                SITE_REACHED,
                tick,
                json!({
                    "tool": tool, "tooth": fdi, "site": site.name(), "depth_mm": spot.depth * 1e3,
                }),
            );
            self.visit = Some(Visit {
                pocket: spot.pocket,
                site,
                since: tick,
                deepest: None,
                max_force: 0.0,
                heaviest: ForceZone::Light,
                felt: false,
                watch: Watch::default(),
                above: None,
                below: 0,
                last: tick,
                stayed: false,
            });
        }
        self.stays((tick, tool), &spot, fdi, scene, said);
        let Some(visit) = &mut self.visit else {
            return;
        };
        visit.above = match visit.above {
            _ if spot.depth > -ABOVE => None,
            since => Some(since.unwrap_or(tick)),
        };
        let force = spot.reading.map_or(0.0, |reading| reading.floor_force);
        let [from, to] = task.force_n;
        // A force above the band that the hand does not feel injures nobody.
        let of_hand = if seen.felt { force } else { fmin(force, to) };
        if of_hand > visit.max_force {
            visit.max_force = of_hand;
        }
        if let Some(reading) = spot.reading
            && seen.felt
            && reading.zone > visit.heaviest
        {
            visit.heaviest = reading.zone;
        }
        if (from..=to).contains(&force) && visit.deepest.is_none_or(|before| spot.depth > before) {
            visit.deepest = Some(spot.depth);
        }
        if force >= from && !visit.felt {
            visit.felt = true;
            say(
                said,
                FLOOR_FELT,
                tick,
                json!({
                    "tool": tool, "tooth": fdi, "site": site.name(),
                    "depth_mm": spot.depth * 1e3, "force_n": force,
                }),
            );
        } else if force < LET_GO * from {
            visit.felt = false;
        }
        let tilt = Tilt::of(&gingiva.tooth, &seen.out_of_tip);
        self.standing = Some(Standing {
            tooth: fdi,
            site,
            around: spot.around,
            from_axis: gingiva.tooth.from_axis(&seen.tip),
            depth: spot.depth,
            shown: shown(gingiva, seen, spot.depth),
            force,
            zone: spot
                .reading
                .map_or(ForceZone::Light, |reading| reading.zone),
            tilt,
        });
        if visit.felt {
            let steady = scene.params.ticks_in(STEADY_S);
            if let Some(right) = visit.watch.turns(tick, tilt.is_right(site, task), steady) {
                say(said, ANGLE, tick, tilt.data(tool, fdi, site, right));
            }
        } else {
            visit.watch.rests();
        }
    }

    /// Counts time below the margin. When the visit becomes a stay, a withdrawal since the last stay in another zone of
    /// that side is an event.
    fn stays(
        &mut self,
        (tick, tool): (u64, usize),
        spot: &Spot<'_>,
        fdi: u8,
        scene: &Scene,
        said: &mut Vec<Occurrence>,
    ) {
        let Some(visit) = &mut self.visit else {
            return;
        };
        let ticks = tick.saturating_sub(visit.last);
        visit.last = tick;
        if spot.depth > 0.0 {
            visit.below += ticks;
        }
        if visit.stayed || visit.below < scene.params.ticks_in(STAYED_S) {
            return;
        }
        visit.stayed = true;
        let walk = &mut self.walks[visit.pocket];
        walk.last = usize::from(visit.site.is_buccal());
        let side = &mut walk.sides[walk.last];
        let before = side.stayed.replace(visit.site);
        if let Some((from, out)) = before.zip(side.out.take())
            && from != visit.site
        {
            say(
                said,
                WITHDRAWN,
                tick,
                json!({
                    "tool": tool, "tooth": fdi, "from": from.name(), "to": visit.site.name(),
                    "seconds": tick.saturating_sub(out) as f64 * scene.tick_s(),
                }),
            );
        }
    }

    /// Pocket with the tip; `None` outside of all pockets.
    fn locate<'a>(
        &self,
        tick: u64,
        seen: &Seen<'a>,
        pockets: &[Pocket],
        scene: &Scene,
    ) -> Option<Spot<'a>> {
        let spot = |k: usize| {
            let (around, height) = pockets[k].gingiva(scene)?.tooth.cylindrical(&seen.tip);
            let depth = pockets[k].gingiva(scene)?.margin_at(around) - height;
            let object = pockets[k].object;
            Some(Spot {
                pocket: k,
                around,
                depth,
                reading: seen.reading.filter(|reading| reading.object == object),
            })
        };
        let near = |k: usize| Some(pockets[k].tooth_distance(&seen.tip)).filter(|d| *d <= NEAR);
        let read = seen.reading.and_then(|reading| {
            let k = pockets
                .iter()
                .position(|pocket| pocket.object == reading.object)?;
            Some((k, near(k)?))
        });
        let stay = self.visit.as_ref().and_then(|visit| {
            let found = spot(visit.pocket)?;
            let distance = near(visit.pocket)?;
            let long = scene.params.ticks_in(STAYS);
            let stays = |since: u64| tick.saturating_sub(since) >= long;
            let out = found.depth <= -ABOVE && visit.above.is_some_and(stays);
            // A NaN is outside.
            (found.depth > -HIGH && !out).then_some((found, distance))
        });
        match (stay, read) {
            (Some((stay, ours)), Some((k, theirs)))
                if k != stay.pocket && theirs + NEARER < ours =>
            {
                spot(k)
            }
            (Some((stay, _)), _) => Some(stay),
            (None, Some((k, _))) => spot(k),
            (None, None) => None,
        }
    }

    /// Ends the visit, if there is one. `out` says that the tip leaves the pocket.
    fn leave(
        &mut self,
        (tick, tool): (u64, usize),
        pockets: &[Pocket],
        scene: &Scene,
        out: bool,
        said: &mut Vec<Occurrence>,
    ) {
        let Some(visit) = self.visit.take() else {
            return;
        };
        say(
            said,
            LEFT_SITE,
            tick,
            json!({
                "tool": tool,
                "tooth": pockets[visit.pocket].fdi,
                "site": visit.site.name(),
                "deepest_mm": visit.deepest.map(|depth| depth * 1e3),
                "max_force_n": visit.max_force,
                "seconds": tick.saturating_sub(visit.since) as f64 * scene.tick_s(),
            }),
        );
        if out {
            let Walk { sides, last } = &mut self.walks[visit.pocket];
            sides[*last].out.get_or_insert(tick);
        }
        self.ended = Some(visit);
    }
}

/// Length of a working end below the margin, metres: from the tip along the end up to the height of the margin there.
fn shown(gingiva: &Gingiva, seen: &Seen<'_>, depth: f64) -> f64 {
    let upright = -seen.out_of_tip.dot(&gingiva.tooth.axis);
    // Below this value the end lies across the tooth rather than along it.
    if !(depth > 0.0 && upright > 0.5) {
        return fmax(depth, 0.0);
    }
    let mut length = depth / upright;
    for _ in 0..3 {
        let at = seen.tip - seen.out_of_tip * length;
        let (around, height) = gingiva.tooth.cylindrical(&at);
        length += (gingiva.margin_at(around) - height) / upright;
    }
    fmax(length, 0.0)
}

fn say(said: &mut Vec<Occurrence>, kind: &str, tick: u64, data: serde_json::Value) {
    said.push(Occurrence {
        kind: kind.into(),
        tick,
        data,
    });
}
