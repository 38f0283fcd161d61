//! The program starts. Tests of other packages have cargo build the programs by the name of this test.

use std::process::Command;

#[test]
fn the_program_prints_its_version() {
    let program = env!("CARGO_BIN_EXE_sulcus-server");
    let output = Command::new(program).arg("--version").output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let expected = format!("sulcus-server {}", env!("CARGO_PKG_VERSION"));
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(printed.starts_with(&expected), "{printed}");
}
