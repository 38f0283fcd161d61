//! Python packages for a test, in an environment of its own that is kept for the next run.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use sulcus_support::Resource;

/// Folder of an environment's programs, with these packages installed from PyPI; `None` where Python or the network is missing.
pub fn environment(name: &str, packages: &[&str]) -> Option<PathBuf> {
    Resource::Python.or_skip(made(name, packages))
}

fn made(name: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("venv-{name}"));
    let (programs, ready) = (folder.join("bin"), folder.join("ready"));
    // Two tests with one environment make it once.
    let lock = File::create(folder.with_extension("lock")).expect("the folder is writable");
    lock.lock().expect("a lock");
    let wanted = packages.join(" ");
    if std::fs::read_to_string(&ready).is_ok_and(|there| there == wanted) {
        return Ok(programs);
    }
    let _ = std::fs::remove_dir_all(&folder);
    let mut make = Command::new("python3");
    make.args(["-m", "venv"]).arg(&folder);
    done(make.output()).map_err(|why| format!("no Python environment can be made: {why}"))?;
    let mut install = Command::new(programs.join("python"));
    install
        .args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ])
        .args(["--retries", "2", "--timeout", "20"])
        .args(packages);
    done(install.output()).map_err(|why| format!("`{wanted}` cannot be installed: {why}"))?;
    std::fs::write(&ready, &wanted).expect("the environment is writable");
    Ok(programs)
}

fn done(output: std::io::Result<Output>) -> Result<(), String> {
    let output = output.map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Err(said.lines().last().unwrap_or_default().to_owned())
}

/// What one of the scripts beside this file says of `file`.
pub fn ask(programs: &Path, script: &str, file: &Path) -> serde_json::Value {
    ask_with(programs, script, file, &[])
}

/// As [`ask`], with more arguments.
pub fn ask_with(programs: &Path, script: &str, file: &Path, more: &[&Path]) -> serde_json::Value {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/readers");
    let output = Command::new(programs.join("python"))
        .arg(scripts.join(script))
        .arg(file)
        .args(more)
        .output()
        .expect("python starts");
    let (said, complained) = (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    );
    assert!(output.status.success(), "{script}: {complained}");
    serde_json::from_str(&said).unwrap_or_else(|error| panic!("{error}: {said}{complained}"))
}
