//! Entries of the log.

use serde::{Deserialize, Serialize};

use crate::Vector;
use crate::fault::Fault;
use crate::version::Version;

/// Entry of the log; one line of JSON in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Time on the monotonic clock of the service, in ns.
    pub t_ns: u64,
    /// What happened.
    pub what: What,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// The service listens.
    Started {
        /// Version.
        version: Version,
        /// Port of the simulation channel.
        port: u16,
        /// Port of the channel of events.
        events_port: u16,
    },
    /// The service ended in order.
    Stopped,
    /// A simulation connection stands.
    Connected {
        /// Number of the connection, from 1.
        connection: u64,
    },
    /// A simulation connection ended.
    Ended {
        /// Number of the connection.
        connection: u64,
        /// Reason.
        reason: EndReason,
        /// Number of messages of the client.
        messages: u64,
    },
    /// A connection of the channel of events stands.
    EventsConnected,
    /// A connection of the channel of events ended.
    EventsEnded,
    /// A message of a client.
    Message {
        /// Number of the connection.
        connection: u64,
        /// Number of the message in its connection, from 1.
        number: u64,
        /// Commands of the message.
        commands: Vec<Command>,
    },
    /// An arm takes commands.
    Active {
        /// Id of the arm.
        device: String,
        /// Number of the connection.
        connection: u64,
    },
    /// An arm went idle; the force of the client is zero.
    Idle {
        /// Id of the arm.
        device: String,
        /// Cause.
        cause: IdleCause,
        /// Time of the last command of any connection, in ns.
        last_command_ns: u64,
    },
    /// A client broke a rule of the protocol.
    Violation {
        /// Number of the connection; 0 for the channel of events.
        connection: u64,
        /// Number of the message in its connection.
        number: u64,
        /// Rule.
        rule: Violation,
        /// Detail for a reader.
        detail: String,
    },
    /// An event went to the channel of events.
    Event {
        /// Name.
        name: String,
        /// Id of the device; empty where the event has none.
        device: String,
        /// Number of connections that got it.
        listeners: usize,
    },
    /// A request over HTTP.
    Http {
        /// Method.
        method: String,
        /// Path.
        path: String,
        /// Status of the answer.
        status: u16,
    },
    /// The test commanded a fault.
    Fault {
        /// Fault.
        fault: Fault,
    },
}

/// A command of a client to a device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Id of the device.
    pub device: String,
    /// Name of the command.
    pub name: String,
    /// Field of the force or position that the client used.
    pub field: Option<String>,
    /// Force that the client asked for, in N; none for another command or an unreadable force.
    pub force: Option<Vector>,
    /// True where the service carried the command out.
    pub done: bool,
    /// Force that the arm displays after the message, in N; with every source and factor.
    pub displayed: Option<Vector>,
}

/// Reason for the end of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// The client sent a close message.
    ClosedByClient,
    /// The connection ended without a close message, for example with the process of the client.
    Lost,
    /// A fault ended the connection.
    Fault,
    /// The service ended.
    ServiceStopped,
    /// The client sent bytes that are no WebSocket frame.
    BadFrame,
}

/// Cause of the idle state of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdleCause {
    /// No command came for the time of the watchdog.
    Watchdog,
    /// A message of the client had no command for the arm.
    NotCommanded,
}

/// Rule of the protocol that a client broke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Violation {
    /// A message came before the reply to the previous one; allowed by the service.
    Pipelined,
    /// The first message has no name of a profile.
    ProfileMissing,
    /// A later message has a name of a profile again.
    ProfileRepeated,
    /// The field of a force or position has the name of another version.
    WrongField,
    /// A force or position has no readable vector.
    BadVector,
    /// The message is no JSON or of the wrong form.
    BadJson,
    /// The message is no text.
    NotText,
    /// No device has this id in this array.
    UnknownDevice,
    /// The device of this id is unplugged.
    AbsentDevice,
    /// No such command exists for the device.
    UnknownCommand,
    /// A message came on the channel of events, which is read only.
    WroteToEvents,
}
