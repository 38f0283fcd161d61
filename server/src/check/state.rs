//! State folder, certificate, tokens and signing key.

use std::path::Path;

use sulcus_program::PathText;
use sulcus_sessions::StationKey;

use super::disk::is_writable_or_can_be;
use super::{CheckInput, Finding};
use crate::plan::PlanBook;
use crate::state::date::{day, now_s};
use crate::state::identity::Validity;
use crate::state::{ServerIdentity, StateFolder, Tokens};

/// Advice for a file of the state folder that cannot be used.
const REPAIR: &str = "Correct the file or its rights, or restore the folder from a backup.";

/// Findings about the state folder and its files.
pub(super) fn state(input: &CheckInput) -> Vec<Finding> {
    let located = StateFolder::locate(input.state.as_deref());
    let path = match located {
        Ok(path) => path,
        Err(error) => {
            let advice = "Name a folder with --state.";
            return vec![Finding::problem("state", sentence(&error), advice)];
        }
    };
    if !path.exists() {
        return vec![missing(&path), key(input)];
    }
    let folder = match StateFolder::open(Some(&path)) {
        Ok(folder) => folder,
        Err(error) => return vec![Finding::problem("state", sentence(&error), REPAIR)],
    };
    let mut findings = vec![
        Finding::ok("state", format!("The folder {} is private.", path.shown())),
        certificate(&folder),
        tokens(&folder, input.has_own_token),
        key(input),
    ];
    if let Err(error) = PlanBook::open(&input.stations, Some(&folder)) {
        findings.push(Finding::problem("plans", sentence(&error), REPAIR));
    }
    findings
}

fn missing(path: &Path) -> Finding {
    match is_writable_or_can_be(path) {
        Ok(()) => Finding::warning(
            "state",
            format!(
                "The folder {} does not exist. The first start makes it, with a new certificate.",
                path.shown()
            ),
            "Make tokens with `sulcus-server token add` before a lesson.",
        ),
        Err(why) => Finding::problem(
            "state",
            format!("The folder {} cannot be made: {why}.", path.shown()),
            "Name another folder with --state.",
        ),
    }
}

fn certificate(folder: &StateFolder) -> Finding {
    let rotate = "Run `sulcus-server certificate rotate` between two lessons. The ends of all tickets change.";
    match ServerIdentity::load(folder) {
        Ok(Some(identity)) => {
            let until = day(identity.expires_unix_s());
            match identity.validity(now_s()) {
                Validity::Good => Finding::ok(
                    "certificate",
                    format!("The certificate is valid until {until}."),
                ),
                Validity::Ending(days) => Finding::warning(
                    "certificate",
                    format!("The certificate expires on {until}, in {days} days."),
                    rotate,
                ),
                Validity::Over => Finding::problem(
                    "certificate",
                    format!("The certificate expired on {until}."),
                    rotate,
                ),
            }
        }
        Ok(None) => Finding::ok("certificate", "The first start makes the certificate."),
        Err(error) => Finding::problem("certificate", sentence(&error), REPAIR),
    }
}

fn tokens(folder: &StateFolder, has_own: bool) -> Finding {
    match Tokens::open(folder).map(|tokens| tokens.valid(now_s())) {
        Ok(0) if !has_own => Finding::warning(
            "tokens",
            "No stored token is valid.",
            "Make tokens with `sulcus-server token add`.",
        ),
        Ok(1) => Finding::ok("tokens", "1 token is valid."),
        Ok(number) => Finding::ok("tokens", format!("{number} tokens are valid.")),
        Err(error) => Finding::problem("tokens", sentence(&error), REPAIR),
    }
}

fn key(input: &CheckInput) -> Finding {
    let path = match (&input.key, &input.state) {
        (Some(path), _) => path.clone(),
        (None, Some(state)) => state.join("station.key"),
        (None, None) => match StationKey::default_path() {
            Ok(path) => path,
            Err(error) => {
                return Finding::problem("key", sentence(&error), "Name a file with --key.");
            }
        },
    };
    if !path.exists() {
        let folder = path.parent().unwrap_or(Path::new("."));
        return match is_writable_or_can_be(folder) {
            Ok(()) => Finding::ok(
                "key",
                "The first start makes the key that signs recordings.",
            ),
            Err(why) => Finding::problem(
                "key",
                format!("The key {} cannot be made: {why}.", path.shown()),
                "Name another file with --key.",
            ),
        };
    }
    match StationKey::load_or_create(&path) {
        Ok(key) => {
            let fingerprint = key.public().to_string();
            let start = fingerprint.get(..8).unwrap_or(&fingerprint);
            Finding::ok("key", format!("Recordings are signed with key {start}..."))
        }
        Err(error) => Finding::problem("key", sentence(&error), REPAIR),
    }
}

/// Text of an error as a sentence.
fn sentence(error: &dyn std::fmt::Display) -> String {
    let text = error.to_string();
    let mut letters = text.chars();
    match letters.next() {
        Some(first) if first.is_lowercase() => {
            format!("{}{}.", first.to_uppercase(), letters.as_str())
        }
        _ => format!("{text}."),
    }
}
