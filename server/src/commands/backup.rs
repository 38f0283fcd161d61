//! `sulcus-server backup` and `restore`: the state folder as one file.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;
use sulcus_program::{PathText, say};

use super::StateArgs;
use crate::state::audit::Audit;
use crate::state::{StateFolder, backup};

/// Long text of the help of `backup`.
const BACKUP: &str = "\
Write the state folder into one new file: keys, certificate, tokens, persons, classes, names, plans, cases, grades, audit
log. The server may run meanwhile. The file has private keys and the key table of names: keep it as a secret.

Recordings are not in the file. They are signed and never change; copy their folder with rsync, with the files
*.mcap.grade.json that lie beside them.";

/// Long text of the help of `restore`.
const RESTORE: &str = "\
Make a new state folder from a file of `backup`. Every file is checked against its hash before the folder appears.
A folder that has files is never changed.";

/// Write the state folder into one file
#[derive(Clone, Debug, Args)]
#[command(long_about = BACKUP)]
pub struct BackupArgs {
    /// New file, outside of the state folder
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    state: StateArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Make a state folder from a file of `backup`
#[derive(Clone, Debug, Args)]
#[command(long_about = RESTORE)]
pub struct RestoreArgs {
    /// File of `backup`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    state: StateArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs `backup`. The exit code is 0.
///
/// # Errors
/// The state folder is missing or cannot be read, or the file exists or cannot be written.
pub fn backup(args: &BackupArgs) -> anyhow::Result<u8> {
    let asked = args.state.folder.as_deref();
    let Some(folder) = StateFolder::existing(asked)? else {
        let path = StateFolder::locate(asked)?;
        anyhow::bail!(
            "the state folder {} does not exist, expected that of a server",
            path.shown()
        );
    };
    let content = backup::write(&folder, &args.file)?;
    audited(&folder, "backup", &args.file)?;
    told(args.json, "backup", &args.file, &folder, content);
    Ok(0)
}

/// Runs `restore`. The exit code is 0.
///
/// # Errors
/// The state folder has files, or the file is no whole backup of this or an older release.
pub fn restore(args: &RestoreArgs) -> anyhow::Result<u8> {
    let path = StateFolder::locate(args.state.folder.as_deref())?;
    let content = backup::restore(&args.file, &path)?;
    let folder = StateFolder::open(Some(&path))?;
    audited(&folder, "restore", &args.file)?;
    told(args.json, "restored", &args.file, &folder, content);
    Ok(0)
}

fn audited(folder: &StateFolder, action: &str, file: &std::path::Path) -> anyhow::Result<()> {
    let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    Ok(Audit::of(folder).record(&by, action, &name)?)
}

fn told(
    json: bool,
    action: &str,
    file: &std::path::Path,
    folder: &StateFolder,
    content: backup::Content,
) {
    let backup::Content { files, bytes } = content;
    if json {
        say!(
            "{}",
            json!({ action: file.shown().to_string(), "state": folder.path().shown().to_string(),
                "files": files, "bytes": bytes })
        );
    } else {
        let mib = bytes as f64 / f64::from(1 << 20);
        say!("{action}  {}", file.shown());
        say!("state folder  {}", folder.path().shown());
        say!("files  {files}, {mib:.1} MiB");
        say!("not included: recordings. Copy their folder with rsync");
    }
}
