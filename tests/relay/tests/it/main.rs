//! The relay over real sockets on loopback.
#![allow(clippy::unwrap_used)]

use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sulcus_relay::{Conditions, Relay, Script};

/// A server that sends every packet back, behind the port of its client.
struct Echo {
    address: std::net::SocketAddr,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

fn socket() -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let timeout = Some(Duration::from_millis(50));
    socket.set_read_timeout(timeout).unwrap();
    socket
}

impl Echo {
    fn new() -> Self {
        let socket = socket();
        let address = socket.local_addr().unwrap();
        let is_over = Arc::new(AtomicBool::new(false));
        let is_thread_over = is_over.clone();
        let thread = std::thread::spawn(move || {
            let mut bytes = [0; 64];
            while !is_thread_over.load(Ordering::Relaxed) {
                if let Ok((length, from)) = socket.recv_from(&mut bytes) {
                    let mut answer = from.port().to_be_bytes().to_vec();
                    answer.extend(&bytes[..length]);
                    socket.send_to(&answer, from).unwrap();
                }
            }
        });
        Self {
            address,
            is_over,
            thread: Some(thread),
        }
    }
}

impl Drop for Echo {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

/// Sends `text` and returns the answer with the port that the server saw. `None`: no answer within five seconds.
fn ask(client: &UdpSocket, relay: &Relay, text: &str, patience: Duration) -> Option<(u16, String)> {
    client.send_to(text.as_bytes(), relay.address()).unwrap();
    let begin = Instant::now();
    let mut bytes = [0; 64];
    while begin.elapsed() < patience {
        if let Ok((length, _)) = client.recv_from(&mut bytes) {
            let port = u16::from_be_bytes([bytes[0], bytes[1]]);
            return Some((port, String::from_utf8(bytes[2..length].to_vec()).unwrap()));
        }
    }
    None
}

const PATIENCE: Duration = Duration::from_secs(5);

#[test]
fn each_client_gets_its_own_answers_through_a_port_of_its_own() {
    let echo = Echo::new();
    let relay = Relay::to(echo.address).unwrap();
    let clients = [socket(), socket(), socket()];
    let mut ports = Vec::new();
    for (k, client) in clients.iter().enumerate() {
        let text = format!("client {k}");
        let (port, answer) = ask(client, &relay, &text, PATIENCE).unwrap();
        assert_eq!(answer, text);
        assert_eq!(ask(client, &relay, &text, PATIENCE).unwrap().0, port);
        ports.push(port);
    }
    ports.sort_unstable();
    ports.dedup();
    assert_eq!(ports.len(), 3);
    let counts = relay.counts();
    assert_eq!((counts.up.arrived, counts.down.arrived), (6, 6));
}

#[test]
fn a_cut_relay_carries_nothing_and_a_new_port_everything() {
    let echo = Echo::new();
    let relay = Relay::to(echo.address).unwrap();
    let client = socket();
    let (before, _) = ask(&client, &relay, "a", PATIENCE).unwrap();
    relay.cut(true);
    assert_eq!(ask(&client, &relay, "b", Duration::from_millis(200)), None);
    assert_eq!(relay.counts().up.cut, 1);
    relay.cut(false);
    relay.rebind().unwrap();
    let (after, answer) = ask(&client, &relay, "c", PATIENCE).unwrap();
    assert_ne!(before, after);
    assert_eq!(answer, "c");
}

#[test]
fn no_packet_comes_before_its_delay() {
    let echo = Echo::new();
    let slow = Conditions {
        delay: Duration::from_millis(30),
        jitter: Duration::from_millis(10),
        ..Conditions::default()
    };
    let relay = Relay::start(
        "127.0.0.1:0".parse().unwrap(),
        echo.address,
        [slow, slow],
        5,
    )
    .unwrap();
    let client = socket();
    for _ in 0..10 {
        let begin = Instant::now();
        ask(&client, &relay, "a", PATIENCE).unwrap();
        assert!(begin.elapsed() >= Duration::from_millis(40));
    }
}

/// Asks until `holds`, at most a minute.
fn ask_until(client: &UdpSocket, relay: &Relay, mut holds: impl FnMut(Option<u16>) -> bool) {
    let begin = Instant::now();
    loop {
        let answer = ask(client, relay, "b", Duration::from_millis(20));
        if holds(answer.map(|(port, _)| port)) {
            return;
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "in vain");
    }
}

#[test]
fn a_script_cuts_the_path_joins_it_again_and_moves_it_to_another_port() {
    let echo = Echo::new();
    let mut relay = Relay::to(echo.address).unwrap();
    let client = socket();
    let (before, _) = ask(&client, &relay, "a", PATIENCE).unwrap();
    relay.run(Script::read(["0=outage:3"]).unwrap()).unwrap();
    ask_until(&client, &relay, |_| relay.counts().up.cut > 0);
    ask_until(&client, &relay, |port| port == Some(before));
    relay.run(Script::read(["0=rebind"]).unwrap()).unwrap();
    ask_until(&client, &relay, |port| {
        port.is_some_and(|port| port != before)
    });
}

#[test]
fn clients_beyond_the_largest_number_are_served() {
    let echo = Echo::new();
    let relay = Relay::to(echo.address).unwrap();
    for k in 0..300 {
        let client = socket();
        let text = format!("{k}");
        assert_eq!(ask(&client, &relay, &text, PATIENCE).unwrap().1, text);
    }
}

#[test]
fn conditions_that_are_invalid_are_refused() {
    let echo = Echo::new();
    let plain = Conditions::default();
    let endless = Conditions {
        stall: Some((Duration::ZERO, Duration::ZERO)),
        ..plain
    };
    let relay = Relay::to(echo.address).unwrap();
    assert_eq!(relay.change([plain, endless]).unwrap_err().field, "stall");
    let address = "127.0.0.1:0".parse().unwrap();
    assert!(Relay::start(address, echo.address, [endless, plain], 1).is_err());
    assert!(ask(&socket(), &relay, "a", PATIENCE).is_some());
}
