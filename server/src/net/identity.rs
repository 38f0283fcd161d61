//! Identity of the server: a self-signed certificate, made anew at every start and pinned by clients.

use rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer};

use crate::ServerError;

/// Certificate and its private key.
pub(crate) struct Identity {
    pub certificate: CertificateDer<'static>,
    pub key: PrivateKeyDer<'static>,
}

impl Identity {
    /// Certificate and key from their DER forms.
    pub fn from_der(certificate: &[u8], key: &[u8]) -> Self {
        Self {
            certificate: certificate.to_vec().into(),
            key: PrivatePkcs8KeyDer::from(key.to_vec()).into(),
        }
    }

    /// A new self-signed certificate for `localhost` and, if the station's name can be a host name, for that name.
    pub fn generate(station: &str) -> Result<Self, ServerError> {
        let mut names = vec!["localhost".to_owned()];
        // A station may have any name; only a possible host name goes into the certificate.
        let is_host = |c: char| c.is_ascii_alphanumeric() || c == '-';
        if station.len() <= 63
            && !station.is_empty()
            && station.chars().all(is_host)
            && station != "localhost"
        {
            names.push(station.to_owned());
        }
        let made = rcgen::generate_simple_self_signed(names)
            .map_err(|error| ServerError::Tls(error.to_string()))?;
        Ok(Self {
            certificate: made.cert.der().clone(),
            key: PrivatePkcs8KeyDer::from(made.signing_key.serialize_der()).into(),
        })
    }
}

/// SHA-256 of a certificate in DER, as `openssl x509 -fingerprint -sha256` prints it.
///
/// # Errors
/// None with the cipher suites that this program is built with.
pub fn fingerprint(certificate_der: &[u8]) -> Result<[u8; 32], ServerError> {
    // TLS needs SHA-256 anyway: its implementation replaces another crate.
    let suite = rustls::crypto::ring::cipher_suite::TLS13_AES_128_GCM_SHA256;
    let missing = || ServerError::Tls("SHA-256 is missing".into());
    let digest = suite
        .tls13()
        .ok_or_else(missing)?
        .common
        .hash_provider
        .hash(certificate_der);
    digest.as_ref().try_into().map_err(|_| missing())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fingerprint_is_sha_256() {
        let of_nothing = sulcus_proto::hex::hex(&fingerprint(b"").expect("digest"));
        assert_eq!(
            of_nothing,
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
        );
    }

    #[test]
    fn any_station_name_gives_a_certificate() {
        for station in ["", "room-3", "Zahnklinik Süd / 4", &"x".repeat(300)] {
            assert!(Identity::generate(station).is_ok(), "{station}");
        }
    }
}
