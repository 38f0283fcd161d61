//! Control messages: rare, reliable, in order, on one bidirectional stream.
//!
//! The client speaks first: [`ClientMessage::Hello`]. The server answers [`ServerMessage::Hello`] or
//! [`ServerMessage::Refused`]. The simulation runs from [`ClientMessage::Start`] to
//! [`ClientMessage::Stop`] (or any other [`EndReason`]); [`ServerMessage::Goodbye`] is the last word.

use serde::{Deserialize, Serialize};

use crate::datagram::WirePose;
use crate::summary::SessionSummary;

/// From a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ClientMessage {
    /// Who asks; the first message.
    Hello(ClientHello),
    /// Begin to tick and record.
    Start,
    /// A request of the student's own: a pause, its end, a lower force limit. What the station's side has set stands.
    Command(Command),
    /// A button went down or up. Its state also rides in every pose; the edge is never lost.
    Button(ButtonEdge),
    /// Something that belongs into the recording (a depth that the student called out).
    Event(Event),
    /// End the session; a goodbye follows.
    Stop,
}

/// From a server.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ServerMessage {
    /// Welcome.
    Hello(ServerHello),
    /// Not welcome; the connection closes.
    Refused(Refused),
    /// From now on this session epoch counts: datagrams of any other are dropped.
    Epoch(u32),
    /// The session is over; the connection closes.
    Goodbye(Goodbye),
}

/// A station introduces itself. (The protocol version stands in front of every frame.)
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClientHello {
    /// Version of the client program.
    pub program: String,
    /// Shared secret, as the server prints it.
    pub token: String,
    /// Kind of haptic device, for the record.
    pub device: String,
    /// Opaque learner id, never a name ([`crate::learner`]); may be empty.
    pub learner: String,
    /// Exercise asked for; empty: the server's choice.
    pub exercise: String,
}

/// What a station needs to know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServerHello {
    /// Version of the server program.
    pub program: String,
    /// Session epoch that datagrams carry.
    pub epoch: u32,
    /// Period of the simulation, nanoseconds.
    pub tick_ns: u64,
    /// Name of the scene, for people.
    pub scene: String,
    /// BLAKE3 of the compiled scene.
    pub scene_hash: [u8; 32],
    /// Name of the exercise.
    pub exercise: String,
    /// What the student is asked to do.
    pub exercise_text: String,
    /// Seed of what is random in the exercise.
    pub seed: u64,
    /// Largest force that will be sent, newtons.
    pub max_force_n: f32,
    /// Largest torque that will be sent, newton-metres.
    pub max_torque_nm: f32,
    /// One or two tools, in the order of the slots.
    pub tools: Vec<ToolInfo>,
}

/// A tool, seen from a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolInfo {
    /// Name, for people.
    pub name: String,
    /// Where the graphic tool waits at first: `world_from_tool`.
    pub park: WirePose,
    /// Very tip in the tool's frame, metres.
    pub tip: [f32; 3],
    /// Coupling stiffness in translation, N/m: what a device must be able to display.
    pub stiffness_n_per_m: f32,
    /// Coupling stiffness in rotation, N m/rad.
    pub stiffness_nm_per_rad: f32,
}

/// Why a station is not served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RefusedReason {
    /// Another protocol version.
    Version,
    /// The token is wrong.
    Token,
    /// Another client is connected.
    Busy,
    /// The exercise is not offered here.
    Exercise,
    /// The hello makes no sense.
    BadHello,
    /// The server cannot serve (it says why).
    Server,
}

/// A refusal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    /// For programs.
    pub reason: RefusedReason,
    /// For people: one sentence.
    pub text: String,
}

/// A change of pause or force limit. The station's side and the student's connection each have a pause and a limit of
/// their own; in force is the pause of either and the smaller limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Forces ramp to zero and stay there.
    Pause,
    /// The side's own pause ends; when no other holds, forces ramp up again. A new session epoch begins.
    Resume,
    /// Largest force, newtons, never above the scene's limit; 0: no limit of this side's own.
    ForceLimit(f32),
}

/// A button went down or up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ButtonEdge {
    /// Tool slot, 0 or 1.
    pub tool: u8,
    /// Button, 0 to 15.
    pub button: u8,
    /// Down or up.
    pub pressed: bool,
    /// When, nanoseconds of the station's monotonic clock.
    pub device_time_ns: u64,
}

/// Something that belongs into the recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Tick whose wrench had just arrived.
    pub tick: u64,
    /// What it is, for example `reading_called`: one word of lower-case letters, digits and underscores, and none that the station
    /// itself says (`bleeding`, ...); any other ends the session.
    pub kind: String,
    /// Its content as JSON.
    pub json: String,
}

/// Why a session ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// The client stopped it.
    Stopped,
    /// Its longest allowed time was over.
    TimeUp,
    /// The server was shut down.
    Shutdown,
    /// The client went silent or closed the connection.
    ConnectionLost,
    /// The client broke the protocol.
    Protocol,
    /// The recording could not be written.
    Recording,
    /// The simulation could not run.
    Simulation,
}

/// Last word of a server.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goodbye {
    /// For people: one sentence.
    pub text: String,
    /// The session in numbers, with the reason for its end.
    pub summary: SessionSummary,
}
