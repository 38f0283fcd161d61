//! The thread that serves HTTPS.

use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use axum_server::Handle;
use axum_server::tls_rustls::RustlsConfig;
use rustls::ServerConfig;
use rustls::crypto::ring;
use rustls::pki_types::{CertificateDer, PrivatePkcs8KeyDer};

use crate::connections::{Bounded, MOST};
use crate::first::First;
use crate::house::House;
use crate::{App, routes};

/// Timeout of a connection's first request, and of the headers of each further one.
const HEADERS: Duration = Duration::from_secs(15);
/// Time for open requests at the end. Streams of pages end after it.
const LAST: Duration = Duration::from_millis(500);
/// Niceness of the thread: stations come first.
const NICE: i32 = 5;

/// Certificate and private key.
#[derive(Clone)]
pub struct Identity {
    /// Certificate, DER.
    pub certificate: Vec<u8>,
    /// Private key, PKCS #8, DER.
    pub key: Vec<u8>,
}

/// Error of a start.
#[derive(Debug, thiserror::Error)]
pub enum ConsoleError {
    /// The address cannot be used.
    #[error("console: cannot listen on {listen}: {source}")]
    Listen {
        /// Address asked for.
        listen: SocketAddr,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Certificate and key cannot be used.
    #[error("console: certificate and key cannot be used: {0}")]
    Identity(rustls::Error),
    /// The system refuses a thread.
    #[error("console: the system refuses a thread: {0}")]
    Thread(std::io::Error),
}

/// A running console. A drop ends it.
pub struct Console {
    address: SocketAddr,
    tls: RustlsConfig,
    handle: Handle<SocketAddr>,
    first: Option<String>,
    thread: Option<JoinHandle<()>>,
}

impl Console {
    /// Serves the console of a server on a thread of its own.
    ///
    /// # Errors
    /// A busy or foreign address, a certificate that does not fit its key, or a system without threads.
    pub fn start(
        listen: SocketAddr,
        identity: &Identity,
        house: Arc<dyn House>,
    ) -> Result<Self, ConsoleError> {
        let listener = TcpListener::bind(listen);
        let listener = listener.map_err(|source| ConsoleError::Listen { listen, source })?;
        let address = listener.local_addr();
        let address = address.map_err(|source| ConsoleError::Listen { listen, source })?;
        let tls = tls(identity).map_err(ConsoleError::Identity)?;
        let tls = RustlsConfig::from_config(Arc::new(tls));
        let handle = Handle::new();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build();
        let runtime = runtime.map_err(ConsoleError::Thread)?;
        let (config, ends) = (tls.clone(), handle.clone());
        let first = Arc::new(First::default());
        let link = if house.is_without_teachers() {
            first.make(Instant::now()).ok()
        } else {
            None
        };
        let serve = move || {
            // Without the right to it the console has the scheduling of its process.
            if let Err(error) = rustix::process::nice(NICE) {
                tracing::debug!("console: niceness stays: {error}");
            }
            let served = runtime.block_on(serve(listener, config, ends, house, first));
            if let Err(error) = served {
                tracing::error!("the console has ended: {error}");
            }
            runtime.shutdown_background();
        };
        let thread = std::thread::Builder::new()
            .name("sulcus-console".into())
            .spawn(serve)
            .map_err(ConsoleError::Thread)?;
        Ok(Self {
            address,
            tls,
            handle,
            first: link,
            thread: Some(thread),
        })
    }

    /// Address, with the port that the system chose.
    pub fn local_addr(&self) -> SocketAddr {
        self.address
    }

    /// Path of the link for the first administrator, valid once within an hour of the start; `None`: somebody can sign
    /// in already.
    pub fn first(&self) -> Option<&str> {
        self.first.as_deref()
    }

    /// Presents another certificate to all connections from now on.
    ///
    /// # Errors
    /// Certificate and key do not fit each other, or are not valid.
    pub fn renew(&self, identity: &Identity) -> Result<(), ConsoleError> {
        let tls = tls(identity).map_err(ConsoleError::Identity)?;
        self.tls.reload_from_config(Arc::new(tls));
        Ok(())
    }
}

impl Drop for Console {
    fn drop(&mut self) {
        self.handle.graceful_shutdown(Some(LAST));
        if let Some(thread) = self.thread.take() {
            // A panic was reported by its own message.
            let _ = thread.join();
        }
    }
}

async fn serve(
    listener: TcpListener,
    tls: RustlsConfig,
    handle: Handle<SocketAddr>,
    house: Arc<dyn House>,
    first: Arc<First>,
) -> std::io::Result<()> {
    let app = App {
        first,
        ..App::new(house)
    };
    let mut server = axum_server::from_tcp_rustls(listener, tls)?
        .map(|tls| tls.acceptor(Bounded::new(MOST)))
        .handle(handle)
        .first_request_timeout(HEADERS);
    server.http_builder().http1().header_read_timeout(HEADERS);
    let router = routes::router(app);
    server
        .serve(router.into_make_service_with_connect_info::<SocketAddr>())
        .await
}

fn tls(identity: &Identity) -> Result<ServerConfig, rustls::Error> {
    let certificate = CertificateDer::from(identity.certificate.clone());
    let key = PrivatePkcs8KeyDer::from(identity.key.clone());
    let mut config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()?
        .with_no_client_auth()
        .with_single_cert(vec![certificate], key.into())?;
    config.alpn_protocols = vec![b"h2".to_vec(), b"http/1.1".to_vec()];
    Ok(config)
}
