//! Raw client.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use sulcus_standin_haply::Service;
use tungstenite::{Error, Message, WebSocket};

/// Right arm of the usual options.
pub const ARM: &str = "049D";
/// Grip of the usual options.
pub const GRIP: &str = "61576";

/// Simulation connection or connection of events.
pub struct Client {
    /// WebSocket.
    pub socket: WebSocket<TcpStream>,
    profile: bool,
}

impl Client {
    /// Connects and reads nothing.
    pub fn raw(port: u16) -> Result<Self, String> {
        let stream = TcpStream::connect(("127.0.0.1", port)).map_err(|error| error.to_string())?;
        stream.set_nodelay(true).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(10)))
            .unwrap();
        let url = format!("ws://127.0.0.1:{port}/");
        let (socket, _) = tungstenite::client(url, stream).map_err(|error| error.to_string())?;
        Ok(Self {
            socket,
            profile: false,
        })
    }

    /// Connects and takes the inventory.
    pub fn connect(service: &Service) -> (Self, Value) {
        let mut client = Self::raw(service.port()).unwrap();
        let inventory = client.read();
        (client, inventory)
    }

    /// Next text, as it is.
    pub fn text(&mut self) -> Result<String, Error> {
        loop {
            if let Message::Text(text) = self.socket.read()? {
                return Ok(text.to_string());
            }
        }
    }

    /// Next text as JSON.
    pub fn read(&mut self) -> Value {
        serde_json::from_str(&self.text().unwrap()).unwrap()
    }

    /// Sends a message without its reply; the first has a profile.
    pub fn send(&mut self, mut message: Value) {
        if !std::mem::replace(&mut self.profile, true) {
            message["session"] = json!({"configure": {"profile": {"name": "org.sulcus:test"}}});
        }
        self.socket
            .send(Message::text(message.to_string()))
            .unwrap();
    }

    /// Sends a message and takes its reply.
    pub fn ask(&mut self, message: Value) -> Value {
        self.send(message);
        self.read()
    }

    /// Sends a force in x in the field `vector` and takes the reply.
    pub fn push(&mut self, newtons: f64) -> Value {
        self.ask(force(ARM, "vector", newtons))
    }

    /// True where no message comes for a time.
    pub fn is_silent(&mut self, time: Duration) -> bool {
        self.socket.get_ref().set_read_timeout(Some(time)).unwrap();
        let silent = matches!(self.socket.read(), Err(Error::Io(error)) if error.kind() == std::io::ErrorKind::WouldBlock);
        self.socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_secs(10)))
            .unwrap();
        silent
    }
}

/// Message with one force along x.
pub fn force(device: &str, field: &str, newtons: f64) -> Value {
    let vector = json!({"x": newtons, "y": 0, "z": 0});
    json!({"inverse3": [{"device_id": device, "commands": {"set_cursor_force": {field: vector}}}]})
}

/// Message without a command.
pub fn probe() -> Value {
    json!({"inverse3": [{"device_id": ARM, "commands": {"probe_position": {}}}]})
}

/// Force along x that the first arm of a reply displays.
pub fn shown(reply: &Value) -> f64 {
    reply["inverse3"][0]["state"]["current_cursor_force"]["x"]
        .as_f64()
        .unwrap()
}

/// Vector in the state of the first arm of a reply.
pub fn vector(reply: &Value, name: &str) -> [f64; 3] {
    let vector = &reply["inverse3"][0]["state"][name];
    ["x", "y", "z"].map(|letter| vector[letter].as_f64().unwrap())
}

/// Waits up to 5 s for a condition.
pub fn wait_for(mut condition: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(5) {
        if condition() {
            return true;
        }
        thread::sleep(Duration::from_millis(2));
    }
    false
}

/// Request over HTTP: status and body.
pub fn http(port: u16, method: &str, path: &str, body: &str) -> (u16, Value) {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    let head = format!(
        "{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    );
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let status = answer.split_whitespace().nth(1).unwrap().parse().unwrap();
    let body = answer.split_once("\r\n\r\n").unwrap().1;
    (status, serde_json::from_str(body).unwrap())
}
