//! `sulcus-server certificate`: shows and rotates the server's certificate.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use serde_json::json;
use sulcus_program::{PathText, say};
use sulcus_proto::hex::hex;

use super::StateArgs;
use crate::state::ServerIdentity;
use crate::state::date::{day, now_s};

/// Long text of the help.
const ABOUT: &str = "\
Show or rotate the server's certificate.

The certificate is made once, at the first start, and kept in the state folder. Every ticket ends in its fingerprint, the
64 digits after the last dot. Clients pin this fingerprint, so tickets stay valid over restarts.";

/// Text after the options of `rotate`.
const ROTATE: &str = "\
A running server presents the new certificate within a second. Open connections stay; from then on clients refuse the
old tickets. Tokens stay valid: in each ticket, replace the digits after the last dot by the new fingerprint, or make
new tickets for a class with
`sulcus-server token add --class ROSTER.csv --renew --out FILE`.";

/// Show or rotate the server's certificate
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT)]
pub struct CertificateArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Print fingerprint and dates; the certificate is made if there is none
    Show(ShowArgs),
    /// Make a new certificate and key, also for a running server; all tickets then end in another fingerprint
    #[command(after_long_help = ROTATE)]
    Rotate(ShowArgs),
}

#[derive(Clone, Debug, Args)]
struct ShowArgs {
    #[command(flatten)]
    state: StateArgs,
    /// File for the certificate (DER), for clients with `--certificate`
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command. The exit code is 0.
///
/// # Errors
/// The state folder or a file cannot be used.
pub fn run(args: &CertificateArgs) -> anyhow::Result<u8> {
    let (args, rotates) = match &args.action {
        Action::Show(args) => (args, false),
        Action::Rotate(args) => (args, true),
    };
    let folder = args.state.open()?;
    let identity = if rotates {
        ServerIdentity::rotate(&folder, now_s())?
    } else {
        ServerIdentity::load_or_create(&folder, now_s())?
    };
    if let Some(path) = &args.out {
        std::fs::write(path, identity.certificate_der())
            .with_context(|| format!("--out {}: cannot write", path.shown()))?;
    }
    let fingerprint = hex(&identity.fingerprint());
    if args.json {
        say!(
            "{}",
            json!({
                "certificate_sha256": fingerprint,
                "created_unix_s": identity.created_unix_s(),
                "expires_unix_s": identity.expires_unix_s(),
                "rotated": rotates,
            })
        );
        return Ok(0);
    }
    say!("certificate  {fingerprint} (SHA-256)");
    say!(
        "made on {}, valid until {}",
        day(identity.created_unix_s()),
        day(identity.expires_unix_s())
    );
    if rotates {
        say!("A running server presents the certificate within a second; open connections stay.");
        say!("All tickets change: replace the digits after the last dot by the new fingerprint.");
    }
    Ok(0)
}
