//! The program from outside.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// The program of the crate under test: `sulcus-sessions`, or `sulcus-review` of the crate below.
const PROGRAM: &str = match option_env!("CARGO_BIN_EXE_sulcus-sessions") {
    Some(program) => program,
    None => env_or_empty(option_env!("CARGO_BIN_EXE_sulcus-review")),
};

const fn env_or_empty(program: Option<&'static str>) -> &'static str {
    match program {
        Some(program) => program,
        None => "",
    }
}

/// The program with these arguments. PATH is empty, so that no installed viewer opens.
pub fn run(args: &[&str]) -> Output {
    Command::new(PROGRAM)
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
