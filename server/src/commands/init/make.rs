//! Files of a first start. Nothing that exists is changed.

use std::fs::DirBuilder;
use std::io::ErrorKind;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::Path;

use anyhow::Context;
use sulcus_program::{PathText, say};
use sulcus_proto::{Role, Ticket};

use super::InitArgs;
use crate::check::CheckInput;
use crate::state::classes::Classes;
use crate::state::date::{DAY_S, now_s};
use crate::state::tokens::{NewToken, Place, TokenStore};
use crate::state::{ServerIdentity, StateFolder, create_private};

/// File of stations of the service that the package installs.
const SERVICE: &str = "/var/lib/sulcus/school/stations.toml";
/// Days for which the tickets are valid.
const DAYS: u64 = 365;

/// Things that were made, and things that existed.
#[derive(Debug, Default)]
pub(super) struct Made {
    pub made: Vec<String>,
    pub kept: Vec<String>,
}

impl Made {
    /// Makes folders, file of stations, certificate, tickets and class.
    pub fn make(
        args: &InitArgs,
        file: &Path,
        text: &str,
        input: &CheckInput,
        class: &str,
    ) -> anyhow::Result<Self> {
        let mut made = Self::default();
        for folder in [&args.school, &input.recordings] {
            let is_there = folder.is_dir();
            let mut builder = DirBuilder::new();
            let built = builder.recursive(true).mode(0o700).create(folder);
            built.with_context(|| format!("folder {}", folder.shown()))?;
            made.note(folder, is_there);
        }
        let state = StateFolder::open(args.state.folder.as_deref())?;
        made.file(file, text)?;
        let now = now_s();
        let identity = ServerIdentity::load_or_create(&state, now)?;
        let tickets = args.school.join("tickets.csv");
        if tickets.exists() {
            made.note(&tickets, true);
        } else {
            Self::tickets(&state, &identity, input, &tickets, now)?;
            made.note(&tickets, false);
        }
        if !class.is_empty() {
            let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
            let classes = Classes::of(&state, &by);
            // Names differ by more than capitals.
            let same = class.to_lowercase();
            let roll = classes.roll()?;
            let is_there = roll
                .classes
                .iter()
                .any(|one| one.name.to_lowercase() == same);
            if !is_there {
                classes.make(class, now)?;
            }
            let list = if is_there {
                &mut made.kept
            } else {
                &mut made.made
            };
            list.push(format!("class {class}"));
        }
        Ok(made)
    }

    fn note(&mut self, path: &Path, is_there: bool) {
        let list = if is_there {
            &mut self.kept
        } else {
            &mut self.made
        };
        list.push(path.shown().to_string());
    }

    /// Makes a file unless it exists.
    fn file(&mut self, path: &Path, text: &str) -> anyhow::Result<()> {
        let created = std::fs::OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(path);
        let is_there = match created {
            Ok(mut file) => {
                std::io::Write::write_all(&mut file, text.as_bytes())
                    .with_context(|| format!("file {}", path.shown()))?;
                false
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => true,
            Err(error) => return Err(error).with_context(|| format!("file {}", path.shown())),
        };
        self.note(path, is_there);
        Ok(())
    }

    /// Makes a ticket for each station, for an instructor and for an administrator, in a private table.
    fn tickets(
        state: &StateFolder,
        identity: &ServerIdentity,
        input: &CheckInput,
        path: &Path,
        now: u64,
    ) -> anyhow::Result<()> {
        let expires_unix_s = now + DAYS * DAY_S;
        let new = |role: Role, station: Place| NewToken {
            role,
            station,
            learner: String::new(),
            class: String::new(),
            expires_unix_s,
        };
        let students = input
            .stations
            .iter()
            .map(|station| new(Role::Student, Place::Station(station.name.clone())));
        let teachers = [Role::Instructor, Role::Admin].map(|role| new(role, Place::Any));
        let wanted: Vec<NewToken> = students.chain(teachers).collect();
        let store = TokenStore::of(state);
        let made = store.add(&wanted, now)?;
        let mut table = String::from("role,station,ticket\n");
        for (record, secret) in &made {
            let ticket = Ticket {
                token: secret.reveal().to_owned(),
                fingerprint: identity.fingerprint(),
            };
            table.push_str(&format!("{},{},{ticket}\n", record.role, record.station));
        }
        let written = create_private(path, table.as_bytes());
        if let Err(error) = written {
            // Tokens that nobody has received must not stay valid.
            for (record, _) in &made {
                store.revoke(&record.id, now)?;
            }
            return Err(error.into());
        }
        Ok(())
    }

    /// Prints the result and the next commands.
    pub fn told(&self, folder: &Path, file: &Path, state: Option<&Path>, listen: &str) {
        for one in &self.made {
            say!("made     {one}");
        }
        for one in &self.kept {
            say!("kept     {one}");
        }
        let state = state.map_or(String::new(), |state| format!(" --state {}", state.shown()));
        let port = listen.rsplit(':').next().unwrap_or("4433");
        say!("");
        say!("Next:");
        if file == Path::new(SERVICE) {
            say!("  systemctl enable --now sulcus-server");
        } else {
            say!("  sulcus-server serve --config {}{state}", file.shown());
        }
        say!("  sulcus-client run --server THIS-MACHINE:{port} --ticket TICKET      at a station");
        say!(
            "The tickets are in {}: keep the file as a secret.",
            folder.join("tickets.csv").shown()
        );
        say!("Open the UDP port {port} of the firewall for incoming packets.");
    }
}
