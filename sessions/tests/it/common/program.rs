//! The program from outside.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// `sulcus-sessions` with these arguments. No viewer, whatever is installed here.
pub fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sulcus-sessions"))
        .args(args)
        .env("PATH", "/nowhere")
        .output()
        .unwrap()
}

pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The last line of standard output.
pub fn json_of(output: &Output) -> Value {
    serde_json::from_str(out(output).lines().last().unwrap()).unwrap()
}

pub fn text_of(path: &Path) -> &str {
    path.to_str().unwrap()
}
