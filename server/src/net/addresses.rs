//! Addresses to listen on, and addresses to print for clients.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};

use anyhow::Context;
use nix::ifaddrs::getifaddrs;
use nix::net::if_::InterfaceFlags;

/// Addresses of `ADDRESS:PORT` or `NAME:PORT`, IPv4 first.
///
/// # Errors
/// The text has another form, or the name is unknown or has no address. The error is one sentence.
pub(crate) fn resolve(text: &str) -> anyhow::Result<Vec<SocketAddr>> {
    let found = text
        .to_socket_addrs()
        .with_context(|| format!("--listen is `{text}`, expected ADDRESS:PORT or NAME:PORT"))?;
    let mut found: Vec<SocketAddr> = found.collect();
    found.sort_by_key(SocketAddr::is_ipv6);
    found.dedup();
    anyhow::ensure!(
        !found.is_empty(),
        "--listen is `{text}`, a name without an address, expected ADDRESS:PORT or NAME:PORT"
    );
    Ok(found)
}

/// Addresses by which clients reach a server that listens on `local`, the preferred one first.
///
/// A server on the unspecified address is reached by each address of this machine; without a network, by loopback.
pub(crate) fn for_clients(local: SocketAddr) -> Vec<SocketAddr> {
    if !local.ip().is_unspecified() {
        return vec![local];
    }
    let mut ips = of_this_machine();
    if local.is_ipv4() {
        ips.retain(IpAddr::is_ipv4);
    }
    // Source address of packets to other machines.
    let preferred = if local.is_ipv4() {
        toward_v4()
    } else {
        toward_v6()
    };
    if let Some(best) = preferred.or_else(toward_v4) {
        ips.retain(|ip| *ip != best);
        ips.insert(0, best);
    }
    if ips.is_empty() {
        ips.push(if local.is_ipv4() {
            Ipv4Addr::LOCALHOST.into()
        } else {
            Ipv6Addr::LOCALHOST.into()
        });
    }
    let address = |ip| SocketAddr::new(ip, local.port());
    ips.into_iter().map(address).collect()
}

/// Addresses of the interfaces that are up, IPv4 first, without loopback and without link-local addresses of IPv6.
/// A link-local address needs an interface to name a machine.
fn of_this_machine() -> Vec<IpAddr> {
    let mut ips: Vec<IpAddr> = Vec::new();
    for interface in getifaddrs().into_iter().flatten() {
        let up = interface.flags.contains(InterfaceFlags::IFF_UP);
        let Some(address) = interface.address.filter(|_| up) else {
            continue;
        };
        let v4 = address.as_sockaddr_in().map(|v4| IpAddr::from(v4.ip()));
        let ip = v4.or_else(|| address.as_sockaddr_in6().map(|v6| IpAddr::from(v6.ip())));
        ips.extend(ip.filter(|ip| is_reachable(*ip) && !ips.contains(ip)));
    }
    ips.sort_by_key(IpAddr::is_ipv6);
    ips
}

fn is_reachable(ip: IpAddr) -> bool {
    let link_local = matches!(ip, IpAddr::V6(v6) if v6.is_unicast_link_local());
    !ip.is_loopback() && !ip.is_unspecified() && !link_local
}

/// Source address of this machine towards other machines by IPv4; `None` without a route.
fn toward_v4() -> Option<IpAddr> {
    toward(
        (Ipv4Addr::UNSPECIFIED, 0).into(),
        (Ipv4Addr::new(192, 0, 2, 1), 9).into(),
    )
}

/// Source address of this machine towards other machines by IPv6; `None` without a route.
fn toward_v6() -> Option<IpAddr> {
    let documentation = Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1);
    toward((Ipv6Addr::UNSPECIFIED, 0).into(), (documentation, 9).into())
}

/// Source address that the system chooses for packets to `to`. The connect of a UDP socket sends no packet.
fn toward(from: SocketAddr, to: SocketAddr) -> Option<IpAddr> {
    let socket = UdpSocket::bind(from).ok()?;
    socket.connect(to).ok()?;
    let ip = socket.local_addr().ok()?.ip();
    is_reachable(ip).then_some(ip)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_resolved_with_ipv4_first() {
        let found = resolve("localhost:4433").expect("a name that every machine has");
        assert_eq!(found[0], "127.0.0.1:4433".parse().expect("an address"));
        for text in ["127.0.0.1", "localhost", "localhost:99999", "[::1:4433", ""] {
            let told = format!("{:#}", resolve(text).expect_err(text));
            assert!(told.contains(&format!("`{text}`")), "{told}");
        }
    }

    #[test]
    fn any_address_is_named_by_one_that_a_socket_can_be_bound_to() {
        for any in ["0.0.0.0:4433", "[::]:4433"] {
            let any: SocketAddr = any.parse().expect("an address");
            let found = for_clients(any);
            assert!(!found.is_empty());
            for address in &found {
                assert!(!address.ip().is_unspecified() && address.port() == 4433);
                if any.is_ipv4() {
                    assert!(address.is_ipv4());
                }
            }
            let best = SocketAddr::new(found[0].ip(), 0);
            UdpSocket::bind(best).expect("an address of this machine");
        }
        let one: SocketAddr = "192.0.2.7:4433".parse().expect("an address");
        assert_eq!(for_clients(one), [one]);
    }
}
