//! Compiles the messages of `proto/` in pure Rust: no protoc is needed. Beside the types, each file becomes the schema that
//! stands in a recording: the message with all that it imports, comments and so units included.

use std::error::Error;
use std::path::PathBuf;

use prost::Message as _;

/// Messages of `sulcus.v1` that have a channel.
const FILES: [&str; 4] = ["wrench", "contacts", "tool_metrics", "session_metrics"];

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
    Ok(())
}
