//! State between ticks, including every warm start; saved and restored exactly.

mod tissues;

pub use tissues::Tissues;

use crate::math::{Pose, Vec3, Wrench, norm, normalised};
use crate::scene::params::within;
use crate::{MAX_TOOLS, Scene};

/// Progress of a tool from its entry to its hand.
///
/// An entry leaves the graphic tool where it was, away from the hand. The tool then travels to the hand, and may be
/// stopped by objects on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Graphic and haptic tool have met: in a tick at its place of rest, the graphic tool was near the haptic tool.
    /// Also the value of a tool that is absent, and in scenes without [`crate::Params::max_arrival_step`].
    Met,
    /// Place of rest reached, away from the hand, as behind a wall.
    Apart,
    /// On the way, with [`crate::Params::max_arrival_step`] in force.
    Travelling,
}

/// State of one tool between ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// Last haptic pose after validation and speed limit, `world_from_tool`; the parked pose before the first entry.
    pub haptic: Pose,
    /// Graphic pose, `world_from_tool`.
    pub graphic: Pose,
    /// Whether the tool was present in the last tick.
    pub entered: bool,
    /// Progress of the tool from its entry to its hand.
    pub arrival: Arrival,
    /// Number of consecutive ticks with an invalid pose up to the last tick; 65535 for that number or more.
    pub bad_ticks: u16,
    /// Ramp factor of the wrench sent, 0 to 1.
    pub gain: f64,
    /// Wrench sent last, about the device point, world axes, N and N m.
    pub sent: Wrench,
    /// Wrench before ramp, clamp and slew in the last tick in which the tool was present. About the device point, world
    /// axes, N and N m.
    pub raw: Wrench,
    /// Unit axis of the last twist, the rotation from the graphic to the haptic pose, world axes; zero before the first
    /// twist. A twist under 1e-3 rad or beyond 170 degrees keeps the former axis: near 180 degrees the logarithm flips
    /// its sign.
    pub twist_axis: Vec3,
}

/// State of a simulation between two ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Number of the last tick on the clock's grid; 0 before the first.
    pub tick: u64,
    /// Chained hash after the last tick; 0 before the first.
    pub hash: u64,
    /// State per tool slot.
    pub tools: [ToolState; MAX_TOOLS],
    /// Load by each tool on each object, tools outermost: force (newtons) and torque about the world's origin
    /// (newton-metres), world axes.
    pub loads: Vec<Wrench>,
    /// State numbers of all tissues, object after object.
    pub tissue: Tissues,
}

/// Error of bytes that are not a state of this scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// The layout has another version.
    #[error("state has version {found}, expected {STATE_VERSION}")]
    Version {
        /// Version found.
        found: u16,
    },
    /// The bytes have the wrong length.
    #[error(
        "state has {found} bytes, expected {expected} bytes for this scene and their own counts"
    )]
    Length {
        /// Length of the given bytes.
        found: usize,
        /// Length expected, bytes, as far as the given bytes were read.
        expected: usize,
    },
    /// The bytes contain a number that no tick produces.
    #[error("state, byte {offset}: {what}")]
    Value {
        /// Offset of the number, or of the flag before it, in bytes; 0 for a number that only the range checks refuse.
        offset: usize,
        /// Description of the error.
        what: &'static str,
    },
}

/// Version of the layout of [`State::to_bytes`].
pub const STATE_VERSION: u16 = 2;
/// Length of one tool in [`State::to_bytes`], bytes: two poses, a flag, a count, the ramp, two wrenches, an axis.
const TOOL_BYTES: usize = 2 * 7 * 8 + 1 + 2 + 8 + 2 * 6 * 8 + 3 * 8;

impl State {
    /// Returns the state before the first tick: tools parked, tissue at rest.
    pub fn new(scene: &Scene) -> Self {
        let parked = |slot: usize| {
            let park = scene
                .tools
                .get(slot)
                .map_or(Pose::identity(), |tool| tool.park);
            ToolState {
                haptic: park,
                graphic: park,
                entered: false,
                arrival: Arrival::Met,
                bad_ticks: 0,
                gain: 0.0,
                sent: Wrench::ZERO,
                raw: Wrench::ZERO,
                twist_axis: Vec3::zeros(),
            }
        };
        Self {
            tick: 0,
            hash: 0,
            tools: std::array::from_fn(parked),
            loads: vec![Wrench::ZERO; scene.tools.len() * scene.objects.len()],
            tissue: Tissues::new(scene),
        }
    }

    /// Returns the largest length of [`State::to_bytes`] of a state of `scene`, bytes: with no load zero and no tissue
    /// at rest.
    pub fn most_bytes(scene: &Scene) -> usize {
        let tissues = Tissues::new(scene);
        18 + MAX_TOOLS * TOOL_BYTES
            + scene.tools.len() * scene.objects.len() * 49
            + tissues.parts()
            + tissues.len() * 8
    }

    /// Returns the exact bytes, little-endian, in this order:
    /// - version (u16), tick and hash (u64),
    /// - per tool slot: poses, ramp, wrenches and axis (f64),
    /// - per tool and object: a byte 0 without load, otherwise a byte 1 and the load (six f64),
    /// - per yielding object: a byte 0 at rest, otherwise a byte 1 and the object's numbers (f64),
    /// - per tool slot: whether the tool has entered (a byte), and its bad ticks (u16). The byte is 0 for an absent
    ///   tool, 1 for [`Arrival::Met`], 2 for [`Arrival::Apart`], 3 for [`Arrival::Travelling`].
    ///
    /// A zero load or a tissue at rest takes a single byte, and each state has exactly one encoding.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_bytes(&mut bytes);
        bytes
    }

    /// Appends the bytes of [`State::to_bytes`]. Allocates only if `bytes` lacks capacity.
    pub fn write_bytes(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&STATE_VERSION.to_le_bytes());
        bytes.extend_from_slice(&self.tick.to_le_bytes());
        bytes.extend_from_slice(&self.hash.to_le_bytes());
        for tool in &self.tools {
            for pose in [&tool.haptic, &tool.graphic] {
                pose.position.iter().for_each(|x| put(*x, bytes));
                let q = &pose.orientation;
                [q.w, q.i, q.j, q.k].iter().for_each(|x| put(*x, bytes));
            }
            put(tool.gain, bytes);
            for wrench in [&tool.sent, &tool.raw] {
                put_wrench(wrench, bytes);
            }
            tool.twist_axis.iter().for_each(|x| put(*x, bytes));
        }
        for load in &self.loads {
            let none = is_plain_zero(load);
            bytes.push(u8::from(!none));
            if !none {
                put_wrench(load, bytes);
            }
        }
        for slot in 0..self.tissue.parts() {
            let at_rest = self.tissue.at_rest(slot);
            bytes.push(u8::from(!at_rest));
            if !at_rest {
                put_all(self.tissue.of(slot), bytes);
            }
        }
        for tool in &self.tools {
            bytes.push(match (tool.entered, tool.arrival) {
                (false, _) => 0,
                (true, Arrival::Met) => 1,
                (true, Arrival::Apart) => 2,
                (true, Arrival::Travelling) => 3,
            });
            bytes.extend_from_slice(&tool.bad_ticks.to_le_bytes());
        }
    }

    /// Inverse of [`State::to_bytes`] for the same scene.
    ///
    /// # Errors
    /// The version or the length differs, or a number is one that no tick produces.
    pub fn from_bytes(scene: &Scene, bytes: &[u8]) -> Result<Self, StateError> {
        let mut reader = Reader { bytes, at: 0 };
        let version = u16::from_le_bytes(reader.take()?);
        if version != STATE_VERSION {
            return Err(StateError::Version { found: version });
        }
        let mut state = Self::new(scene);
        state.tick = u64::from_le_bytes(reader.take()?);
        state.hash = u64::from_le_bytes(reader.take()?);
        for tool in &mut state.tools {
            tool.haptic = reader.pose()?;
            tool.graphic = reader.pose()?;
            tool.gain = reader.number()?;
            tool.sent = reader.wrench()?;
            tool.raw = reader.wrench()?;
            tool.twist_axis = reader.vector()?;
        }
        check_ranges(scene, &state)?;
        for load in &mut state.loads {
            let offset = reader.at;
            if reader.flag()? {
                *load = reader.wrench()?;
                if is_plain_zero(load) {
                    return Err(StateError::Value {
                        offset,
                        what: "a load of zero that is not left out",
                    });
                }
            }
        }
        for slot in 0..state.tissue.parts() {
            let offset = reader.at;
            if reader.flag()? {
                for x in state.tissue.of_mut(slot) {
                    *x = reader.number()?;
                }
                state.tissue.settle(slot);
                if state.tissue.at_rest(slot) {
                    return Err(StateError::Value {
                        offset,
                        what: "a tissue at rest that is not left out",
                    });
                }
            }
        }
        for tool in &mut state.tools {
            (tool.entered, tool.arrival) = reader.entry(scene.params.max_arrival_step > 0.0)?;
            tool.bad_ticks = u16::from_le_bytes(reader.take()?);
        }
        if reader.at != bytes.len() {
            return Err(StateError::Length {
                found: bytes.len(),
                expected: reader.at,
            });
        }
        Ok(state)
    }
}

/// Checks the state against values that no tick produces. Invalid are: a ramp outside 0 to 1, a wrench beyond the
/// scene's limits, a twist axis longer than 1, a tick beyond counting.
fn check_ranges(scene: &Scene, state: &State) -> Result<(), StateError> {
    let bad = |what| Err(StateError::Value { offset: 0, what });
    if state.tick > u64::MAX / 2 {
        return bad("a tick beyond counting");
    }
    // Headroom for rounding in the clamp.
    const ROUNDING: f64 = 1.0 + 1e-9;
    for tool in &state.tools {
        if !within(tool.gain, 0.0, 1.0) {
            return bad("a ramp outside 0 to 1");
        }
        if norm(&tool.sent.force) > scene.params.max_force * ROUNDING {
            return bad("a force sent beyond the scene's limit");
        }
        if norm(&tool.sent.torque) > scene.params.max_torque * ROUNDING {
            return bad("a torque sent beyond the scene's limit");
        }
        if norm(&tool.twist_axis) > ROUNDING {
            return bad("a twist axis longer than one");
        }
    }
    Ok(())
}

/// Appends a number as little-endian f64.
fn put(x: f64, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&x.to_bits().to_le_bytes());
}

/// Appends all numbers as little-endian f64 in one step. Separate appends each check the capacity, which takes longer
/// than hashing the numbers.
fn put_all(numbers: &[f64], bytes: &mut Vec<u8>) {
    let begin = bytes.len();
    bytes.resize(begin + 8 * numbers.len(), 0);
    for (to, x) in bytes[begin..].chunks_exact_mut(8).zip(numbers) {
        to.copy_from_slice(&x.to_bits().to_le_bytes());
    }
}

/// Appends force and torque as six little-endian f64.
fn put_wrench(wrench: &Wrench, bytes: &mut Vec<u8>) {
    let numbers = wrench.force.iter().chain(wrench.torque.iter());
    numbers.for_each(|x| put(*x, bytes));
}

/// Whether all numbers of a wrench are positive zeros, as in [`Wrench::ZERO`].
fn is_plain_zero(wrench: &Wrench) -> bool {
    let numbers = wrench.force.iter().chain(wrench.torque.iter());
    numbers.fold(0, |bits, x| bits | x.to_bits()) == 0
}

/// Reader of the bytes of a state, at the offset `at`.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], StateError> {
        let end = self.at + N;
        let taken = self.bytes.get(self.at..end);
        let taken = taken.and_then(|taken| taken.try_into().ok());
        let taken = taken.ok_or(StateError::Length {
            found: self.bytes.len(),
            expected: end,
        })?;
        self.at = end;
        Ok(taken)
    }

    fn flag(&mut self) -> Result<bool, StateError> {
        let offset = self.at;
        match self.take()? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(StateError::Value {
                offset,
                what: "a flag that is neither 0 nor 1",
            }),
        }
    }

    /// Reads whether a tool has entered, and its arrival. `arrives` tells whether a tick of the scene gives values
    /// other than [`Arrival::Met`].
    fn entry(&mut self, arrives: bool) -> Result<(bool, Arrival), StateError> {
        let offset = self.at;
        match self.take()? {
            [0] => Ok((false, Arrival::Met)),
            [1] => Ok((true, Arrival::Met)),
            [2] if arrives => Ok((true, Arrival::Apart)),
            [3] if arrives => Ok((true, Arrival::Travelling)),
            _ => Err(StateError::Value {
                offset,
                what: "an entry that is no tick's of this scene",
            }),
        }
    }

    fn number(&mut self) -> Result<f64, StateError> {
        let offset = self.at;
        let x = f64::from_bits(u64::from_le_bytes(self.take()?));
        if x.is_finite() {
            Ok(x)
        } else {
            Err(StateError::Value {
                offset,
                what: "a number that is not finite",
            })
        }
    }

    fn vector(&mut self) -> Result<Vec3, StateError> {
        Ok(Vec3::new(self.number()?, self.number()?, self.number()?))
    }

    fn wrench(&mut self) -> Result<Wrench, StateError> {
        Ok(Wrench {
            force: self.vector()?,
            torque: self.vector()?,
        })
    }

    fn pose(&mut self) -> Result<Pose, StateError> {
        let position = self.vector()?;
        let offset = self.at;
        let (w, i, j, k) = (
            self.number()?,
            self.number()?,
            self.number()?,
            self.number()?,
        );
        let length = w * w + i * i + j * j + k * k;
        if !(length > 0.999 && length < 1.001) {
            return Err(StateError::Value {
                offset,
                what: "a quaternion that is not of unit length",
            });
        }
        // No normalisation: the quaternion must keep its bits. Its length was checked above.
        let mut orientation = normalised(1.0, 0.0, 0.0, 0.0);
        *orientation.as_mut_unchecked() = nalgebra::Quaternion::new(w, i, j, k);
        Ok(Pose {
            position,
            orientation,
        })
    }
}
