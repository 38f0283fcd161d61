//! Bound of open connections: the console never takes the file handles of the stations.

use std::future::{Ready, ready};
use std::io;
use std::sync::Arc;

use axum_server::accept::Accept;
use tokio::net::TcpStream;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tower_http::add_extension::AddExtension;

/// Largest number of open connections. A browser opens one by HTTP/2, or six by HTTP/1.1.
pub const MOST: usize = 256;

/// Acceptor that takes a slot for each connection and drops a connection without one.
#[derive(Clone, Debug)]
pub struct Bounded {
    slots: Arc<Semaphore>,
}

impl Bounded {
    /// Acceptor with `most` slots.
    pub fn new(most: usize) -> Self {
        Self {
            slots: Arc::new(Semaphore::new(most)),
        }
    }
}

impl<S> Accept<TcpStream, S> for Bounded {
    type Stream = TcpStream;
    /// The slot lives as long as the service of the connection.
    type Service = AddExtension<S, Arc<OwnedSemaphorePermit>>;
    type Future = Ready<io::Result<(Self::Stream, Self::Service)>>;

    fn accept(&self, stream: TcpStream, service: S) -> Self::Future {
        let Ok(slot) = self.slots.clone().try_acquire_owned() else {
            let full = "too many open connections";
            return ready(Err(io::Error::new(io::ErrorKind::ConnectionRefused, full)));
        };
        let service = AddExtension::new(service, Arc::new(slot));
        ready(stream.set_nodelay(true).and(Ok((stream, service))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_connection_beyond_the_bound_is_dropped_until_another_one_ends() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("a runtime");
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0")
                .await
                .expect("a socket");
            let address = listener.local_addr().expect("bound");
            let bounded = Bounded::new(2);
            let mut clients = Vec::new();
            let mut open = Vec::new();
            for k in 0..3 {
                clients.push(TcpStream::connect(address).await.expect("connects"));
                let (stream, _) = listener.accept().await.expect("a connection");
                let accepted = bounded.accept(stream, ()).await;
                assert_eq!(accepted.is_ok(), k < 2, "connection {k}");
                open.extend(accepted);
            }
            // The stream alone keeps no slot: the service does.
            let (_stream, service) = open.pop().expect("two are open");
            drop(service);
            clients.push(TcpStream::connect(address).await.expect("connects"));
            let (stream, _) = listener.accept().await.expect("a connection");
            assert!(bounded.accept(stream, ()).await.is_ok());
        });
    }
}
