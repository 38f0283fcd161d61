//! Hands of a student by seed: strokes over and into the plate, moments without a tool, and readings that are no poses.

use fastrand::Rng;
use sulcus_connection::device::{EventDevice, Glance};
use sulcus_core::{MAX_TOOLS, RawPose, ToolInput, Wrench};
use sulcus_haptics::{HandSource, Shown};
use sulcus_proto::control::Command;

use crate::scene::CONTACT;

/// Shortest and longest stroke, periods.
const STROKE: [u32; 2] = [150, 1200];
/// Share of the strokes without a tool in the hand.
const AWAY: f64 = 0.08;
/// Share of the strokes with readings that are no poses.
const BAD: f64 = 0.05;
/// Share of such readings in such a stroke.
const BAD_READINGS: f64 = 0.2;

/// Motion of one hand from a place to the next.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    from: [f64; 3],
    to: [f64; 3],
    /// Length and elapsed part, periods.
    periods: u32,
    done: u32,
    /// Whether the tool is in the hand.
    is_held: bool,
    /// Whether some readings are no poses.
    is_bad: bool,
}

/// Both hands of a student.
pub struct Hands {
    rng: Rng,
    strokes: [Stroke; MAX_TOOLS],
    /// Commands of the student that wait for the loop.
    pub commands: Vec<Command>,
    /// Whether the student wants to leave.
    pub leaves: bool,
    /// Wrenches that the hands feel since the last pass, world axes.
    pub displayed: [Wrench; MAX_TOOLS],
}

impl Hands {
    /// Hands that begin above the plate.
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        let begin = |x: f64| [x, 0.0, CONTACT + 5e-3];
        let strokes = [-2e-3, 2e-3].map(|x| next(&mut rng, begin(x)));
        Self {
            rng,
            strokes,
            commands: Vec::new(),
            leaves: false,
            displayed: [Wrench::ZERO; MAX_TOOLS],
        }
    }
}

/// Stroke to a random place: up to 3 mm into the plate, up to 6 mm above.
fn next(rng: &mut Rng, from: [f64; 3]) -> Stroke {
    let between = |rng: &mut Rng, low: f64, high: f64| low + (high - low) * rng.f64();
    let to = [
        between(rng, -3e-3, 3e-3),
        between(rng, -3e-3, 3e-3),
        CONTACT + between(rng, -3e-3, 6e-3),
    ];
    Stroke {
        from,
        to,
        periods: rng.u32(STROKE[0]..STROKE[1]),
        done: 0,
        is_held: rng.f64() >= AWAY,
        is_bad: rng.f64() < BAD,
    }
}

impl HandSource for Hands {
    fn name(&self) -> &str {
        "hands by seed"
    }

    fn exchange(&mut self, _: &Shown) -> [ToolInput; MAX_TOOLS] {
        std::array::from_fn(|t| {
            let stroke = &mut self.strokes[t];
            stroke.done += 1;
            let share = f64::from(stroke.done) / f64::from(stroke.periods);
            let eased = share * share * (3.0 - 2.0 * share);
            let mut position: [f32; 3] = std::array::from_fn(|k| {
                (stroke.from[k] + (stroke.to[k] - stroke.from[k]) * eased) as f32
            });
            let (is_held, is_bad) = (stroke.is_held, stroke.is_bad);
            if stroke.done >= stroke.periods {
                self.strokes[t] = next(&mut self.rng, stroke.to);
            }
            if is_bad && self.rng.f64() < BAD_READINGS {
                position[self.rng.usize(0..3)] =
                    [f32::NAN, f32::INFINITY, 1e30][self.rng.usize(0..3)];
            }
            ToolInput {
                present: is_held,
                pose: RawPose {
                    position,
                    ..RawPose::IDENTITY
                },
                ..ToolInput::ABSENT
            }
        })
    }

    fn is_done(&self) -> bool {
        self.leaves
    }
}

impl EventDevice for Hands {
    fn commands(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }

    fn glance(&mut self, glance: &Glance) {
        self.displayed = glance.displayed;
    }
}
