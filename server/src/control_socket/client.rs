//! Client's side of the control socket, for the commands.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};

use super::place::connect;
use super::{MOST_REPLY, PATIENCE, Reply, Request};
use crate::state::{StateError, StateFolder};

/// Reason why a running server gave no result.
#[derive(Debug, thiserror::Error)]
pub enum AskError {
    /// The socket cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
    /// The connection failed.
    #[error("the running server does not answer on its control socket: {0}")]
    Io(#[from] std::io::Error),
    /// The answer is no reply.
    #[error("the answer of the running server is no reply ({0}); install the same release on both")]
    Reply(String),
    /// The server refused the request.
    #[error("{0}")]
    Refused(String),
}

/// Asks the server of a state folder. `None`: no server runs.
///
/// # Errors
/// The server cannot be reached, does not answer within [`PATIENCE`], or refuses the request.
pub fn ask(folder: &StateFolder, request: &Request) -> Result<Option<serde_json::Value>, AskError> {
    let Some(mut stream) = connect(folder)? else {
        return Ok(None);
    };
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut line =
        serde_json::to_vec(request).map_err(|error| AskError::Reply(error.to_string()))?;
    line.push(b'\n');
    // A server that refuses the connection answers and closes before the request has arrived.
    let written = stream.write_all(&line);
    let mut answer = Vec::new();
    let mut reading = BufReader::new(stream).take(MOST_REPLY as u64);
    let read = reading.read_until(b'\n', &mut answer);
    if answer.is_empty() {
        written?;
    }
    read?;
    match serde_json::from_slice(&answer) {
        Ok(Reply::Ok(value)) => Ok(Some(value)),
        Ok(Reply::Error(why)) => Err(AskError::Refused(why)),
        Err(error) => Err(AskError::Reply(error.to_string())),
    }
}
