//! Reading side of the control stream: whole messages.

use quinn::RecvStream;
use sulcus_proto::CodecError;
use sulcus_proto::frame::{self, LENGTH_BYTES, Message};
use tokio::sync::mpsc;

/// Messages that may wait between the reading task and its receiver.
const QUEUE: usize = 16;

/// Reason for the end of the messages.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The stream or the connection ended; the text is QUIC's.
    #[error("the control stream ended: {0}")]
    Closed(String),
    /// The bytes are no message of this protocol version.
    #[error(transparent)]
    Codec(#[from] CodecError),
}

/// Reads one message. The future is not cancel-safe: a dropped read loses the part that it has read.
///
/// # Errors
/// The stream ended, or the bytes are no message.
pub async fn read<M: Message>(stream: &mut RecvStream) -> Result<M, ReadError> {
    let closed = |error: quinn::ReadExactError| ReadError::Closed(error.to_string());
    let mut length = [0; LENGTH_BYTES];
    stream.read_exact(&mut length).await.map_err(closed)?;
    let mut body = vec![0; frame::body_length(length)?];
    stream.read_exact(&mut body).await.map_err(closed)?;
    Ok(frame::decode(&body)?)
}

/// Reads messages in a task of its own, so that a receiver may stop waiting without losing part of a message. The last
/// item is the error that ended the stream.
pub fn reader<M: Message + Send + 'static>(
    mut stream: RecvStream,
) -> mpsc::Receiver<Result<M, ReadError>> {
    let (sender, receiver) = mpsc::channel(QUEUE);
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
