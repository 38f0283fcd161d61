//! What a test says to its client, and what the client answers: one JSON value in each line.

use serde::{Deserialize, Serialize};

/// Mark before an answer: other lines are the test runner's.
pub const MARK: &str = "@answer ";

/// Largest force of the client's doors, newtons.
pub const PEAK_N: f64 = 3.0;
/// Largest change of the force, newtons per millisecond.
pub const SLEW: f64 = 0.3;

/// Command.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Command {
    /// Lists the devices.
    List,
    /// Opens devices.
    Open(Vec<String>),
    /// Starts the run, the doors and the loop of orders.
    Start,
    /// Presses the key of a hand.
    Press(usize),
    /// Sets the force of a hand, base axes, newtons, and its ripple: a sine of 3 Hz along the same line.
    Force(usize, [f64; 3], f64),
    /// Stops or continues the orders.
    Silence(bool),
    /// Asks for the states of the hands.
    State,
    /// Watches the allocations of threads whose name begins so. Returns their number.
    Watch(String),
    /// Number of allocations.
    Counted,
    /// Sentences so far.
    Said,
    /// Ends the run.
    Stop,
}

/// Answer.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Answer {
    /// Done.
    Done,
    /// A number.
    Number(u64),
    /// Sentences.
    Said(String),
    /// The list: for each device serial number, model, state, axes, sentence.
    List(Vec<Item>),
    /// Open devices: serial number, peak force, continuous force, stiffness, torque axes, period in ns.
    Open(Vec<Opened>),
    /// States of the hands.
    State(Vec<Hand>),
    /// An error, and its sentence.
    Error(String),
}

/// Entry of the list.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Item {
    pub serial: String,
    pub model: String,
    pub state: String,
    pub dof: [u8; 2],
    pub message: String,
}

/// Open device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Opened {
    pub serial: String,
    pub model: String,
    pub reported: [Option<f64>; 3],
    pub dof: [u8; 3],
    pub period_ns: u64,
}

/// State of a hand.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Hand {
    pub stage: String,
    pub present: bool,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    pub displayed: [f64; 3],
    pub sequence: u32,
    pub trips: u64,
    pub buttons: u16,
}
