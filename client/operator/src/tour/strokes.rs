//! Strokes of the hand in and at a pocket, period by period: down to the floor, up, along the tooth, a reading, out.

use std::f64::consts::FRAC_PI_2;

use sulcus_core::Vec3;

use super::{ABOVE, Tour, free, from_midline};
use crate::bands;
use crate::script::Call;
use crate::travel::Travel;

/// Smallest seen depth below the margin at which a force counts as that of a floor, metres.
const IN_POCKET: f64 = 0.3e-3;
/// Largest difference between the target depth and the depth that a bob is to hold, metres.
const STUCK: f64 = 0.7e-3;
/// Rate at which the target depth follows a difference between the seen depth and the depth to hold, 1/s.
const HOLD: f64 = 12.0;
/// Largest speed of the handle while the tip is in a pocket, m/s.
const HANDLE_SPEED: f64 = 50e-3;
/// Speed at which the hand gives way to a rising floor, m/s.
const GIVE: f64 = 8e-3;
/// Rate at which a way up slows down near its end, 1/s.
const NEAR: f64 = 40.0;
/// Change of the target depth per missing force, m/(N s). The correction is slower than the tremor and faster than a
/// reading.
const CORRECTION: f64 = 0.05;
/// Ratio of the speed down to a reading to that of a bob. A fast tip would press the floor before the hand feels it.
const READ_SPEED: f64 = 0.25;
/// Relative tolerance of the force during a reading. Only time within the tolerance counts.
const STEADY: f64 = 0.15;
/// Push of a pocket's walls along the probe, per depth below [`DEEP`], N/m. The hand presses harder by this push.
///
/// A probe that leans over a bulging crown is pushed against a root that flares. Measured over 60 readings between two
/// molars: 0.01 +-0.01 N at 4 mm, 0.05 +-0.02 N at 5 mm, 0.07 +-0.03 N at 6 mm, 0.11 N at 7 mm. Measured over 10
/// readings beside premolars and incisors: 0.05 N at 5 mm.
const WALLS: f64 = 30.0;
/// Smallest depth at which the walls push between teeth, metres.
const DEEP: f64 = 3.3e-3;
/// Increase of [`DEEP`] in the middle of a side, metres.
const DEEPER: f64 = 1e-3;
/// Push of the tip against the tooth in the middle of a side, newtons.
///
/// A leaning probe transmits a share of the push along its shaft. Measured over 90 readings of two upright molars at
/// depths of 1 to 4 mm.
const AGAINST_TOOTH: f64 = 0.065;
/// Ratio of the push against the tooth between teeth, at a depth of at most [`SHALLOW_COL`] less 1 mm, to
/// [`AGAINST_TOOTH`].
///
/// Measured over 66 readings of the mouth with leaning teeth, of patients 301 to 308: the load between teeth was 0.04 N
/// too small at 2 mm, and right within 0.02 N from 3 mm.
const COL: f64 = 1.5;
/// Smallest depth between teeth at which the tooth does not push along the probe, metres.
const SHALLOW_COL: f64 = 3e-3;
/// Ratio of the force along the probe that ends a way down to the force on a floor that ends it. The limit holds for a
/// tip that is caught before it is in the pocket.
const CAUGHT: f64 = 3.0;
/// Smallest distance outward from the tooth at which the tip has slipped out from between tooth and gingiva, metres.
const SLIPPED: f64 = 0.9e-3;
/// Smallest distance outward from the tooth at which a raised tip lies outside the wall, metres.
///
/// Measured in three mouths: at 972 stops the tip was in the pocket and within 0.13 mm of the tooth. At seven stops it
/// was outside and 0.3 to 0.8 mm away.
const STANDS_OFF: f64 = 0.25e-3;
/// Largest number of new attempts for one stop; twice as many for a tip that slips out during a stroke.
const AGAIN: u8 = 2;
/// Distance along the tooth from the target above which the hand waits for a raised tip, metres.
const BEHIND: f64 = 0.3e-3;
/// Longest wait for a raised tip, seconds.
const WAITS: f64 = 0.4;
/// Distance along the tooth from the target above which a pressed tip counts as slid and is not read, metres.
const SLID: f64 = 0.4e-3;
/// Largest difference between two felt depths that count as equal, metres.
const ALIKE: f64 = 0.3e-3;
/// Longest attempt at a steady force, as a multiple of [`TourParams::read`](crate::tour_params::TourParams::read).
const PATIENCE: f64 = 4.0;
/// Smallest depth between two stops, as a share of the felt depth. It limits the bob in a shallow sulcus.
const SHALLOW: f64 = 0.6;
/// Length of a way through the air above which the tip has twice the clearance over the crown, metres.
const LONG_WAY: f64 = 15e-3;

/// Stroke of the hand. Depths are in metres, angles in radians, times in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stroke {
    /// Through the air to the start of the next insertion, or out of the mouth.
    Travel,
    /// Down until the floor is felt.
    Down,
    /// Up until the tip is seen at the depth, then along the tooth to the angle.
    Up(f64, f64),
    /// Along the tooth to the angle, with the tip held at the depth as seen.
    On(f64, f64),
    /// Press with the force of a reading: the time with a steady force that is left, and the time spent so far.
    Read(f64, f64),
    /// Up and out of the pocket.
    Out,
    /// End of the tour.
    Rest,
}

impl Tour {
    /// Depth at which the way to the angle `to` is free of the floor as far as felt, metres.
    fn clear_to(&self, to: f64) -> f64 {
        let (low, high) = (self.around.min(to) - 1e-6, self.around.max(to) + 1e-6);
        let passed = self
            .felt
            .iter()
            .filter(|(at, ..)| (low..=high).contains(at));
        let shallowest = passed.fold(self.seen, |least, (_, depth, _)| least.min(*depth));
        let ceiling = self.ceiling(self.around).max(self.ceiling(to));
        (shallowest - self.params.bob)
            .max(SHALLOW * shallowest)
            .max(ceiling)
    }

    /// Load on the floor along the tooth's axis as inferred from the force along the probe, newtons.
    fn floor_force(&self) -> f64 {
        let depth = self.seen.max(0.0);
        let place = self.path().place(self.around, self.depth, self.tilt);
        let sine = libm::sin(self.at);
        let side = sine * sine;
        let walls = WALLS * (depth - DEEP - DEEPER * side).max(0.0);
        let shallow = ((SHALLOW_COL - depth) / 1e-3).clamp(0.0, 1.0);
        let share = side + (1.0 - side) * COL * shallow;
        let tooth = AGAINST_TOOTH * share * place.up.dot(&place.outward).max(0.0);
        let upright = place.up.dot(&self.path().tooth().axis).max(0.5);
        (self.force - walls - tooth) / upright
    }

    /// Advances the stroke under way by one period.
    pub(super) fn go_on(&mut self) {
        let p = self.params;
        match self.stroke {
            Stroke::Travel => {
                if self.travel.step(self.dt) {
                    let all = self.insertions.len();
                    self.stroke = if self.now[0] < all {
                        Stroke::Down
                    } else {
                        Stroke::Rest
                    };
                }
            }
            Stroke::Down => {
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
                    } else if self.returning {
                        READ_SPEED * p.walk_speed
                    } else {
                        p.walk_speed
                    };
                    // The way down slows with the felt force.
                    let share = (1.2 - self.floor_force() / enough).clamp(0.2, 1.0);
                    let down = speed * share * self.dt;
                    self.depth += down * self.paced(0.0, down);
                }
            }
            Stroke::Up(held, to) => {
                let near = NEAR * (self.seen - held) + 1e-3;
                let up = p.bob_speed.min(near) * self.dt;
                self.depth -= up * self.paced(0.0, -up);
                if self.seen <= held || self.depth <= held - STUCK {
                    self.stroke = Stroke::On(held, to);
                }
            }
            Stroke::On(held, to) => {
                let radius = self.path().radius(self.around, self.depth).max(1e-3);
                let (step, way) = (p.bob_speed * self.dt / radius, to - self.around);
                let step = step * self.paced(step * way.signum(), 0.0);
                // The walls lift the tip, and the hand holds it down. A rising floor may lift the tip.
                let hit = self.force > p.turn_force;
                let pull = if hit {
                    -GIVE
                } else {
                    HOLD * (held - self.seen)
                };
                let wanted = (self.depth + pull * self.dt).clamp(held - STUCK, held + STUCK);
                // After a press against a wall, the speed of the return is limited to that of a bob.
                let most = p.bob_speed * self.dt;
                self.depth += (wanted - self.depth).clamp(-most, most);
                if way.abs() > step {
                    // The hand waits until the tip is clear of the floor, or lifted by the largest difference.
                    let waits = hit && self.depth > held - STUCK;
                    self.around += if waits { 0.0 } else { step * way.signum() };
                } else {
                    self.around = to;
                    self.arrived();
                }
            }
            Stroke::Read(left, tried) => {
                // The hand gives way twice as fast as it presses.
                let missing = p.force - self.floor_force();
                let correction = if missing < 0.0 {
                    2.0 * CORRECTION
                } else {
                    CORRECTION
                };
                self.depth += correction * missing * self.dt;
                self.depth = self.depth.min(p.deepest);
                let steady = (self.floor_force() - p.force).abs() < STEADY * p.force;
                let left = if steady { left - self.dt } else { left };
                self.stroke = Stroke::Read(left, tried + self.dt);
                if left <= 0.0 || tried > PATIENCE * p.read {
                    self.call();
                }
            }
            Stroke::Out => {
                self.depth -= 2.0 * p.bob_speed * self.dt;
                if self.depth > -ABOVE {
                    return;
                }
                if self.resumes.is_some() {
                    // The tip enters again at the nearest angle with room above.
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

    /// Continues at a stop: down, as soon as the eye sees that the tip has followed; or out at the end of an insertion.
    fn arrived(&mut self) {
        if self.leaving {
            self.stroke = Stroke::Out;
            return;
        }
        // On a ridge of the floor between two stops, a tip that goes down too early slides back. Only a hand that tilts
        // as taught watches for this.
        if self.is_taught() && self.beside > BEHIND && self.waited < WAITS {
            self.waited += self.dt;
            return;
        }
        self.waited = 0.0;
        if self.away > STANDS_OFF && self.again < AGAIN {
            self.once_more(self.around);
        } else {
            self.stroke = Stroke::Down;
        }
    }

    /// Share of a step that the hand can make, 0 to 1. The step is `along` the tooth, radians, and `down`, metres.
    ///
    /// The handle swings far where the probe has to turn. A hand that follows too late pulls the tip away.
    fn paced(&self, along: f64, down: f64) -> f64 {
        let at = |around: f64, depth: f64| {
            let off = Vec3::zeros();
            self.path().pose(around, depth, self.tilt, off).position
        };
        let way = at(self.around + along, self.depth + down) - at(self.around, self.depth);
        (HANDLE_SPEED * self.dt / way.norm().max(1e-9)).min(1.0)
    }

    /// Starts the next stroke after the floor was felt at a stop.
    fn reached(&mut self) {
        if let Some(to) = self.resumes.take() {
            self.go_to(to);
            return;
        }
        if self.returning {
            self.stroke = Stroke::Read(self.params.read, 0.0);
            return;
        }
        self.again = 0;
        let zone = self.zone();
        let (site, walked) = (zone.site, zone.stops.len());
        let next = zone.stops.get(self.now[2] + 1).copied();
        let gingiva = self.path().gingiva();
        let inside = gingiva.site_at(self.around) == site && gingiva.site_at(self.at) == site;
        self.felt.push((self.around, self.seen, inside));
        if let Some(next) = next {
            self.now[2] += 1;
            self.go_to(next);
            return;
        }
        self.returning = true;
        // A tip that slid on into a deeper zone has felt the floor of that zone, so this place does not count.
        let ours = self.felt[self.felt.len() - walked..].iter();
        let ours = ours.copied().filter(|(.., inside)| *inside);
        let deepest = ours.clone().fold(0.0, |most: f64, at| most.max(at.1));
        // Among equal depths, a proximal zone takes the place farthest into the col, where the pocket is deepest. The
        // middle of a side takes the place nearest to its middle, where the margin is level.
        let from_best = |around: f64| {
            if site.is_proximal() {
                from_midline(site, around)
            } else {
                (around.abs() - FRAC_PI_2).abs()
            }
        };
        let best = ours
            .filter(|at| at.1 >= deepest - ALIKE)
            .min_by(|a, b| {
                let nearer = from_best(a.0).total_cmp(&from_best(b.0));
                nearer.then(b.1.total_cmp(&a.1))
            })
            .map_or(self.around, |at| at.0);
        if !self.params.returns || best == self.around {
            self.stroke = Stroke::Down;
        } else {
            self.go_to(best);
        }
    }

    /// Starts the way up, then along the tooth to the angle `to`, radians.
    fn go_to(&mut self, to: f64) {
        self.stroke = Stroke::Up(self.clear_to(to), to);
    }

    /// Calls the depth that is read here, and continues with the next zone or the way out.
    fn call(&mut self) {
        let right = bands::read(&self.tool.bands, self.length);
        let depth_mm = match &mut self.blur {
            Some(blur) => blur.call(&self.tool.bands, right),
            None => right,
        };
        // A zone is read after the walk through it. Bleeding is visible by then.
        let (site, gingiva) = (self.zone().site, self.path().gingiva());
        let (seen, trauma) = (gingiva.prescribed(site), gingiva.params.trauma);
        self.calls.push(Call {
            tooth: self.path().fdi,
            site,
            depth_mm,
            recession_mm: (seen.recession * 1e3).round() as i8,
            bleeding: seen.bleeds || self.params.force >= trauma,
        });
        self.returning = false;
        self.again = 0;
        let next = self.insertions[self.now[0]].zones.get(self.now[1] + 1);
        if let Some(next) = next.map(|zone| zone.stops[0]) {
            self.now = [self.now[0], self.now[1] + 1, 0];
            self.go_to(next);
        } else {
            self.leaving = true;
            self.go_to(free(self.path(), self.around));
        }
    }

    /// Whether the tip is pressed for a reading and is seen to have slid out of the col, up the slope beside it.
    fn has_slid(&self) -> bool {
        let site = self.zone().site;
        let pressed = matches!(self.stroke, Stroke::Down | Stroke::Read(..)) && self.returning;
        let outwards = from_midline(site, self.at) > from_midline(site, self.around);
        self.is_taught() && pressed && outwards && self.beside > SLID
    }

    /// Corrects a tip that is seen to have left its place. A tip that slid from its place of reading is lifted and let
    /// down again. A tip that slipped out of the pocket over the margin leaves and enters again.
    pub(super) fn see_to_it(&mut self) {
        let walking = match self.stroke {
            Stroke::Down => !self.felt.is_empty(),
            Stroke::Up(..) | Stroke::On(..) | Stroke::Read(..) => true,
            Stroke::Travel | Stroke::Out | Stroke::Rest => false,
        };
        if self.has_slid() && self.again < AGAIN {
            self.again += 1;
            self.go_to(self.around);
            return;
        }
        if !walking || self.away < SLIPPED || self.again >= 2 * AGAIN {
            return;
        }
        let to = match self.stroke {
            Stroke::Up(_, to) | Stroke::On(_, to) => to,
            // The tip may already be on its way back.
            _ => self.resumes.unwrap_or(self.around),
        };
        self.once_more(to);
    }

    /// Starts a new attempt: out, in again and on to the angle `to`. At the end of an insertion the tip only leaves.
    fn once_more(&mut self, to: f64) {
        self.again += 1;
        self.waited = 0.0;
        self.resumes = (!self.leaving).then_some(to);
        self.stroke = Stroke::Out;
    }

    /// Ends the tour early: the tip leaves its pocket, and the insertion under way is the last one.
    pub fn break_off(&mut self) {
        self.resumes = None;
        let begun = (self.now[0] + 1).min(self.insertions.len());
        self.insertions.truncate(begun);
        let inside = !matches!(self.stroke, Stroke::Travel | Stroke::Out | Stroke::Rest);
        if inside && !self.leaving {
            self.leaving = true;
            self.go_to(free(self.path(), self.around));
        }
    }

    /// Starts the way through the air from above the margin to the next insertion, or out of the mouth.
    fn go_away(&mut self) {
        let speed = self.params.air_speed;
        let here = self.around;
        let mut travel = Travel::at(self.meant());
        travel.then(self.over(here, 1.0), speed);
        let high = self.over(here, 2.0);
        (self.leaving, self.again) = (false, 0);
        self.felt.clear();
        self.stroke = Stroke::Travel;
        if self.now[0] + 1 == self.insertions.len() {
            travel.then(high, speed);
            self.now[0] += 1;
        } else {
            self.now = [self.now[0] + 1, 0, 0];
            self.around = self.zone().stops[0];
            (self.aside, self.tilt) = (0.0, 0.0);
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
