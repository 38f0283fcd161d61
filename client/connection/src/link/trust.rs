//! Trust in the pinned certificate alone. Names, dates and authorities play no part. The handshake verifies that the
//! server holds the key of the certificate.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use rustls::crypto::{CryptoProvider, ring, verify_tls13_signature};
use rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use rustls::{CertificateError, DigitallySignedStruct, Error, SignatureScheme};

use super::Pin;

/// Verifier of one pinned certificate.
#[derive(Debug)]
pub(super) struct Pinned {
    pin: Pin,
    provider: Arc<CryptoProvider>,
    /// Set when the server has another certificate. The error of the connection does not show this cause.
    mismatch: Arc<AtomicBool>,
}

impl Pinned {
    pub fn new(pin: Pin, provider: Arc<CryptoProvider>, mismatch: Arc<AtomicBool>) -> Self {
        Self {
            pin,
            provider,
            mismatch,
        }
    }

    fn matches(&self, certificate: &[u8]) -> bool {
        match &self.pin {
            Pin::Certificate(der) => certificate == der.as_slice(),
            // TLS needs SHA-256 anyway: its implementation replaces another crate.
            Pin::Fingerprint(expected) => ring::cipher_suite::TLS13_AES_128_GCM_SHA256
                .tls13()
                .is_some_and(|suite| {
                    suite.common.hash_provider.hash(certificate).as_ref() == expected.as_slice()
                }),
        }
    }
}

impl ServerCertVerifier for Pinned {
    fn verify_server_cert(
        &self,
        end_entity: &CertificateDer<'_>,
        _: &[CertificateDer<'_>],
        _: &ServerName<'_>,
        _: &[u8],
        _: UnixTime,
    ) -> Result<ServerCertVerified, Error> {
        if self.matches(end_entity) {
            return Ok(ServerCertVerified::assertion());
        }
        self.mismatch.store(true, Ordering::Release);
        Err(Error::InvalidCertificate(
            CertificateError::ApplicationVerificationFailure,
        ))
    }

    fn verify_tls12_signature(
        &self,
        _: &[u8],
        _: &CertificateDer<'_>,
        _: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        // QUIC requires TLS 1.3.
        Err(Error::General(
            "TLS 1.2 is not supported, expected TLS 1.3".into(),
        ))
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls13_signature(
            message,
            certificate,
            signature,
            &self.provider.signature_verification_algorithms,
        )
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.provider
            .signature_verification_algorithms
            .supported_schemes()
    }
}
