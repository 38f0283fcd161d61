//! Writing side of the control stream.

use quinn::SendStream;
use sulcus_proto::{ClientMessage, frame};

use super::LinkError;

/// Writes one message, without a timeout of its own. The error is an encoding error or a lost connection.
pub(crate) async fn write(
    stream: &mut SendStream,
    message: &ClientMessage,
) -> Result<(), LinkError> {
    let bytes = frame::encode(message)?;
    stream
        .write_all(&bytes)
        .await
        .map_err(|error| LinkError::Lost(error.to_string()))
}
