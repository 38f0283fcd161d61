//! Names with several addresses, and servers that listen on any address.

use std::io::{BufRead as _, BufReader, ErrorKind};
use std::net::{SocketAddr, ToSocketAddrs as _, UdpSocket};
use std::process::{Child, Stdio};

use serde_json::Value;
use sulcus_tests::{Ended, Place, Program};

/// A server that is killed in the end, and its first line.
struct Server(Child, String);

impl Server {
    fn on(place: &Place, listen: &str, more: &[&str]) -> Self {
        let mut child = place
            .command(Program::Server.path())
            .args(["serve", "--listen", listen, "--token", "t"])
            .args(["--certificate-out", "server.der"])
            .args(more)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut line = String::new();
        let stdout = child.stdout.take().expect("piped");
        BufReader::new(stdout)
            .read_line(&mut line)
            .expect("a first line");
        Self(child, line)
    }

    fn said(&self) -> Value {
        serde_json::from_str(&self.1).unwrap_or_else(|error| panic!("{error}: {}", self.1))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn join(place: &Place, server: &str) -> Ended {
    let run = ["run", "--server", server, "--token", "t"];
    let more = ["--certificate", "server.der", "--duration", "0.5"];
    let last = ["--tick", "server", "--json"];
    place.run(Program::Client, &[&run[..], &more, &last].concat())
}

/// Whether this machine has IPv6, or a skip with a message.
fn has_ipv6() -> bool {
    let bound = UdpSocket::bind("[::1]:0");
    if let Err(error) = &bound {
        println!("skipped: this machine has no IPv6: {error}");
    }
    bound.is_ok()
}

/// Sockets that hold a port of `localhost` and answer nothing, and the port: another server could take a free one.
fn silent() -> (Vec<UdpSocket>, u16) {
    for _ in 0..20 {
        let first = UdpSocket::bind("127.0.0.1:0").expect("a port");
        let port = first.local_addr().expect("an address").port();
        match UdpSocket::bind(("::1", port)) {
            Ok(second) => return (vec![first, second], port),
            Err(error) if error.kind() == ErrorKind::AddrInUse => {}
            // Without IPv6 no other server is there.
            Err(_) => return (vec![first], port),
        }
    }
    panic!("no port is free at both addresses");
}

fn text<'a>(said: &'a Value, field: &str) -> &'a str {
    said[field].as_str().unwrap_or_else(|| panic!("{said}"))
}

/// The server printed `0.0.0.0`, to which no client can connect.
#[test]
fn a_server_on_any_address_names_one_that_a_client_can_use() {
    for listen in ["0.0.0.0:0", "[::]:0"] {
        if listen.starts_with('[') && !has_ipv6() {
            continue;
        }
        let place = Place::new();
        let server = Server::on(&place, listen, &["--json"]);
        let said = server.said();
        let address: SocketAddr = text(&said, "address").parse().expect("an address");
        assert!(
            !address.ip().is_unspecified() && address.port() != 0,
            "{said}"
        );
        assert_eq!(said["addresses"][0], said["address"]);
        let bound: SocketAddr = text(&said, "listen").parse().expect("an address");
        assert!(bound.ip().is_unspecified());
        assert_eq!(bound.port(), address.port());
        join(&place, &address.to_string()).ok();
    }
    let place = Place::new();
    let server = Server::on(&place, "0.0.0.0:0", &[]);
    assert!(
        server
            .1
            .contains("listening on every address of this machine"),
        "{}",
        server.1
    );
    assert!(!server.1.contains("0.0.0.0"), "{}", server.1);
}

/// The client tried the first address of a name and no other: `localhost` is `::1` first on many machines.
#[test]
fn a_client_tries_all_addresses_of_a_name() {
    for listen in ["localhost:0", "127.0.0.1:0", "[::1]:0"] {
        // Where `localhost` has one address, the link's own tests stand for this.
        let names = "localhost:0".to_socket_addrs().expect("localhost");
        if listen.starts_with('[') && !names.into_iter().any(|address| address.is_ipv6()) {
            println!("skipped: `localhost` has no address of IPv6 here");
            continue;
        }
        if listen.starts_with('[') && !has_ipv6() {
            continue;
        }
        let place = Place::new();
        let server = Server::on(&place, listen, &["--json"]);
        let said = server.said();
        let address: SocketAddr = text(&said, "address").parse().expect("an address");
        join(&place, &format!("localhost:{}", address.port())).ok();
    }
}

#[test]
fn a_name_that_nobody_answers_at_is_told_with_all_its_addresses() {
    let place = Place::new();
    let _server = Server::on(&place, "127.0.0.1:0", &["--json"]);
    let (_held, port) = silent();
    let ended = join(&place, &format!("localhost:{port}"));
    let named = format!("127.0.0.1:{port}");
    // Of one address, or of two.
    ended.refused(&[&named, "answer", &format!("localhost:{port}")]);
}

#[test]
fn an_address_that_is_none_is_refused_by_its_text() {
    let place = Place::new();
    for listen in ["localhost", "nowhere.invalid:4433", "127.0.0.1:99999"] {
        place
            .run(Program::Server, &["serve", "--listen", listen])
            .refused(&["--listen", listen]);
    }
    for (option, value) in [("--force-limit", "-1"), ("--force-limit", "nan")] {
        let ended = place.run(Program::Server, &["serve", &format!("{option}={value}")]);
        assert_eq!(ended.code, 2, "{ended:#?}");
        assert!(ended.stderr.contains(value), "{ended:#?}");
    }
}
