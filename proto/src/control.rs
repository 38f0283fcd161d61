//! Control messages: rare, reliable, in order, on one bidirectional stream.
//!
//! The client sends [`ClientMessage::Hello`] first. The server answers with [`ServerMessage::Hello`] or
//! [`ServerMessage::Refused`]. The simulation runs from [`ClientMessage::Start`] to [`ClientMessage::Stop`] or another
//! [`EndReason`]. [`ServerMessage::Goodbye`] is the last message.

use serde::{Deserialize, Serialize};

use crate::datagram::WirePose;
pub use crate::summary::EndReason;
use crate::summary::SessionSummary;

/// Message from the client to the server.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ClientMessage {
    /// First message: identity of the client.
    Hello(ClientHello),
    /// Start of the simulation and of the recording.
    Start,
    /// Change of the student's own pause or force limit. Pause and limit of the server side stay in force.
    Command(Command),
    /// Edge of a button. Every pose also carries the button's state, but only the edge is reliable.
    Button(ButtonEdge),
    /// Event for the recording, for example a probing depth called out by the student.
    Event(Event),
    /// End of the session. The server answers with [`ServerMessage::Goodbye`].
    Stop,
}

/// Message from the server to the client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ServerMessage {
    /// Acceptance of the client.
    Hello(ServerHello),
    /// Refusal of the client; the connection closes.
    Refused(Refused),
    /// New session epoch. Datagrams of any other epoch are dropped from now on.
    Epoch(u32),
    /// End of the session, with its reason. The connection then closes.
    Goodbye(Goodbye),
}

/// Identity of a client and its choice of exercise. The frame carries the protocol version.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClientHello {
    /// Version of the client program.
    pub program: String,
    /// Shared secret, as printed by the server.
    pub token: String,
    /// Kind of haptic device, for the recording.
    pub device: String,
    /// Opaque learner id, never a name ([`crate::learner`]); empty for an anonymous learner.
    pub learner: String,
    /// Requested exercise; empty for the server's choice.
    pub exercise: String,
}

/// Description of the session for a client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServerHello {
    /// Version of the server program.
    pub program: String,
    /// Session epoch of the datagrams at the start. [`ServerMessage::Epoch`] replaces it.
    pub epoch: u32,
    /// Period of a tick, nanoseconds.
    pub tick_ns: u64,
    /// Name of the scene, for display.
    pub scene: String,
    /// BLAKE3 hash of the compiled scene.
    pub scene_hash: [u8; 32],
    /// Name of the exercise.
    pub exercise: String,
    /// Instructions of the exercise for the student.
    pub exercise_text: String,
    /// Seed of the random numbers of the exercise.
    pub seed: u64,
    /// Limit of the force sent to the client, newtons.
    pub max_force_n: f32,
    /// Limit of the torque sent to the client, newton-metres.
    pub max_torque_nm: f32,
    /// Largest change of the force per millisecond, newtons. Devices apply the same slew limit.
    pub max_force_step_n: f32,
    /// Largest change of the torque per millisecond, newton-metres.
    pub max_torque_step_nm: f32,
    /// Tools, in the order of the slots: at least one, at most two.
    pub tools: Vec<ToolInfo>,
}

/// Description of a tool for a client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolInfo {
    /// Name, for display.
    pub name: String,
    /// Initial pose of the graphic tool, before its first entry: `world_from_tool`.
    pub park: WirePose,
    /// Extreme point of the tip in the tool's frame, metres.
    pub tip: [f32; 3],
    /// Coupling stiffness in translation, N/m. A device must be able to display this stiffness.
    pub stiffness_n_per_m: f32,
    /// Coupling stiffness in rotation, N m/rad.
    pub stiffness_nm_per_rad: f32,
}

/// Reason of a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RefusedReason {
    /// The protocol versions differ.
    Version,
    /// The token is wrong.
    Token,
    /// Another client is connected.
    Busy,
    /// The server does not offer the exercise.
    Exercise,
    /// The hello is missing or invalid.
    BadHello,
    /// The server cannot run a session; [`Refused::text`] holds the cause.
    Server,
}

/// Refusal of a client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    /// Reason, for programs.
    pub reason: RefusedReason,
    /// Reason as one sentence, for display.
    pub text: String,
}

/// Change of a pause or a force limit.
///
/// The server side and the student's connection each hold a pause and a limit. The pause of either side and the smaller
/// limit apply.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Start of the side's pause: forces ramp to zero and stay zero.
    Pause,
    /// End of the side's own pause. A new session epoch begins, and forces ramp up unless the other side has paused.
    Resume,
    /// Force limit of the side, newtons; 0 for none. The scene's limit always applies too. A negative, infinite or NaN
    /// value is ignored.
    ForceLimit(f32),
}

/// Edge of a button: pressed or released.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ButtonEdge {
    /// Tool slot, 0 or 1.
    pub tool: u8,
    /// Button number, 0 to 15.
    pub button: u8,
    /// Whether the button was pressed; false for a release.
    pub pressed: bool,
    /// Time of the edge, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
}

/// Event for the recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Newest tick whose wrench had arrived at the time of the event.
    pub tick: u64,
    /// Kind, for example `reading_called`: one word of lower-case letters, digits and underscores.
    ///
    /// Kinds that the server itself records, such as `bleeding`, are not allowed. An invalid kind ends the session with
    /// [`EndReason::Protocol`].
    pub kind: String,
    /// Content as JSON.
    pub json: String,
}

/// Last message of the server in a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goodbye {
    /// Reason for the end, for display. Usually one sentence; a second one says that the recording has lost rows.
    pub text: String,
    /// Statistics of the session, with the reason for its end.
    pub summary: SessionSummary,
}
