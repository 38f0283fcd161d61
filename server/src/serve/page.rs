//! The instructor's console of `serve`, in builds with it.

use std::net::SocketAddr;

use crate::state::StateFolder;
use crate::{ServerConfig, ServerHandle};

/// A running console; none without `--console`. A drop ends it.
#[derive(Default)]
pub(super) struct Page {
    #[cfg(feature = "console")]
    console: Option<sulcus_console::Console>,
}

impl Page {
    /// Serves the console of a server, if `listen` asks for it.
    ///
    /// # Errors
    /// The address cannot be used, or this build has no console.
    #[cfg(feature = "console")]
    pub fn start(
        listen: Option<SocketAddr>,
        server: &ServerHandle,
        config: &ServerConfig,
        state: &StateFolder,
    ) -> anyhow::Result<Self> {
        let Some(listen) = listen else {
            return Ok(Self::default());
        };
        let (certificate, key) = config.identity.clone().unwrap_or_default();
        let identity = sulcus_console::Identity { certificate, key };
        let console = server.console(listen, &identity, config, Some(state))?;
        Ok(Self {
            console: Some(console),
        })
    }

    /// The same in a build without a console.
    #[cfg(not(feature = "console"))]
    pub fn start(
        listen: Option<SocketAddr>,
        _: &ServerHandle,
        _: &ServerConfig,
        _: &StateFolder,
    ) -> anyhow::Result<Self> {
        match listen {
            None => Ok(Self::default()),
            Some(_) => anyhow::bail!(
                "this build has no console; build with `cargo build --release -p sulcus-server --features console`"
            ),
        }
    }

    /// Address of the console, with the port that the system chose.
    pub fn address(&self) -> Option<SocketAddr> {
        #[cfg(feature = "console")]
        return self.console.as_ref().map(|console| {
            crate::net::addresses::for_clients(console.local_addr())
                .first()
                .copied()
                .unwrap_or(console.local_addr())
        });
        #[cfg(not(feature = "console"))]
        None
    }

    /// Link for the first administrator, valid for an hour; none where there are teachers.
    pub fn first(&self) -> Option<String> {
        #[cfg(feature = "console")]
        {
            let path = self.console.as_ref()?.first()?;
            Some(format!("https://{}{path}", self.address()?))
        }
        #[cfg(not(feature = "console"))]
        None
    }

    /// Presents another certificate (DER, with its private key in PKCS #8) from now on.
    ///
    /// # Errors
    /// Certificate and key do not fit each other.
    #[cfg_attr(not(feature = "console"), allow(clippy::unused_self, unused_variables))]
    pub fn renew(&self, certificate: &[u8], key: &[u8]) -> anyhow::Result<()> {
        #[cfg(feature = "console")]
        if let Some(console) = &self.console {
            console.renew(&sulcus_console::Identity {
                certificate: certificate.to_vec(),
                key: key.to_vec(),
            })?;
        }
        Ok(())
    }
}
