//! Connection to the service: version, settings, WebSocket and inventory.

use std::time::{Duration, Instant};

use super::VARIABLE;
use super::address::Address;
use super::http::{Answer, NoAnswer, get};
use super::inventory::Inventory;
use super::line::Line;
use super::settings;
use super::version::{Field, Version};
use crate::State;

/// Time limit of one question.
const QUESTION: Duration = Duration::from_millis(400);
/// Number of attempts for an answer with an error of the service, and for an inventory that is no JSON.
const ATTEMPTS: usize = 3;
/// Time between two attempts.
const BETWEEN: Duration = Duration::from_millis(30);
/// Setting of the factor on all forces.
const FORCE_SCALE: &str = "/settings/devices/force_scale";

/// Connection.
#[derive(Debug)]
pub(super) struct Connected {
    /// WebSocket, after the inventory.
    pub(super) line: Line,
    /// Field of a force.
    pub(super) field: Field,
    /// Devices.
    pub(super) inventory: Inventory,
    /// Reason against all arms, from a setting of the service.
    pub(super) against: Option<String>,
    /// Remarks, one sentence each.
    pub(super) remarks: Vec<String>,
}

/// No connection: state and sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NoConnection {
    /// State in the list.
    pub(super) state: State,
    /// Cause and remedy.
    pub(super) sentence: String,
}

impl NoConnection {
    fn new(state: State, sentence: String) -> Self {
        Self { state, sentence }
    }
}

impl Connected {
    /// Reason against the arms of `ids`; `None` for arms that may be used.
    pub(super) fn against<'a>(&self, mut ids: impl Iterator<Item = &'a str>) -> Option<String> {
        let of_arm = |id| self.inventory.arm(id)?.against.clone();
        self.against.clone().or_else(|| ids.find_map(of_arm))
    }
}

/// Connects within about `most`. No device moves or gets a force.
pub(super) fn connect(address: &Address, most: Duration) -> Result<Connected, NoConnection> {
    let end = Instant::now() + most;
    let mut remarks = Vec::new();
    let field = field(address, end, &mut remarks)?;
    let against = force_scale(address, end, &mut remarks)?;
    let mut cause = String::from("no time left");
    for _ in 0..ATTEMPTS {
        let Some(left) = left(end) else { break };
        let read = Line::open(address, left).and_then(|mut line| {
            let text = line.within(left)?;
            let inventory = Inventory::parse(&text).ok_or("the first message is no inventory")?;
            Ok((line, inventory))
        });
        match read {
            Ok((line, inventory)) => {
                return Ok(Connected {
                    line,
                    field,
                    inventory,
                    against,
                    remarks,
                });
            }
            Err(error) => cause = error,
        }
    }
    Err(NoConnection::new(
        State::Error,
        format!(
            "the Haply service at {address} gives no list of its devices ({cause}): restart the service"
        ),
    ))
}

/// Field of a force, from the version.
fn field(
    address: &Address,
    end: Instant,
    remarks: &mut Vec<String>,
) -> Result<Field, NoConnection> {
    let wrong = |sentence| NoConnection::new(State::WrongVersion, sentence);
    let answer = ask(address, "/version", end)?;
    if answer.status != 200 {
        return Err(wrong(format!(
            "the Haply service at {address} does not tell its version (HTTP status {}), expected 3.1 or later: update \
             the Haply software",
            answer.status
        )));
    }
    let version = Version::parse(&answer.body).ok_or_else(|| {
        let begin: String = answer.body.chars().filter(|c| !c.is_control()).take(60).collect();
        wrong(format!(
            "the Haply service at {address} tells the version {begin:?}, expected 3.1 or later: update the \
             Haply software"
        ))
    })?;
    remarks.extend(version.remark());
    version.field().map_err(wrong)
}

/// Reason against all arms, from the factor on all forces.
fn force_scale(
    address: &Address,
    end: Instant,
    remarks: &mut Vec<String>,
) -> Result<Option<String>, NoConnection> {
    let answer = ask(address, FORCE_SCALE, end)?;
    let factor = settings::force_scale(&answer.body).filter(|_| answer.status == 200);
    if factor.is_none() {
        remarks.push(format!(
            "the Haply service at {address} does not tell its force_scale: the displayed force is compared alone"
        ));
    }
    Ok(factor.and_then(settings::against_scale))
}

/// Asks a question, and again after an error of the service.
fn ask(address: &Address, path: &str, end: Instant) -> Result<Answer, NoConnection> {
    let mut last = None;
    for attempt in 0..ATTEMPTS {
        if attempt > 0 {
            std::thread::sleep(BETWEEN);
        }
        let Some(left) = left(end) else { break };
        match get(address, path, left) {
            Ok(answer) if answer.status < 500 => return Ok(answer),
            other => last = Some(other),
        }
        if matches!(last, Some(Err(NoAnswer::Refused(_) | NoAnswer::Late))) {
            break;
        }
    }
    let sentence = match last {
        Some(Err(NoAnswer::Refused(cause))) => {
            let sentence = format!(
                "no Haply service answers at {address} ({cause}): install and start the Haply software, or correct \
                 {VARIABLE}"
            );
            return Err(NoConnection::new(State::NoLibrary, sentence));
        }
        Some(Err(NoAnswer::Garbled)) => format!(
            "the program at {address} answers {path} with no HTTP, expected the Haply service: correct {VARIABLE}"
        ),
        Some(Ok(answer)) => format!(
            "the Haply service at {address} answers {path} with HTTP status {}, expected 200: restart the service",
            answer.status
        ),
        Some(Err(NoAnswer::Late)) | None => format!(
            "the Haply service at {address} does not answer {path} in time: restart the service"
        ),
    };
    Err(NoConnection::new(State::Error, sentence))
}

/// Time limit of the next question; `None` after the end.
fn left(end: Instant) -> Option<Duration> {
    let left = end.saturating_duration_since(Instant::now());
    (!left.is_zero()).then(|| left.min(QUESTION))
}
