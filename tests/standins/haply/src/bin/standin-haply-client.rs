//! A small client of a service, in a process of its own, that a test may kill.
//!
//! Usage: `standin-haply-client PORT ARM NEWTON`. The client sends the force along x as fast as the replies come, until
//! the connection ends.

use std::error::Error;
use std::net::TcpStream;
use std::process::ExitCode;

use serde_json::json;
use tungstenite::Message;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [port, arm, newtons] = arguments.as_slice() else {
        eprintln!("usage: standin-haply-client PORT ARM NEWTON");
        return ExitCode::from(2);
    };
    match run(port, arm, newtons) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("standin-haply-client: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(port: &str, arm: &str, newtons: &str) -> Result<(), Box<dyn Error>> {
    let (port, newtons): (u16, f64) = (port.parse()?, newtons.parse()?);
    let stream = TcpStream::connect(("127.0.0.1", port))?;
    stream.set_nodelay(true)?;
    let (mut socket, _) = tungstenite::client(format!("ws://127.0.0.1:{port}/"), stream)?;
    // The inventory comes first.
    socket.read()?;
    let force = json!({"inverse3": [{
        "device_id": arm,
        "commands": {"set_cursor_force": {"vector": {"x": newtons, "y": 0.0, "z": 0.0}}},
    }]});
    let mut first = force.clone();
    first["session"] = json!({"configure": {"profile": {"name": "org.sulcus:test"}}});
    socket.send(Message::text(first.to_string()))?;
    loop {
        socket.read()?;
        socket.send(Message::text(force.to_string()))?;
    }
}
