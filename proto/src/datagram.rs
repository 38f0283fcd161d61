//! The two datagrams, at 1 kHz each: poses to the server, wrenches to the client.
//!
//! Both have a prefix of version and kind, and a fixed size. The size is far below 1,200 bytes, which every QUIC path
//! carries.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::codec::{self, CodecError};
use crate::reception::Reception;
use crate::{PROTOCOL_VERSION, TOOLS};

/// Length of version and kind before the body, bytes.
const PREFIX: usize = 2;
/// Largest body of a datagram that decoding reads, bytes.
const LIMIT: usize = 512;

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
    /// Number of the device's reading, wrapping at 2^32. The devices of two hands count apart.
    pub sequence: u32,
    /// Time of the device's reading, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
    /// Period of the device's loop, microseconds; 0 if unknown.
    pub period_us: u32,
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
    /// Number of the datagram, wrapping at 2^32.
    pub sequence: u32,
    /// Slots of the tools, always two.
    pub tools: [ToolPose; TOOLS],
    /// Quality of the way of the wrenches.
    pub reception: Reception,
    /// Newest tick at the hand; 0 if the server ticks.
    pub tick: u64,
}

impl PoseDatagram {
    /// Kind byte.
    pub const KIND: u8 = 1;
    /// Fixed length on the wire, bytes.
    pub const BYTES: usize = PREFIX + 8 + TOOLS * (3 + 16 + 28 + 24) + 3 + 8;

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

/// Echo of the device's reading that a tick used, with its hold time at the server. The client computes the age of the
/// pose and the round trip on its own clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Echo {
    /// Whether a pose of the tool had arrived in this epoch. The other fields are zero if not.
    pub valid: bool,
    /// Number of the device's reading.
    pub sequence: u32,
    /// Device time of the pose, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
    /// Time from the pose's arrival at the server to the sending of this wrench, microseconds.
    pub hold_us: u32,
    /// Time from the pose's arrival at the server to the begin of the first tick that used it, microseconds. The client
    /// shifts the times of its poses until this wait is short.
    pub wait_us: u32,
}

/// Pause and force limit in force, in every wrench datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireLevels {
    /// Whether the station's side has paused.
    pub paused_by_station: bool,
    /// Whether the student has paused.
    pub paused_by_student: bool,
    /// Smaller force limit of both sides, newtons; 0 for the scene's limit.
    pub force_limit_n: f32,
    /// Number of commands of the station's side so far, wrapping at 2^32. Ticks at the hand name it with their inputs.
    pub commands: u32,
}

/// The smaller of two force limits, newtons; 0 stands for none.
pub fn smaller_limit(a: f32, b: f32) -> f32 {
    match (a, b) {
        (0.0, only) | (only, 0.0) => only,
        (a, b) if a < b => a,
        (_, b) => b,
    }
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
    /// Echo of the device's reading used by the tick.
    pub echo: Echo,
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
    /// Pause and force limit that the tick obeyed.
    pub levels: WireLevels,
    /// Slots of the tools, always two.
    pub tools: [ToolWrench; TOOLS],
    /// Quality of the way of the poses.
    pub reception: Reception,
}

impl WrenchDatagram {
    /// Kind byte.
    pub const KIND: u8 = 2;
    /// Fixed length on the wire, bytes.
    pub const BYTES: usize = PREFIX + 16 + 10 + TOOLS * (24 + 28 + 2 + 21) + 3;

    /// Encodes the datagram. Allocates nothing.
    ///
    /// # Errors
    /// A wrench, a graphic pose or the force limit is not finite, or an echo is not canonical. Such a datagram is never
    /// sent.
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
        let limit = self.levels.force_limit_n;
        if !limit.is_finite() {
            return Err(CodecError::NotFinite("the force limit"));
        }
        if limit < 0.0 {
            return Err(CodecError::NotCanonical("the force limit is negative"));
        }
        for tool in &self.tools {
            let WireWrench { force, torque } = &tool.wrench;
            if !force.iter().chain(torque).all(|x| x.is_finite()) {
                return Err(CodecError::NotFinite("a wrench"));
            }
            let WirePose {
                position,
                orientation,
            } = &tool.graphic;
            if !position.iter().chain(orientation).all(|x| x.is_finite()) {
                return Err(CodecError::NotFinite("a graphic pose"));
            }
            let echo = &tool.echo;
            if !echo.valid && *echo != Echo::default() {
                return Err(CodecError::NotCanonical("an echo of no pose is not zero"));
            }
        }
        Ok(())
    }
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
