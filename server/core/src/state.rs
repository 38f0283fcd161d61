//! Everything that outlives a tick, every warm start included; saved and restored exactly.

use crate::math::{Pose, Vec3, Wrench, norm, normalised};
use crate::params::within;
use crate::{MAX_TOOLS, Scene};

/// What outlives a tick of one tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// Last haptic pose after sanitising; meaningful when `entered`.
    pub haptic: Pose,
    /// Graphic pose.
    pub graphic: Pose,
    /// Whether the tool was present in the last tick.
    pub entered: bool,
    /// Ticks in a row whose pose was unusable.
    pub bad_ticks: u16,
    /// Ramp of the wrench, 0 to 1.
    pub gain: f64,
    /// Wrench sent last, about the device point.
    pub sent: Wrench,
    /// Raw wrench of the last tick in which the tool was present, about the device point.
    pub raw: Wrench,
    /// Axis of the last twist between hand and tool; kept beyond 170 degrees, where the logarithm
    /// flips.
    pub twist_axis: Vec3,
}

/// State of a simulation between two ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Number of the last tick; 0 before the first.
    pub tick: u64,
    /// Chained hash after the last tick; 0 before the first.
    pub hash: u64,
    /// Per tool slot.
    pub tools: [ToolState; MAX_TOOLS],
    /// Load by each tool on each object, tool-major: force and torque about the world's origin.
    pub loads: Vec<Wrench>,
    /// State of all tissues, object after object.
    pub tissue: Vec<f64>,
}

/// Why bytes are not a state of this scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// Wrong length.
    #[error("state has {found} bytes, this scene's has {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// A number that no tick can produce.
    #[error("state, byte {offset}: {what}")]
    Value {
        /// Where.
        offset: usize,
        /// What is wrong.
        what: &'static str,
    },
}

/// Bytes of one tool: two poses, a flag, a count, the ramp, two wrenches, an axis.
const TOOL_BYTES: usize = 2 * 7 * 8 + 1 + 2 + 8 + 2 * 6 * 8 + 3 * 8;

impl State {
    /// The state before the first tick: tools parked, tissue at rest.
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
            tissue: vec![0.0; tissue_len(scene)],
        }
    }

    /// Length of the bytes of a state of `scene`.
    pub fn bytes_len(scene: &Scene) -> usize {
        16 + MAX_TOOLS * TOOL_BYTES
            + scene.tools.len() * scene.objects.len() * 48
            + tissue_len(scene) * 8
    }

    /// Exact little-endian bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_bytes(&mut bytes);
        bytes
    }

    /// Appends the exact bytes; allocates only when `bytes` lacks capacity.
    pub fn write_bytes(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.tick.to_le_bytes());
        bytes.extend_from_slice(&self.hash.to_le_bytes());
        let mut put = |x: f64| bytes.extend_from_slice(&x.to_bits().to_le_bytes());
        for tool in &self.tools {
            for pose in [&tool.haptic, &tool.graphic] {
                pose.position.iter().for_each(|x| put(*x));
                let q = &pose.orientation;
                [q.w, q.i, q.j, q.k].into_iter().for_each(&mut put);
            }
            put(tool.gain);
            for wrench in [&tool.sent, &tool.raw] {
                put_wrench(wrench, &mut put);
            }
            tool.twist_axis.iter().for_each(|x| put(*x));
        }
        for load in &self.loads {
            put_wrench(load, &mut put);
        }
        self.tissue.iter().for_each(|x| put(*x));
        for tool in &self.tools {
            bytes.push(u8::from(tool.entered));
            bytes.extend_from_slice(&tool.bad_ticks.to_le_bytes());
        }
    }

    /// Inverse of [`State::to_bytes`] for the same scene.
    ///
    /// # Errors
    /// When the length is not this scene's, or a number is one that no tick can produce.
    pub fn from_bytes(scene: &Scene, bytes: &[u8]) -> Result<Self, StateError> {
        let expected = Self::bytes_len(scene);
        if bytes.len() != expected {
            return Err(StateError::Length {
                found: bytes.len(),
                expected,
            });
        }
        let mut reader = Reader { bytes, at: 0 };
        let mut state = Self::new(scene);
        state.tick = reader.word();
        state.hash = reader.word();
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
            *load = reader.wrench()?;
        }
        for x in &mut state.tissue {
            *x = reader.number()?;
        }
        for tool in &mut state.tools {
            tool.entered = match bytes[reader.at] {
                0 => false,
                1 => true,
                _ => {
                    return Err(StateError::Value {
                        offset: reader.at,
                        what: "a flag that is neither 0 nor 1",
                    });
                }
            };
            tool.bad_ticks = u16::from_le_bytes([bytes[reader.at + 1], bytes[reader.at + 2]]);
            reader.at += 3;
        }
        Ok(state)
    }
}

/// What no tick produces must not come in by a file: a wrench beyond the scene's limits, a ramp beyond
/// one, a tick that cannot be counted on from.
fn check_ranges(scene: &Scene, state: &State) -> Result<(), StateError> {
    let bad = |what| Err(StateError::Value { offset: 0, what });
    if state.tick > u64::MAX / 2 {
        return bad("a tick beyond counting");
    }
    // Head-room for rounding in the clamp.
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

fn put_wrench(wrench: &Wrench, put: &mut impl FnMut(f64)) {
    wrench
        .force
        .iter()
        .chain(wrench.torque.iter())
        .for_each(|x| put(*x));
}

/// Numbers of tissue state in a scene.
pub(crate) fn tissue_len(scene: &Scene) -> usize {
    scene
        .objects
        .iter()
        .map(|object| object.tissue.state_len(&object.tree))
        .sum()
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn word(&mut self) -> u64 {
        let mut word = [0; 8];
        word.copy_from_slice(&self.bytes[self.at..self.at + 8]);
        self.at += 8;
        u64::from_le_bytes(word)
    }

    fn number(&mut self) -> Result<f64, StateError> {
        let offset = self.at;
        let x = f64::from_bits(self.word());
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
        // Bit-exact: not normalised again, a unit quaternion only by construction.
        let mut orientation = normalised(1.0, 0.0, 0.0, 0.0);
        *orientation.as_mut_unchecked() = nalgebra::Quaternion::new(w, i, j, k);
        Ok(Pose {
            position,
            orientation,
        })
    }
}
