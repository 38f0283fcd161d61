//! Stream of a client's exact inputs, if the ticks run at the hand.

use std::sync::Arc;

use quinn::{Connection, VarInt};
use sulcus_link::control::{ReadError, read};
use sulcus_proto::ClientMessage;
use tokio::task::JoinHandle;

use crate::session::ports::Ports;

/// Application code of a stream that the server does not read.
const NOT_READ: VarInt = VarInt::from_u32(2);

/// Task that reads the inputs of a connection; ended when dropped.
pub(super) struct Inputs(JoinHandle<()>);

impl Drop for Inputs {
    fn drop(&mut self) {
        self.0.abort();
    }
}

/// Reads the inputs of `connection` for the ticks of a session, if they run at the hand. A full queue of the session
/// holds back the stream.
pub(super) fn read_all(connection: &Connection, ports: &Arc<Ports>) -> Option<Inputs> {
    ports.hand()?;
    let (connection, ports) = (connection.clone(), ports.clone());
    Some(Inputs(tokio::spawn(async move {
        // An error of the connection is found by the reader of its datagrams.
        let Ok(mut stream) = connection.accept_uni().await else {
            return;
        };
        let Some(hand) = ports.hand() else { return };
        loop {
            let batch = match read::<ClientMessage>(&mut stream).await {
                Ok(ClientMessage::Inputs(batch)) => batch,
                Ok(ClientMessage::LastTick(last)) => {
                    hand.last(last);
                    continue;
                }
                Ok(_) => {
                    hand.invalid(
                        "a message on the stream of inputs is neither a batch nor the last tick",
                    );
                    break;
                }
                Err(ReadError::Codec(error)) => {
                    hand.invalid(&format!("the stream of inputs is invalid: {error}"));
                    break;
                }
                Err(ReadError::Closed(_)) => break,
            };
            if !hand.batch(batch, connection.rtt()).await {
                break;
            }
        }
        let _ = stream.stop(NOT_READ);
    })))
}
