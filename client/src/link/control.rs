//! The control stream: whole messages in, whole messages out.

use quinn::{RecvStream, SendStream};
use sulcus_proto::frame::{self, LENGTH_BYTES};
use sulcus_proto::{ClientMessage, ServerMessage};
use tokio::sync::mpsc;

use super::LinkError;

/// Reads one message. Not cancel-safe: a message begun must be read to its end.
pub(super) async fn read(stream: &mut RecvStream) -> Result<ServerMessage, LinkError> {
    let lost = |error: quinn::ReadExactError| LinkError::Lost(error.to_string());
    let mut length = [0; LENGTH_BYTES];
    stream.read_exact(&mut length).await.map_err(lost)?;
    let mut body = vec![0; frame::body_length(length)?];
    stream.read_exact(&mut body).await.map_err(lost)?;
    Ok(frame::decode(&body)?)
}

/// Writes one message.
pub(super) async fn write(
    stream: &mut SendStream,
    message: &ClientMessage,
) -> Result<(), LinkError> {
    let bytes = frame::encode(message)?;
    stream
        .write_all(&bytes)
        .await
        .map_err(|error| LinkError::Lost(error.to_string()))
}

/// Reads in a task of its own, so that waiting for a message can be given up without losing half
/// of one. The last item is the error that ended it.
pub(super) fn reader(mut stream: RecvStream) -> mpsc::Receiver<Result<ServerMessage, LinkError>> {
    let (sender, receiver) = mpsc::channel(16);
    tokio::spawn(async move {
        loop {
            let message = read(&mut stream).await;
            let last = message.is_err();
            if sender.send(message).await.is_err() || last {
                break;
            }
        }
    });
    receiver
}
