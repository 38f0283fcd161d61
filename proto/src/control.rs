//! Control messages: rare, reliable, in order, on one bidirectional stream.
//!
//! The client sends [`ClientMessage::Hello`] with its role first. The server answers a student with
//! [`ServerMessage::Hello`], any other role with [`ServerMessage::Welcome`], or refuses with
//! [`ServerMessage::Refused`]. [`crate::permission`] lists the messages of each role.
//!
//! The simulation runs from [`ClientMessage::Start`] to [`ClientMessage::Stop`] or another [`EndReason`].
//! [`ServerMessage::Goodbye`] is the last message. A student whose connection is lost connects again with the same
//! token, and the session goes on under a new epoch.

use serde::{Deserialize, Serialize};

use crate::datagram::WirePose;
pub use crate::device::{DeviceCoupling, DeviceInfo};
use crate::display::SceneHash;
use crate::ghost::GhostPart;
use crate::role::Role;
use crate::station::{StationEvent, StationStatus};
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
    /// Exact inputs of ticks that ran at the hand, on a stream of their own in one direction. A server that ticks by
    /// itself refuses them.
    Inputs(InputBatch),
    /// Last tick at the hand: the motion has ended. Batches up to this tick follow on their stream. The message goes on
    /// the control stream and on the stream of inputs.
    LastTick(LastTick),
    /// Subscription of a display to the shapes of its station.
    Show(Show),
    /// Subscription of an instructor to the status and the events of all permitted stations.
    Watch,
    /// Instruction to a station. The server answers with [`ServerMessage::Answer`].
    Instruct(Instruct),
}

/// Last tick at the hand. Its hash fixes all inputs of the motion before the rest of them arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LastTick {
    /// Number of the tick.
    pub tick: u64,
    /// State hash after the tick.
    pub hash: u64,
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
    /// Acceptance of a connection that is no student's.
    Welcome(Welcome),
    /// Message of an instructor for the student's screen.
    Say(Say),
    /// Answer to an instruction.
    Answer(Answer),
    /// Status of a station, five times a second.
    Status(StationStatus),
    /// Event of a station.
    Event(StationEvent),
    /// Part of the path of a ghost for the student's screen.
    Ghost(GhostPart),
}

/// Identity of a client and its choice of exercise. The frame carries the protocol version.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClientHello {
    /// Version of the client program.
    pub program: String,
    /// Shared secret, as printed by the server.
    pub token: String,
    /// Role of the connection. The token's role must permit it.
    pub role: Role,
    /// Station; empty for the station of the token.
    pub station: String,
    /// Haptic devices, in the order of the tool slots: at most [`crate::TOOLS`]; none for a connection without a
    /// device. An empty slot before a used one has the default.
    #[serde(with = "crate::at_most_two")]
    pub devices: Vec<DeviceInfo>,
    /// Opaque learner id, never a name ([`crate::learner`]), or a claim by code ([`crate::learner::claim`]); empty for
    /// an anonymous learner.
    pub learner: String,
    /// Requested exercise; empty for the server's choice.
    pub exercise: String,
    /// Attach epoch of the connection that this one follows; 0 for the first connection of a program.
    pub epoch: u32,
    /// Bits of [`capability`].
    pub capabilities: u64,
    /// Hash of the tick self-test: equal hashes mean equal bits of equal ticks. 0: not computed.
    pub self_test: u64,
    /// Whether the client wishes to run the ticks at the hand. It then has the compiled scene of the exercise.
    pub tick_at_hand: bool,
    /// BLAKE3 hash of the client's compiled scene; zeros without a scene.
    pub scene_hash: [u8; 32],
}

/// Abilities of a program, one bit each. Unknown bits are ignored.
pub mod capability {
    /// The client can run the tick at the hand.
    pub const TICK_AT_HAND: u64 = 1;
    /// The client shows messages of an instructor.
    pub const SHOWS_MESSAGES: u64 = 1 << 1;
}

/// Exact inputs of consecutive ticks at the hand.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputBatch {
    /// First tick of the batch. A server skips a batch that it has taken before.
    pub first_tick: u64,
    /// State hash of the hand after the last tick of the batch.
    pub hash: u64,
    /// Number of commands of the station's side that all ticks of the batch obeyed, wrapping at 2^32.
    pub commands: u32,
    /// Inputs, as [`crate::at_hand::Packer`] packs them.
    pub rows: Vec<u8>,
}

/// Subscription of a display.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Show {
    /// Hashes of the display scenes that the client has, at most 64. The server does not send these scenes again.
    pub known: Vec<SceneHash>,
}

/// Instruction of an instructor to a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instruct {
    /// Number of the instruction in this connection, for its answer.
    pub number: u64,
    /// Name of the station.
    pub station: String,
    /// Content.
    pub instruction: Instruction,
}

/// Content of an instruction. Each text has at most [`crate::limits::TEXT_BYTES`] bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Instruction {
    /// Pause of the station's side: forces ramp to zero and stay zero until [`Instruction::Resume`].
    Pause,
    /// End of the pause of the station's side.
    Resume,
    /// Force limit of the station's side, newtons; 0 for the scene's limit.
    ForceLimit(f32),
    /// Note for the recording.
    Note(String),
    /// Mark of this moment in the recording, with a text that may be empty.
    Flag(String),
    /// Message for the student's screen; the recording holds it too.
    Say(String),
    /// End of the session.
    End,
    /// Plan for the next session, as TOML.
    Plan(String),
    /// Ghost on the student's screen: file name of the recording whose hands are shown; empty for none. An exam has no
    /// ghost.
    Ghost(String),
}

/// Answer of the server to an instruction.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// Number of the instruction.
    pub number: u64,
    /// Whether the instruction is in force.
    pub taken: bool,
    /// First tick that obeys the instruction; 0 without a session.
    pub tick: u64,
    /// Reason of a refusal, or a remark; may be empty.
    pub text: String,
}

/// Message of an instructor for the student's screen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Say {
    /// Opaque id of the instructor's token.
    pub by: String,
    /// Text for display.
    pub text: String,
}

/// Acceptance of an instructor, an examiner, an administrator or a display.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Welcome {
    /// Version of the server program.
    pub program: String,
    /// Role of the connection.
    pub role: Role,
    /// Opaque id of the token, as other instructors and recordings see it.
    pub id: String,
    /// Names of the permitted stations.
    pub stations: Vec<String>,
}

/// Plan of a session, as far as a student may know it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlanInfo {
    /// Revision of the plan, from 1 on.
    pub revision: u32,
    /// Purpose of the session: practice, assessment or exam.
    pub mode: String,
    /// Time limit of the session, seconds; 0 for none.
    pub time_limit_s: u32,
    /// Time for a return after a lost connection, milliseconds; 0: a lost connection ends the session.
    pub resume_within_ms: u32,
    /// Whether the session's clock runs while the student is gone.
    pub clock_in_gap: bool,
    /// Whether the ticks run at the hand.
    pub tick_at_hand: bool,
    /// Reason against the client's wish to run the ticks at the hand, one sentence; empty if there was none.
    pub tick_remark: String,
}

/// Description of the session for a client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServerHello {
    /// Version of the server program.
    pub program: String,
    /// Name of the station.
    pub station: String,
    /// Attach epoch, which the datagrams carry. [`ServerMessage::Epoch`] replaces it.
    pub epoch: u32,
    /// Whether this connection continues a running session. The client then sends no start.
    pub resumed: bool,
    /// Plan of the session.
    pub plan: PlanInfo,
    /// Bits of [`capability`].
    pub capabilities: u64,
    /// Hash of the server's tick self-test; 0: not computed.
    pub self_test: u64,
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
    /// Coupling stiffness in force, in translation, N/m: the smaller of the scene's and the device's. The bits matter
    /// to ticks at the hand.
    pub stiffness_n_per_m: f64,
    /// Coupling stiffness in force, in rotation, N m/rad: the smaller of the scene's and the device's.
    pub stiffness_nm_per_rad: f64,
}

/// Reason of a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RefusedReason {
    /// The protocol versions differ.
    Version,
    /// The token is wrong.
    Token,
    /// The token has expired or was revoked.
    Expired,
    /// The token does not permit the role or the station.
    Role,
    /// Another learner uses the station.
    Busy,
    /// The machine has no room for a further session.
    Full,
    /// The server does not offer the exercise.
    Exercise,
    /// The hello is missing or invalid.
    BadHello,
    /// The server cannot run a session; [`Refused::text`] holds the cause.
    Server,
    /// The device cannot display the coupling of the running session.
    Device,
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
