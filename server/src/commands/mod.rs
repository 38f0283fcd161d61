//! Commands of an administrator: tokens, certificate, plans, cases, classes, backup, end of a school year.

pub mod backup;
pub mod case;
pub mod certificate;
pub mod class;
pub mod init;
#[cfg(feature = "console")]
pub mod person;
pub mod plan;
pub mod rollover;
pub mod token;

use std::path::PathBuf;

use clap::Args;

use crate::state::{StateError, StateFolder};

/// Option of all commands that use the state folder.
#[derive(Clone, Debug, Args)]
pub struct StateArgs {
    /// State folder of the server. Default: $SULCUS_STATE_DIR, else $XDG_STATE_HOME/sulcus, else ~/.local/state/sulcus
    #[arg(long = "state", value_name = "DIR")]
    pub folder: Option<PathBuf>,
}

impl StateArgs {
    /// The folder, created if missing.
    fn open(&self) -> Result<StateFolder, StateError> {
        StateFolder::open(self.folder.as_deref())
    }
}
