//! A rotated certificate reaches the running server.

use std::path::{Path, PathBuf};

use anyhow::Context;

use super::page::Page;
use crate::ServerHandle;
use crate::state::{ServerIdentity, StateFolder};
use sulcus_program::{PathText, tell};
use sulcus_proto::hex::hex;

/// Follows the identity of the state folder.
pub(super) struct Renewal {
    folder: StateFolder,
    /// Fingerprint of the certificate that the server presents.
    fingerprint: [u8; 32],
    /// File for the certificate, of `--certificate-out`.
    out: Option<PathBuf>,
    /// Fault of the file that was told last; the former certificate stays in use.
    fault: Option<String>,
}

impl Renewal {
    /// Follows the folder of a server that presents `identity`. Each new certificate also goes to the file `out`.
    pub fn new(folder: StateFolder, identity: &ServerIdentity, out: Option<PathBuf>) -> Self {
        Self {
            folder,
            fingerprint: identity.fingerprint(),
            out,
            fault: None,
        }
    }

    /// Reads the file of the identity. A new certificate is used for all connections from now on; open connections
    /// stay.
    pub fn look(&mut self, server: &ServerHandle, page: &Page) {
        let fault = match self.take(server, page) {
            Ok(()) => None,
            Err(error) => Some(format!("{error:#}")),
        };
        if let Some(text) = &fault
            && self.fault != fault
        {
            tell!("error: the certificate stays the same: {text}");
        }
        self.fault = fault;
    }

    fn take(&mut self, server: &ServerHandle, page: &Page) -> anyhow::Result<()> {
        // No file: someone moves the folder. The identity in use is kept in memory.
        let Some(found) = ServerIdentity::load(&self.folder)? else {
            return Ok(());
        };
        if found.fingerprint() != self.fingerprint {
            if let Some(path) = &self.out {
                write(path, found.certificate_der())?;
            }
            server.renew(found.certificate_der(), found.key().secret_der())?;
            page.renew(found.certificate_der(), found.key().secret_der())?;
            self.fingerprint = found.fingerprint();
            tell!(
                "new certificate {} (SHA-256): new connections need tickets that end in it",
                hex(&self.fingerprint)
            );
        }
        Ok(())
    }
}

/// Writes the file of `--certificate-out`.
///
/// # Errors
/// The file cannot be written.
pub(super) fn write(path: &Path, certificate_der: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, certificate_der)
        .with_context(|| format!("--certificate-out {}: cannot write", path.shown()))
}
