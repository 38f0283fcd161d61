//! A hand that goes into a pocket, reads, walks, presses on the tooth's wall and leaves.

use sulcus_cases::pocket::Way;
use sulcus_core::output::PocketReading;
use sulcus_core::{Pose, Tool, ToolOutput, Vec3, Wrench};
use sulcus_operator::script::smoothstep;

use super::ways::{Descent, between};

/// Length of a tick, seconds.
const TICK_S: f64 = 1e-3;
/// Force at which it reads, newtons.
const FORCE: f64 = 0.2;
/// Speeds down, and of bobs, m/s.
const SPEEDS: [f64; 2] = [3e-3, 8e-3];
/// Height of a bob.
const BOB: f64 = 1.5e-3;
/// Share of the error sideways by which it aims farther, each millisecond, and farthest that it aims beside its way.
const CORRECTION: f64 = 8e-3;
const AIM: f64 = 5e-3;
/// Speed out, m/s, and height over the floor at which it no longer holds the tissue open.
const SLOW: f64 = 4e-3;
const RELAXED: f64 = 4e-3;
/// Most force with which it goes on down where it is not on the floor yet, newtons.
const MOST_FORCE: f64 = 0.4;
/// Height over the floor at which floors begin.
const LOW: f64 = 5e-4;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stroke {
    Come(f64),
    Down,
    Read(f64),
    Up(f64),
    On,
    Press(f64),
    Out,
    Leave(f64),
    Done,
}

/// What the hand does, and what it has read.
pub struct Stroll {
    ways: Vec<Descent>,
    stroke: Stroke,
    /// Place among the ways.
    place: f64,
    above: f64,
    force: f64,
    /// How far it aims beside its way, so that the tip stays on it whatever pushes it aside, metres.
    aim: Vec3,
    /// One for each way, at the end of reading.
    pub readings: Vec<PocketReading>,
    /// Whether it presses on the wall just now.
    pub pressing: bool,
}

impl Stroll {
    pub fn new(ways: Vec<Descent>) -> Self {
        Self {
            ways,
            stroke: Stroke::Come(0.0),
            place: 0.0,
            above: 8e-3,
            force: 0.0,
            aim: Vec3::zeros(),
            readings: Vec::new(),
            pressing: false,
        }
    }

    pub fn done(&self) -> bool {
        self.stroke == Stroke::Done
    }

    fn way(&self) -> Way {
        let k = (self.place as usize).min(self.ways.len() - 1);
        let next = (k + 1).min(self.ways.len() - 1);
        let (a, b) = (&self.ways[k], &self.ways[next]);
        between(&a.at(self.above), &b.at(self.above), self.place - k as f64)
    }

    /// A millisecond: what is felt and seen in, where the device is meant to be out.
    pub fn step(&mut self, tool: &Tool, felt: &Wrench, seen: &ToolOutput) -> Pose {
        let way = self.way();
        self.force += (felt.force.dot(&way.up) - self.force) * TICK_S / 0.02;
        // It sees where the tip is, and brings it back on its way sideways; along the way it goes by force.
        let missing = way.floor - seen.graphic.transform(&tool.tip);
        let sideways = missing - way.up * missing.dot(&way.up);
        match self.stroke {
            Stroke::Come(_) | Stroke::Leave(_) | Stroke::Done => self.aim *= 1.0 - CORRECTION,
            // It means to be beside its way.
            Stroke::Press(_) => {}
            // Less and less as the tissue over the tip gets less.
            Stroke::Out => {
                self.aim *= (1.0 - SLOW * TICK_S / (RELAXED - self.above).max(1e-4)).max(0.0)
            }
            _ => {
                self.aim += sideways * CORRECTION;
                self.aim *= (AIM / self.aim.norm().max(AIM)).min(1.0);
            }
        }
        let mut off = Vec3::zeros();
        let standoff = way.outward * 8e-3 + Vec3::z() * 1e-2;
        self.pressing = false;
        self.stroke = match self.stroke {
            Stroke::Come(t) => {
                off = standoff * (1.0 - smoothstep(t));
                if t < 1.2 {
                    Stroke::Come(t + TICK_S)
                } else {
                    Stroke::Down
                }
            }
            Stroke::Down => {
                if self.force < MOST_FORCE {
                    self.above -= SPEEDS[0] * TICK_S;
                }
                assert!(self.above > -8e-3, "no floor was felt: {seen:?}");
                // How high the tip is seen over the floor.
                let seen_above = self.above - missing.dot(&way.up);
                if seen_above < LOW && self.force > 0.95 * FORCE {
                    Stroke::Read(0.0)
                } else {
                    Stroke::Down
                }
            }
            Stroke::Read(t) if t < 1.0 => {
                self.above -= 0.03 * (FORCE - self.force) * TICK_S;
                Stroke::Read(t + TICK_S)
            }
            Stroke::Read(_) => {
                self.readings.push(seen.pocket.expect("in the pocket"));
                if self.readings.len() < self.ways.len() {
                    Stroke::Up(0.0)
                } else {
                    Stroke::Press(0.0)
                }
            }
            Stroke::Up(gone) => {
                self.above += SPEEDS[1] * TICK_S;
                if gone < BOB {
                    Stroke::Up(gone + SPEEDS[1] * TICK_S)
                } else {
                    Stroke::On
                }
            }
            Stroke::On => {
                let k = self.readings.len();
                let apart = (self.ways[k].at(0.0).floor - self.ways[k - 1].at(0.0).floor).norm();
                self.place = (self.place + SPEEDS[1] * TICK_S / apart).min(k as f64);
                if self.place < k as f64 {
                    Stroke::On
                } else {
                    Stroke::Down
                }
            }
            Stroke::Press(t) => {
                self.pressing = (0.4..1.6).contains(&t);
                self.above += 2e-3 * TICK_S * f64::from(u8::from(t < 0.5));
                off = way.outward * (-4e-3 * (smoothstep(2.0 * t) - smoothstep(2.0 * (t - 1.5))));
                if t < 2.0 {
                    Stroke::Press(t + TICK_S)
                } else {
                    Stroke::Out
                }
            }
            Stroke::Out => {
                self.above += SLOW * TICK_S;
                if self.above < 8e-3 {
                    Stroke::Out
                } else {
                    Stroke::Leave(0.0)
                }
            }
            Stroke::Leave(t) => {
                off = standoff * smoothstep(t);
                if t < 1.0 {
                    Stroke::Leave(t + TICK_S)
                } else {
                    Stroke::Done
                }
            }
            Stroke::Done => Stroke::Done,
        };
        let mut pose = self.way().pose(tool, 0.0, 0.0, 0.0);
        pose.position += off + self.aim;
        pose
    }
}
