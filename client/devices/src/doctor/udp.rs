//! Checks of UDP: the loopback interface, and the address of a server.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::sync::mpsc;
use std::time::Duration;

use super::check::{Check, part};

/// Bytes of a datagram, the least that every path of QUIC must carry.
const BYTES: usize = 1200;
/// Time limit of a datagram on the loopback interface.
const LOOPBACK: Duration = Duration::from_secs(1);
/// Time limit of the look-up of a name.
const LOOKUP: Duration = Duration::from_secs(3);

/// Check of the loopback interface, and of the server if one is named.
pub fn checks(server: Option<&str>) -> Vec<Check> {
    let mut checks = vec![loopback_check(around())];
    checks.extend(server.map(server_check));
    checks
}

fn loopback_check(result: io::Result<()>) -> Check {
    const NAME: &str = "udp loopback";
    match result {
        Ok(()) => Check::fine(
            NAME,
            format!("a datagram of {BYTES} bytes goes round on 127.0.0.1."),
        ),
        Err(error) => Check::wrong(
            NAME,
            format!(
                "a datagram of {BYTES} bytes does not go round on 127.0.0.1: {}. Let the firewall of this computer \
                 pass UDP on the loopback interface.",
                part(&error.to_string())
            ),
        ),
    }
}

/// Sends one datagram from a socket to another and compares the bytes.
fn around() -> io::Result<()> {
    let receiver = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
    receiver.set_read_timeout(Some(LOOPBACK))?;
    let sender = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
    sender.connect(receiver.local_addr()?)?;
    // Another program's datagram must not pass for this one.
    receiver.connect(sender.local_addr()?)?;
    let sent: Vec<u8> = (0..BYTES).map(|index| (index % 251) as u8).collect();
    sender.send(&sent)?;
    let mut received = [0; 2 * BYTES];
    let count = receiver.recv(&mut received)?;
    if received[..count] == sent {
        Ok(())
    } else {
        Err(io::Error::other("the bytes that came back differ"))
    }
}

/// Looks up the name and connects a socket, which sends nothing.
fn server_check(server: &str) -> Check {
    const NAME: &str = "udp server";
    let shown = part(server);
    let addresses = match look_up(server) {
        Ok(addresses) => addresses,
        Err(reason) => {
            return Check::wrong(
                NAME,
                format!(
                    "the address of `{shown}` is not found: {}. Write HOST:PORT, or ask the network's \
                     administrator for the number of the server.",
                    part(&reason)
                ),
            );
        }
    };
    let mut reason = String::from("the name has no address");
    for address in addresses {
        match connect(address) {
            Ok(()) => {
                return Check::fine(
                    NAME,
                    format!(
                        "`{shown}` is {address}, and a UDP socket has a route to it. No packet was sent: a firewall \
                         or a stopped server shows when a run connects."
                    ),
                );
            }
            Err(error) => reason = error.to_string(),
        }
    }
    Check::wrong(
        NAME,
        format!(
            "no route for UDP to `{shown}`: {}. Check the cable, the wireless network and the VPN of this computer.",
            part(&reason)
        ),
    )
}

fn connect(address: SocketAddr) -> io::Result<()> {
    let socket = if address.is_ipv4() {
        UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?
    } else {
        UdpSocket::bind((Ipv6Addr::UNSPECIFIED, 0))?
    };
    socket.connect(address)
}

/// Looks up a name on a thread of its own: the system's call has no time limit.
fn look_up(server: &str) -> Result<Vec<SocketAddr>, String> {
    if let Ok(address) = server.parse() {
        return Ok(vec![address]);
    }
    let (sender, receiver) = mpsc::channel();
    let name = server.to_owned();
    std::thread::spawn(move || {
        let result = name.to_socket_addrs().map(Iterator::collect);
        // Nobody waits any more after the time limit.
        let _ = sender.send(result.map_err(|error| error.to_string()));
    });
    receiver
        .recv_timeout(LOOKUP)
        .unwrap_or_else(|_| Err(format!("no answer within {} s", LOOKUP.as_secs())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loopback_interface_works_and_its_failure_is_told() {
        let checks = checks(None);
        assert_eq!(checks.len(), 1);
        assert!(checks[0].ok, "{checks:?}");
        let check = loopback_check(Err(io::Error::other("timed out")));
        assert!(!check.ok && check.message.contains("firewall"));
    }

    #[test]
    fn an_address_needs_no_look_up_and_no_server() {
        let check = &checks(Some("127.0.0.1:4433"))[1];
        assert!(check.ok && check.name == "udp server", "{check:?}");
        assert!(check.message.contains("No packet was sent"));
    }

    #[test]
    fn a_text_without_a_port_is_wrong() {
        for server in ["127.0.0.1", "", "a b:c", &"x".repeat(500)] {
            let check = &checks(Some(server))[1];
            assert!(
                !check.ok && check.message.contains("HOST:PORT"),
                "{check:?}"
            );
            assert!(check.message.chars().count() <= 300);
        }
    }
}
