//! The two datagrams, at 1 kHz each: poses to the server, wrenches to the client.
//!
//! Both have a prefix of version and kind, and a fixed size. The size is far below 1,200 bytes, which every QUIC path
//! carries.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::codec::{self, CodecError};
use crate::{PROTOCOL_VERSION, TOOLS};

/// Length of version and kind before the body, bytes.
const PREFIX: usize = 2;
/// Largest body of a datagram that decoding reads, bytes.
const LIMIT: usize = 512;
/// Capacity of a tool's slot for contact planes.
pub const PLANES: usize = 4;

/// Force and torque in world axes about the tool's device point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireWrench {
    /// Force, newtons.
    pub force: [f32; 3],
    /// Torque, newton-metres.
    pub torque: [f32; 3],
}

/// Pose `world_from_tool` at the tool's device point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WirePose {
    /// Position, metres.
    pub position: [f32; 3],
    /// Quaternion `[w, x, y, z]` of roughly unit length. Decoding does not check the length; the tick does.
    pub orientation: [f32; 4],
}

impl WirePose {
    /// Identity: at the origin, without rotation.
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

/// Slot of a tool in a pose datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolPose {
    /// Whether a hand holds the tool.
    pub present: bool,
    /// Buttons held, one bit per button.
    pub buttons: u16,
    /// Haptic pose, as measured by the device.
    pub pose: WirePose,
    /// Last wrench displayed by the device, after the client's own gates and limits.
    pub displayed: WireWrench,
}

/// Pose datagram, client to server, once per period of the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseDatagram {
    /// Session epoch. The server drops poses of another epoch.
    pub epoch: u32,
    /// Number of the pose, wrapping at 2^32.
    pub sequence: u32,
    /// Time of the device's reading, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
    /// Newest tick whose wrench has arrived; 0 before the first.
    pub last_tick: u64,
    /// Slots of the tools, always two.
    pub tools: [ToolPose; TOOLS],
}

impl PoseDatagram {
    /// Kind byte.
    pub const KIND: u8 = 1;
    /// Fixed length on the wire, bytes.
    pub const BYTES: usize = PREFIX + 24 + TOOLS * (3 + 28 + 24);

    /// Encodes the datagram. Allocates nothing.
    ///
    /// # Errors
    /// None for a value of this type. The signature is the codec's.
    pub fn to_bytes(&self) -> Result<[u8; Self::BYTES], CodecError> {
        encode(Self::KIND, self)
    }

    /// Decodes a datagram.
    ///
    /// # Errors
    /// The bytes are no valid pose datagram; the error names the violated rule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        decode(Self::KIND, Self::BYTES, bytes)
    }
}

/// Echo of the pose that a tick used, with its hold time at the server. The client computes the age of the pose and the
/// round trip on its own clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Echo {
    /// Whether any pose had arrived. The other fields are zero if not.
    pub valid: bool,
    /// Sequence number of the pose.
    pub sequence: u32,
    /// Device time of the pose, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
    /// Time from the pose's arrival at the server to the sending of this wrench, microseconds.
    pub hold_us: u32,
}

/// Plane touched by the graphic tool, in world axes. The half-space `normal . x >= offset` is free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plane {
    /// Unit normal, pointing out of the tissue.
    pub normal: [f32; 3],
    /// Signed distance from the world's origin along the normal, metres.
    pub offset: f32,
}

/// Slot of a tool in a wrench datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolWrench {
    /// Wrench for the hand.
    pub wrench: WireWrench,
    /// Constrained pose of the graphic tool, for display.
    pub graphic: WirePose,
    /// Status bits of [`crate::status`].
    pub status: u16,
    /// Number of planes in use, 0 to [`PLANES`]. The other planes are zero.
    pub plane_count: u8,
    /// Planes of a local contact model. Reserved: the server always sends a `plane_count` of 0.
    pub planes: [Plane; PLANES],
}

/// Wrench datagram, server to client, once per tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchDatagram {
    /// Session epoch. The client drops wrenches of another epoch.
    pub epoch: u32,
    /// Number of the wrench, wrapping at 2^32. Sequence numbers have no gaps; ticks have gaps at skipped grid points.
    pub sequence: u32,
    /// Tick that computed this wrench.
    pub tick: u64,
    /// Echo of the pose used by the tick.
    pub echo: Echo,
    /// Slots of the tools, always two.
    pub tools: [ToolWrench; TOOLS],
}

impl WrenchDatagram {
    /// Kind byte.
    pub const KIND: u8 = 2;
    /// Fixed length on the wire, bytes.
    pub const BYTES: usize = PREFIX + 16 + 17 + TOOLS * (24 + 28 + 2 + 1 + PLANES * 16);

    /// Encodes the datagram. Allocates nothing.
    ///
    /// # Errors
    /// A wrench, a graphic pose or a plane is not finite, or a slot or the echo is not canonical. Such a datagram is
    /// never sent.
    pub fn to_bytes(&self) -> Result<[u8; Self::BYTES], CodecError> {
        self.check()?;
        encode(Self::KIND, self)
    }

    /// Decodes a datagram.
    ///
    /// # Errors
    /// The bytes are no valid wrench datagram; the error names the violated rule. A wrench that is not finite never
    /// reaches a device.
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
            // Compared as bits, because encoding never writes minus zero here.
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
    // The version comes first: another version may have other lengths, and the error must name the version.
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
