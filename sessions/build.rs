//! Compiles the messages of `proto/` in pure Rust: no protoc is needed. Beside the types, each file becomes the schema that
//! stands in a recording: the message with all that it imports, comments and so units included.
//!
//! And hashes the sources of the tick, so that a recording can say which tick it was recorded by: a version number stays the same
//! between two builds of a day. Likewise those of the measures, so that a grade can say which it is by.

use std::error::Error;
use std::path::{Path, PathBuf};

use prost::Message as _;

/// Messages of `sulcus.v1` that have a channel.
const FILES: [&str; 8] = [
    "exact_row",
    "exact_state",
    "exact_statement",
    "exact_event",
    "wrench",
    "contacts",
    "tool_metrics",
    "session_metrics",
];

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    println!("cargo::rerun-if-changed=proto");
    let path = |name: &str| format!("sulcus/v1/{name}.proto");
    for name in FILES {
        let schema = protox::compile([path(name)], ["proto"])?;
        std::fs::write(out.join(format!("{name}.bin")), schema.encode_to_vec())?;
    }
    let all = protox::compile(FILES.map(path), ["proto"])?;
    prost_build::Config::new().compile_fds(all)?;
    let tick = ["../server/core/src"];
    println!("cargo::rustc-env=SULCUS_TICK_SOURCE={}", source(&tick)?);
    let measures = [tick[0], "src/grade", "src/exercise"];
    println!(
        "cargo::rustc-env=SULCUS_MEASURES_SOURCE={}",
        source(&measures)?
    );
    Ok(())
}

/// Hash over the sources in these folders, the core's manifest, and the versions of all that the workspace is built on. Two builds of
/// equal hash have the same of what is there; of two that differ it may be the same.
fn source(folders: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut files = Vec::new();
    for folder in folders {
        list(Path::new(folder), &mut files)?;
    }
    files.extend(["../server/core/Cargo.toml", "../Cargo.lock"].map(PathBuf::from));
    files.sort();
    let mut hasher = blake3::Hasher::new();
    for file in files {
        println!("cargo::rerun-if-changed={}", file.display());
        // A checkout may have made other ends of lines.
        let text = std::fs::read_to_string(&file)?.replace("\r\n", "\n");
        let name = file.to_string_lossy().replace('\\', "/");
        for part in [name, text] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        }
    }
    Ok(hasher.finalize().to_hex()[..16].to_owned())
}

/// All Rust files under a folder.
fn list(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}
