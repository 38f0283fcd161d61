//! The control stream: whole messages in, whole messages out.

use quinn::{RecvStream, SendStream};
use sulcus_proto::frame::{self, LENGTH_BYTES};
use sulcus_proto::{ClientMessage, CodecError, ServerMessage};
use tokio::sync::mpsc;

/// Why no further message comes.
#[derive(Debug, thiserror::Error)]
pub(super) enum ReadError {
    /// The stream or the connection ended.
    #[error("the control stream ended")]
    Closed,
    /// The client does not speak this protocol.
    #[error(transparent)]
    Codec(#[from] CodecError),
}

/// Reads one message. Not cancel-safe: a message begun must be read to its end.
pub(super) async fn read(stream: &mut RecvStream) -> Result<ClientMessage, ReadError> {
    let mut length = [0; LENGTH_BYTES];
    stream
        .read_exact(&mut length)
        .await
        .map_err(|_| ReadError::Closed)?;
    let mut body = vec![0; frame::body_length(length)?];
    stream
        .read_exact(&mut body)
        .await
        .map_err(|_| ReadError::Closed)?;
    Ok(frame::decode(&body)?)
}

/// Writes one message; `false` when the connection is gone.
pub(super) async fn write(stream: &mut SendStream, message: &ServerMessage) -> bool {
    match frame::encode(message) {
        Ok(bytes) => stream.write_all(&bytes).await.is_ok(),
        Err(error) => {
            tracing::error!("cannot encode a control message: {error}");
            false
        }
    }
}

/// Reads in a task of its own, so that waiting for a message can be given up without losing half
/// of one. The last item is the error that ended it.
pub(super) fn reader(mut stream: RecvStream) -> mpsc::Receiver<Result<ClientMessage, ReadError>> {
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
