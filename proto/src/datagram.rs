//! The two datagrams, at 1 kHz each: a pose up, a wrench down. Both have a fixed size far below the
//! 1,200 bytes that every path carries, and a prefix of version and kind.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::codec::{self, CodecError};
use crate::{PROTOCOL_VERSION, TOOLS};

/// Bytes of version and kind before the body.
const PREFIX: usize = 2;
/// Largest datagram decoded here.
const LIMIT: usize = 512;
/// Contact planes that one tool's slot has room for.
pub const PLANES: usize = 4;

/// Force and torque in world axes about the tool's device point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireWrench {
    /// Force, newtons.
    pub force: [f32; 3],
    /// Torque, newton-metres.
    pub torque: [f32; 3],
}

/// `world_from_tool` at the tool's device point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WirePose {
    /// Position, metres.
    pub position: [f32; 3],
    /// Quaternion `[w, x, y, z]`, roughly unit length; not checked here (the tick sanitises it).
    pub orientation: [f32; 4],
}

impl WirePose {
    /// At the origin, not turned.
    pub const IDENTITY: WirePose = WirePose {
        position: [0.0; 3],
        orientation: [1.0, 0.0, 0.0, 0.0],
    };
}

impl Default for WirePose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// One tool's slot in a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolPose {
    /// Whether a hand holds the tool.
    pub present: bool,
    /// Buttons held, one bit each.
    pub buttons: u16,
    /// Where the hand holds it.
    pub pose: WirePose,
    /// The wrench that the device really displayed last: after the client's own gates and limits.
    pub displayed: WireWrench,
}

/// Station to server, once per period of the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseDatagram {
    /// Session epoch: packets of another epoch are dropped.
    pub epoch: u32,
    /// Counts poses; wraps.
    pub sequence: u32,
    /// When the device was read, nanoseconds of the station's monotonic clock.
    pub device_time_ns: u64,
    /// Newest tick whose wrench has arrived; 0 before the first.
    pub last_tick: u64,
    /// Always two slots.
    pub tools: [ToolPose; TOOLS],
}

impl PoseDatagram {
    /// Kind byte.
    pub const KIND: u8 = 1;
    /// Length on the wire, always.
    pub const BYTES: usize = PREFIX + 24 + TOOLS * (3 + 28 + 24);

    /// Bytes on the wire; allocates nothing.
    ///
    /// # Errors
    /// Never for a value of this type; the codec's signature is passed on.
    pub fn to_bytes(&self) -> Result<[u8; Self::BYTES], CodecError> {
        encode(Self::KIND, self)
    }

    /// Reads one datagram.
    ///
    /// # Errors
    /// Says which rule the bytes break.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        decode(Self::KIND, Self::BYTES, bytes)
    }
}

/// Echo of the pose that a tick used, from which the station computes age and round trip on its own
/// clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Echo {
    /// Whether any pose had arrived; all else is zero if not.
    pub valid: bool,
    /// The pose's sequence.
    pub sequence: u32,
    /// The pose's device time, nanoseconds of the station's clock.
    pub device_time_ns: u64,
    /// From the pose's arrival at the server to the sending of this wrench, microseconds.
    pub hold_us: u32,
}

/// A plane that the graphic tool touches: `normal . x >= offset` is free, world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plane {
    /// Unit vector out of the tissue.
    pub normal: [f32; 3],
    /// Along the normal from the world's origin, metres.
    pub offset: f32,
}

/// One tool's slot in a wrench.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolWrench {
    /// For the hand.
    pub wrench: WireWrench,
    /// Graphic tool: constrained pose, to look at.
    pub graphic: WirePose,
    /// Bits of [`crate::status`].
    pub status: u16,
    /// Planes in use; the others are zero.
    pub plane_count: u8,
    /// Local contact model (room for it; `plane_count` is 0 today).
    pub planes: [Plane; PLANES],
}

/// Server to station, once per tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchDatagram {
    /// Session epoch: packets of another epoch are dropped.
    pub epoch: u32,
    /// Counts wrenches; wraps. (Ticks have holes where the grid was skipped, this has none.)
    pub sequence: u32,
    /// Tick that gave this wrench.
    pub tick: u64,
    /// The pose that it answers.
    pub echo: Echo,
    /// Always two slots.
    pub tools: [ToolWrench; TOOLS],
}

impl WrenchDatagram {
    /// Kind byte.
    pub const KIND: u8 = 2;
    /// Length on the wire, always.
    pub const BYTES: usize = PREFIX + 16 + 17 + TOOLS * (24 + 28 + 2 + 1 + PLANES * 16);

    /// Bytes on the wire; allocates nothing.
    ///
    /// # Errors
    /// If a wrench is not finite or a slot is not canonical: such a datagram is never sent.
    pub fn to_bytes(&self) -> Result<[u8; Self::BYTES], CodecError> {
        self.check()?;
        encode(Self::KIND, self)
    }

    /// Reads one datagram.
    ///
    /// # Errors
    /// Says which rule the bytes break; a wrench that is not finite never reaches a device.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        let datagram: Self = decode(Self::KIND, Self::BYTES, bytes)?;
        datagram.check()?;
        Ok(datagram)
    }

    fn check(&self) -> Result<(), CodecError> {
        let echo = &self.echo;
        if !echo.valid && (echo.sequence != 0 || echo.device_time_ns != 0 || echo.hold_us != 0) {
            return Err(CodecError::NotCanonical("an echo of no pose is not zero"));
        }
        for tool in &self.tools {
            if !tool
                .wrench
                .force
                .iter()
                .chain(&tool.wrench.torque)
                .all(|x| x.is_finite())
            {
                return Err(CodecError::NotFinite("a wrench"));
            }
            if !tool
                .graphic
                .position
                .iter()
                .chain(&tool.graphic.orientation)
                .all(|x| x.is_finite())
            {
                return Err(CodecError::NotFinite("a graphic pose"));
            }
            let used = usize::from(tool.plane_count);
            let Some(unused) = tool.planes.get(used..) else {
                return Err(CodecError::NotCanonical(
                    "more planes than there is room for",
                ));
            };
            // Compared as bits: minus zero is not what encoding writes.
            if unused.iter().flat_map(numbers).any(|x| x.to_bits() != 0) {
                return Err(CodecError::NotCanonical("an unused plane is not zero"));
            }
            if !tool.planes.iter().flat_map(numbers).all(f32::is_finite) {
                return Err(CodecError::NotFinite("a plane"));
            }
        }
        Ok(())
    }
}

fn numbers(plane: &Plane) -> [f32; 4] {
    let [x, y, z] = plane.normal;
    [x, y, z, plane.offset]
}

fn encode<T: Serialize, const N: usize>(kind: u8, value: &T) -> Result<[u8; N], CodecError> {
    let mut bytes = [0; N];
    bytes[0] = PROTOCOL_VERSION;
    bytes[1] = kind;
    let found = PREFIX + codec::encode_into(value, &mut bytes[PREFIX..])?;
    if found == N {
        Ok(bytes)
    } else {
        Err(CodecError::Length { found, expected: N })
    }
}

fn decode<T: DeserializeOwned>(kind: u8, expected: usize, bytes: &[u8]) -> Result<T, CodecError> {
    // Version first: another version may well have other lengths, and should be named as such.
    let &[version, found, ref body @ ..] = bytes else {
        return Err(CodecError::Length {
            found: bytes.len(),
            expected,
        });
    };
    if version != PROTOCOL_VERSION {
        return Err(CodecError::Version { found: version });
    }
    if found != kind {
        return Err(CodecError::Kind {
            found,
            expected: kind,
        });
    }
    if bytes.len() != expected {
        return Err(CodecError::Length {
            found: bytes.len(),
            expected,
        });
    }
    codec::decode::<T, LIMIT>(body)
}
