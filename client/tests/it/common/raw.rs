//! A connection that says whatever a test wants it to.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use quinn::{Connection, Endpoint, RecvStream, SendStream};
use sulcus_connection::link::{Pin, client_config};
use sulcus_proto::control::ClientHello;
use sulcus_proto::frame::{self, LENGTH_BYTES};
use sulcus_proto::{ClientMessage, Role, ServerMessage};

use super::{PATIENCE, Station};

/// A connection with an open control stream.
pub struct Raw {
    _endpoint: Endpoint,
    pub connection: Connection,
    pub send: SendStream,
    pub recv: RecvStream,
}

/// Hello of a client with a token and a role.
pub fn hello(role: Role, token: &str) -> ClientMessage {
    ClientMessage::Hello(ClientHello {
        program: "0".into(),
        token: token.into(),
        role,
        station: String::new(),
        devices: Vec::new(),
        learner: String::new(),
        exercise: String::new(),
        epoch: 0,
        capabilities: 0,
        self_test: 0,
        tick_at_hand: false,
        scene_hash: [0; 32],
    })
}

impl Raw {
    /// Connected, without a hello.
    pub async fn silent(station: &Station) -> Self {
        Self::with(station, |_| ()).await
    }

    /// Connected with a large buffer for outgoing datagrams, without a hello.
    pub async fn wide(station: &Station) -> Self {
        Self::with(station, |config| {
            // The defaults of QUIC: a buffer of 1 MiB.
            config.transport_config(Arc::new(quinn::TransportConfig::default()));
        })
        .await
    }

    async fn with(station: &Station, change: impl FnOnce(&mut quinn::ClientConfig)) -> Self {
        let mut endpoint = Endpoint::client("127.0.0.1:0".parse().unwrap()).unwrap();
        let pin = Pin::Certificate(station.server().certificate_der().to_vec());
        let mut client = client_config(pin, Arc::new(AtomicBool::new(false))).unwrap();
        change(&mut client);
        endpoint.set_default_client_config(client);
        let address = station.server().local_addr();
        let connecting = endpoint.connect(address, "localhost").unwrap();
        let connection = connecting.await.unwrap();
        let (send, recv) = connection.open_bi().await.unwrap();
        Self {
            _endpoint: endpoint,
            connection,
            send,
            recv,
        }
    }

    /// Connected, with its hello sent.
    pub async fn connect(station: &Station, role: Role, token: &str) -> Self {
        let mut raw = Self::silent(station).await;
        raw.say(&hello(role, token)).await;
        raw
    }

    pub async fn say(&mut self, message: &ClientMessage) {
        // An error means that the server has dropped the connection.
        let _ = self.send.write_all(&frame::encode(message).unwrap()).await;
    }

    /// Next message; `None` at the end of the stream.
    pub async fn hear(&mut self) -> Option<ServerMessage> {
        read(&mut self.recv).await
    }

    /// Next message within `limit`.
    pub async fn hear_for(&mut self, limit: Duration) -> Option<ServerMessage> {
        tokio::time::timeout(limit, self.hear()).await.ok()?
    }

    /// Text of the refusal that ends the connection, within [`PATIENCE`].
    pub async fn refusal(recv: &mut RecvStream) -> Option<String> {
        let heard = async {
            while let Some(message) = read(recv).await {
                if let ServerMessage::Refused(refused) = message {
                    return Some(refused.text);
                }
            }
            None
        };
        tokio::time::timeout(PATIENCE, heard).await.ok()?
    }
}

async fn read(recv: &mut RecvStream) -> Option<ServerMessage> {
    let mut length = [0; LENGTH_BYTES];
    recv.read_exact(&mut length).await.ok()?;
    let mut body = vec![0; frame::body_length(length).unwrap()];
    recv.read_exact(&mut body).await.ok()?;
    Some(frame::decode(&body).unwrap())
}
