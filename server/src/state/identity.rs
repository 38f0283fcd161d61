//! Identity of a server: certificate and private key, made once and kept, so that tickets outlive a restart.
//!
//! Clients pin the fingerprint of the certificate. The expiry therefore protects nobody; it reminds an administrator to
//! rotate the key. A rotation changes the fingerprint, the second half of every ticket. Tokens stay valid: a holder
//! replaces the part of the ticket after its last dot.

use rcgen::{CertificateParams, DnType, KeyPair, date_time_ymd};
use rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::Duration;
use sulcus_proto::hex::{from_hex, hex};

use super::date::{DAY_S, day};
use super::error::StateError;
use super::files::{Lock, read_private, write_private};
use super::folder::StateFolder;

/// File of the identity.
const FILE: &str = "identity.toml";
/// Version of the file's layout.
const VERSION: u32 = 1;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 64 * 1024;
/// Validity of a new certificate: ten years. Chosen: clients pin the certificate, and a device lives as long.
const VALID_DAYS: u64 = 3652;
/// Remaining validity below which an administrator is warned, days. Chosen: a holiday and a term.
const WARN_DAYS: u64 = 120;

/// Certificate and private key of a server. `Debug` shows the fingerprint alone.
#[derive(Clone, PartialEq, Eq)]
pub struct ServerIdentity {
    certificate_der: Vec<u8>,
    key_der: Vec<u8>,
    fingerprint: [u8; 32],
    created_unix_s: u64,
    expires_unix_s: u64,
}

/// Layout of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    created_unix_s: u64,
    expires_unix_s: u64,
    certificate_der: String,
    key_pkcs8_der: String,
}

/// Remaining validity of a certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Validity {
    /// Valid for longer than the time of a warning.
    Good,
    /// Valid, but to be rotated: the number of whole days left.
    Ending(u64),
    /// No longer valid.
    Over,
}

impl ServerIdentity {
    /// Identity of the state folder. The first call makes it; of two processes at once, both get the same.
    ///
    /// # Errors
    /// The file cannot be read or written, can be read by other users, or has other content. A damaged file is never
    /// replaced, because a new certificate changes all tickets.
    pub fn load_or_create(folder: &StateFolder, now_s: u64) -> Result<Self, StateError> {
        if let Some(found) = Self::load(folder)? {
            return Ok(found);
        }
        let _lock = Lock::wait(&folder.file("identity.lock"))?;
        // Another process may have made the identity before this one got the lock.
        match Self::load(folder)? {
            Some(found) => Ok(found),
            None => Self::make(folder, now_s),
        }
    }

    /// Identity of the state folder; `None` before the first start.
    ///
    /// # Errors
    /// The errors of [`ServerIdentity::load_or_create`].
    pub fn load(folder: &StateFolder) -> Result<Option<Self>, StateError> {
        let path = folder.file(FILE);
        let Some(bytes) = read_private(&path, MOST_BYTES)? else {
            return Ok(None);
        };
        Self::parse(&bytes)
            .map(Some)
            .map_err(|why| StateError::content(&path, why))
    }

    /// Replaces the identity by a new one. `serve` presents the new certificate within a second.
    ///
    /// # Errors
    /// The file cannot be written; the former identity stays.
    pub fn rotate(folder: &StateFolder, now_s: u64) -> Result<Self, StateError> {
        let _lock = Lock::wait(&folder.file("identity.lock"))?;
        Self::make(folder, now_s)
    }

    /// Certificate for TLS.
    pub fn certificate(&self) -> CertificateDer<'static> {
        self.certificate_der.clone().into()
    }

    /// Private key for TLS.
    pub fn key(&self) -> PrivateKeyDer<'static> {
        PrivatePkcs8KeyDer::from(self.key_der.clone()).into()
    }

    /// Certificate in DER.
    pub fn certificate_der(&self) -> &[u8] {
        &self.certificate_der
    }

    /// SHA-256 of the certificate, the second part of every ticket.
    pub fn fingerprint(&self) -> [u8; 32] {
        self.fingerprint
    }

    /// Time at which the certificate was made, seconds since 1970.
    pub fn created_unix_s(&self) -> u64 {
        self.created_unix_s
    }

    /// Time at which the certificate expires, seconds since 1970.
    pub fn expires_unix_s(&self) -> u64 {
        self.expires_unix_s
    }

    /// Validity at a time in seconds since 1970.
    pub fn validity(&self, now_s: u64) -> Validity {
        match self.expires_unix_s.saturating_sub(now_s) / DAY_S {
            _ if now_s >= self.expires_unix_s => Validity::Over,
            days if days < WARN_DAYS => Validity::Ending(days),
            _ => Validity::Good,
        }
    }

    fn make(folder: &StateFolder, now_s: u64) -> Result<Self, StateError> {
        let made = Self::generate(now_s)?;
        let stored = Stored {
            version: VERSION,
            created_unix_s: made.created_unix_s,
            expires_unix_s: made.expires_unix_s,
            certificate_der: hex(&made.certificate_der),
            key_pkcs8_der: hex(&made.key_der),
        };
        let path = folder.file(FILE);
        let text = toml::to_string(&stored)
            .map_err(|error| StateError::content(&path, error.to_string()))?;
        let text = format!(
            "# Certificate of this server, valid until {}, and its private key. Never copy this file to another machine.\n{text}",
            day(made.expires_unix_s)
        );
        write_private(&path, text.as_bytes())?;
        Ok(made)
    }

    fn generate(now_s: u64) -> Result<Self, StateError> {
        let failed = |error: rcgen::Error| StateError::Certificate(error.to_string());
        let mut params = CertificateParams::new(vec!["localhost".to_owned()]).map_err(failed)?;
        params
            .distinguished_name
            .push(DnType::CommonName, "Sulcus server");
        let at = |unix_s| date_time_ymd(1970, 1, 1) + Duration::from_secs(unix_s);
        let expires_unix_s = now_s + VALID_DAYS * DAY_S;
        // A day earlier, for clients whose clock is slow.
        params.not_before = at(now_s.saturating_sub(DAY_S));
        params.not_after = at(expires_unix_s);
        let key = KeyPair::generate().map_err(failed)?;
        let certificate = params.self_signed(&key).map_err(failed)?;
        Self::of(
            certificate.der().to_vec(),
            key.serialize_der(),
            now_s,
            expires_unix_s,
        )
    }

    fn of(
        certificate_der: Vec<u8>,
        key_der: Vec<u8>,
        created_unix_s: u64,
        expires_unix_s: u64,
    ) -> Result<Self, StateError> {
        let fingerprint = crate::fingerprint(&certificate_der)
            .map_err(|error| StateError::Certificate(error.to_string()))?;
        Ok(Self {
            certificate_der,
            key_der,
            fingerprint,
            created_unix_s,
            expires_unix_s,
        })
    }

    /// Identity of a file's content. The reason of an error contains no part of the file, which holds a secret.
    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let advice = "restore the file from a backup, or run `sulcus-server certificate rotate`, which changes all tickets";
        let text = std::str::from_utf8(bytes)
            .map_err(|_| format!("the content is no text, expected an identity; {advice}"))?;
        let stored: Stored = crate::exact::read(text).map_err(|error| {
            // The message of the reader alone: its long form quotes the line.
            let line = error.span().map_or(1, |span| {
                1 + text[..span.start.min(text.len())].matches('\n').count()
            });
            format!("line {line}: no identity of a server; {advice}")
        })?;
        if stored.version != VERSION {
            return Err(format!(
                "version is {}, expected {VERSION}; install the program that wrote the file",
                stored.version
            ));
        }
        let certificate = from_hex(&stored.certificate_der)
            .filter(|der| !der.is_empty())
            .ok_or_else(|| format!("certificate_der is not hexadecimal; {advice}"))?;
        let key = from_hex(&stored.key_pkcs8_der)
            .filter(|der| KeyPair::try_from(der.as_slice()).is_ok())
            .ok_or_else(|| format!("key_pkcs8_der is no private key; {advice}"))?;
        Self::of(
            certificate,
            key,
            stored.created_unix_s,
            stored.expires_unix_s,
        )
        .map_err(|error| error.to_string())
    }
}

impl fmt::Debug for ServerIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ServerIdentity({})", hex(&self.fingerprint))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::state::folder::fresh as folder;

    /// 2026-11-26.
    const NOW: u64 = 1_795_651_200;

    #[test]
    fn an_identity_is_made_once_and_loaded_afterwards() {
        let (_place, folder) = folder();
        assert_eq!(ServerIdentity::load(&folder).expect("no file"), None);
        let first = ServerIdentity::load_or_create(&folder, NOW).expect("makes");
        let second = ServerIdentity::load_or_create(&folder, NOW + 9).expect("loads");
        assert_eq!(first, second);
        assert_eq!(first.created_unix_s(), NOW);
        assert_eq!(day(first.expires_unix_s()), "2036-11-25");
    }

    #[test]
    fn processes_that_start_at_once_get_the_same_identity() {
        let (_place, folder) = folder();
        let all: Vec<[u8; 32]> = std::thread::scope(|scope| {
            let make = || ServerIdentity::load_or_create(&folder, NOW).expect("makes");
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(make)).collect();
            let ended = threads.into_iter().map(|thread| thread.join());
            ended
                .map(|made| made.expect("no panic").fingerprint())
                .collect()
        });
        assert!(all.iter().all(|one| *one == all[0]), "{all:?}");
    }

    #[test]
    fn a_rotation_changes_the_fingerprint() {
        let (_place, folder) = folder();
        let first = ServerIdentity::load_or_create(&folder, NOW).expect("makes");
        let second = ServerIdentity::rotate(&folder, NOW + DAY_S).expect("rotates");
        assert_ne!(first.fingerprint(), second.fingerprint());
        let third = ServerIdentity::load(&folder).expect("loads");
        assert_eq!(third.as_ref(), Some(&second));
    }

    #[test]
    fn the_stored_pair_serves_tls() {
        let (_place, folder) = folder();
        ServerIdentity::load_or_create(&folder, NOW).expect("makes");
        let found = ServerIdentity::load(&folder)
            .expect("loads")
            .expect("there");
        let provider = rustls::crypto::ring::default_provider();
        let built = rustls::ServerConfig::builder_with_provider(provider.into())
            .with_protocol_versions(&[&rustls::version::TLS13])
            .expect("TLS 1.3")
            .with_no_client_auth()
            .with_single_cert(vec![found.certificate()], found.key());
        assert!(
            built.is_ok(),
            "the key belongs to the certificate: {built:?}"
        );
    }

    #[test]
    fn validity_ends_with_a_warning_before() {
        let (_place, folder) = folder();
        let made = ServerIdentity::load_or_create(&folder, NOW).expect("makes");
        let at = |days: u64| made.validity(NOW + days * DAY_S);
        assert_eq!(at(0), Validity::Good);
        assert_eq!(at(VALID_DAYS - 119), Validity::Ending(119));
        assert_eq!(at(VALID_DAYS), Validity::Over);
    }

    #[test]
    fn a_damaged_file_is_refused_without_a_word_of_its_secret() {
        let (_place, folder) = folder();
        ServerIdentity::load_or_create(&folder, NOW).expect("makes");
        let path = folder.file(FILE);
        let text = std::fs::read_to_string(&path).expect("reads");
        let secret = text
            .lines()
            .find(|line| line.starts_with("key_"))
            .expect("the key")
            .to_owned();
        let digits = &secret["key_pkcs8_der = \"".len()..secret.len() - 1];
        let half = &digits[..digits.len() / 2];
        for damaged in [
            text.replace(digits, half),
            text.replace(&secret, &format!("key_pkcs8_der = {digits}")),
            text.replace(&secret, &format!("{secret}\nspare = 1")),
            text.replace("version = 1", "version = 2"),
        ] {
            assert_ne!(damaged, text);
            std::fs::write(&path, &damaged).expect("writes");
            let error = ServerIdentity::load_or_create(&folder, NOW).expect_err("damaged");
            let error = error.to_string();
            assert!(!error.contains(&half[..20]), "{error}");
            let kept = std::fs::read_to_string(&path).expect("reads");
            assert_eq!(kept, damaged, "never replaced");
        }
    }

    proptest! {
        #[test]
        fn no_content_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200), text in "[a-z_]{1,16} = \"?[0-9a-fé]{0,9}\"?\n?") {
            let _ = ServerIdentity::parse(&bytes);
            let _ = ServerIdentity::parse(text.as_bytes());
        }
    }
}
