//! What the hand does in and at a pocket, millisecond by millisecond: down to the floor, up, on along the tooth, a reading, out.

use std::f64::consts::FRAC_PI_2;

use sulcus_core::Vec3;

use super::{ABOVE, Tour, free, from_midline};
use crate::bands;
use crate::script::Call;
use crate::travel::Travel;

/// Forces count as a floor's from this depth seen below the margin on, metres.
const IN_POCKET: f64 = 0.3e-3;
/// Farthest that the hand means the tip to be from where it is seen, metres, and how fast it makes up for it, 1/s.
const STUCK: f64 = 0.7e-3;
const HOLD: f64 = 12.0;
/// Fastest that the handle swings while the tip is in a pocket, m/s.
const HANDLE_SPEED: f64 = 50e-3;
/// Speed at which the hand gives way to a floor that comes up, m/s.
const GIVE: f64 = 8e-3;
/// How fast a way up ends, 1/s.
const NEAR: f64 = 40.0;
/// Correction of the press by the force missing, m/(N s): slower than the tremor, faster than a reading.
const CORRECTION: f64 = 0.05;
/// Speed of the way down to a reading over that of a bob: a floor that is met fast is pressed before it is felt.
const READ_SPEED: f64 = 0.4;
/// A reading counts while the force is so near to what is meant, share.
const STEADY: f64 = 0.15;
/// Push of a pocket's walls on a probe, per depth below [`DEEP`], N/m: a hand presses so much harder. A probe that leans over a bulging
/// crown is pushed against a root that flares. (Of 60 readings between two molars: 0.01 +-0.01 N at 4 mm, 0.05 +-0.02 N at 5 mm,
/// 0.07 +-0.03 N at 6 mm, 0.11 N at 7 mm; of 10 beside premolars and incisors 0.05 N at 5 mm.)
const WALLS: f64 = 30.0;
/// Depth from which the walls push, between teeth, and how much deeper in the middle of a side, metres.
const DEEP: f64 = 3.3e-3;
const DEEPER: f64 = 1e-3;
/// Push of the tip against the tooth, newtons, in the middle of a side; half of it between teeth. A leaning probe feels its share along
/// the shaft. (Of 90 readings of two molars at depths of 1 to 4 mm.)
const AGAINST_TOOTH: f64 = 0.065;
/// A tip that is caught on something before it is in a pocket is pressed no harder than this many times a floor.
const CAUGHT: f64 = 3.0;
/// A tip this far out from where it lies on the tooth is no longer between tooth and gingiva, metres.
const SLIPPED: f64 = 0.9e-3;
/// A raised tip that is this far out lies outside the wall, metres: in the pocket it was within 0.13 mm of the tooth at 972 stops
/// in three mouths, outside of it 0.3 to 0.8 mm away at seven. And how often it is put in again for one stop; twice as often
/// where it slips out at another time.
const STANDS_OFF: f64 = 0.25e-3;
const AGAIN: u8 = 2;
/// A raised tip that is farther along the tooth than this from where it is meant to be is waited for, metres, and for how
/// long, seconds.
const BEHIND: f64 = 0.3e-3;
const WAITS: f64 = 0.4;
/// A tip that slid along the tooth farther than this while it was pressed is not read there, metres.
const SLID: f64 = 0.4e-3;
/// Depths felt in bobs that differ by no more than this feel alike, metres.
const ALIKE: f64 = 0.3e-3;
/// Longest that a hand tries for a steady force, in lengths of a reading.
const PATIENCE: f64 = 4.0;
/// In a shallow sulcus the tip comes up to this share of its depth between two places.
const SHALLOW: f64 = 0.6;
/// A way through the air longer than this goes as high again, metres.
const LONG_WAY: f64 = 15e-3;

/// What the hand is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stroke {
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

impl Tour {
    /// Depth at which the way to `to` is free as far as the floor is known.
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

    /// Load on the floor along the tooth's axis as the hand infers it, newtons.
    fn floor_force(&self) -> f64 {
        let depth = self.seen.max(0.0);
        let place = self.path().place(self.around, self.depth, self.tilt);
        let sine = libm::sin(self.at);
        let side = sine * sine;
        let walls = WALLS * (depth - DEEP - DEEPER * side).max(0.0);
        let tooth = AGAINST_TOOTH * (0.5 + 0.5 * side) * place.up.dot(&place.outward).max(0.0);
        let upright = place.up.dot(&self.path().tooth().axis).max(0.5);
        (self.force - walls - tooth) / upright
    }

    /// One millisecond of the stroke under way.
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
                    // The more it feels the slower it goes.
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
                // The walls lift the tip; where the floor comes up it is let be lifted.
                let hit = self.force > p.turn_force;
                let pull = if hit {
                    -GIVE
                } else {
                    HOLD * (held - self.seen)
                };
                let wanted = (self.depth + pull * self.dt).clamp(held - STUCK, held + STUCK);
                // (A hand that pressed against a wall comes back as fast as it goes up, not at once.)
                let most = p.bob_speed * self.dt;
                self.depth += (wanted - self.depth).clamp(-most, most);
                if way.abs() > step {
                    // It waits until it is clear, or as clear as it gets.
                    let waits = hit && self.depth > held - STUCK;
                    self.around += if waits { 0.0 } else { step * way.signum() };
                } else {
                    self.around = to;
                    self.arrived();
                }
            }
            Stroke::Read(left, tried) => {
                // A hand gives way faster than it presses.
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

    /// The hand is over the next place: down there, once the eye sees that the tip came along.
    fn arrived(&mut self) {
        if self.leaving {
            self.stroke = Stroke::Out;
            return;
        }
        // Where the floor has a ridge between two places a tip that is let down too early slides back. (Who was not taught
        // how to lean does not look.)
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

    /// The share of a step (radians along the tooth, metres down) that the hand can make: the handle swings far where the
    /// probe has to turn, and a hand that follows late there pulls the tip away.
    fn paced(&self, along: f64, down: f64) -> f64 {
        let at = |around: f64, depth: f64| {
            let off = Vec3::zeros();
            self.path().pose(around, depth, self.tilt, off).position
        };
        let way = at(self.around + along, self.depth + down) - at(self.around, self.depth);
        (HANDLE_SPEED * self.dt / way.norm().max(1e-9)).min(1.0)
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
        // (Where the tip slid on into a deeper zone, that one was felt.)
        let ours = self.felt[self.felt.len() - walked..].iter();
        let ours = ours.copied().filter(|(.., inside)| *inside);
        let deepest = ours.clone().fold(0.0, |most: f64, at| most.max(at.1));
        // Of places that feel alike the one farthest into the col: there it is deepest, and what was felt is as good as a bob. On
        // the side of a tooth the one in the middle: there the margin is level.
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
        // A zone is read when the walk has been through it: by then blood shows.
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

    /// Whether the tip was pressed to be read and is seen to have slid out of the col, up the slope beside it.
    fn has_slid(&self) -> bool {
        let site = self.zone().site;
        let pressed = matches!(self.stroke, Stroke::Down | Stroke::Read(..)) && self.returning;
        let outwards = from_midline(site, self.at) > from_midline(site, self.around);
        self.is_taught() && pressed && outwards && self.beside > SLID
    }

    /// Where the eye sees that the tip has slid away from where it is to be read, it is lifted and let down again; where it has
    /// slipped out of the pocket, over the margin, it is taken up and put in again.
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
            // (It may be on its way back already.)
            _ => self.resumes.unwrap_or(self.around),
        };
        self.once_more(to);
    }

    /// Out, in again and on to an angle; on the way out it just goes out.
    fn once_more(&mut self, to: f64) {
        self.again += 1;
        self.waited = 0.0;
        self.resumes = (!self.leaving).then_some(to);
        self.stroke = Stroke::Out;
    }

    /// The time is up: the tip comes out, and this insertion was the last one.
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

    /// From over the margin to the next insertion, or away.
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
