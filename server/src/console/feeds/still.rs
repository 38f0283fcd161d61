//! Mouth at rest for the viewer: the first part of a live view, without a session.

use std::io::BufReader;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use sulcus_proto::live::{self, Kind};

use super::PROGRAM;
use super::drawing::idle;

/// Timeout of the program. A whole mouth takes about a second on a machine without other work.
const LONGEST: Duration = Duration::from_secs(60);

/// File for the viewer of an encoded display scene.
///
/// # Errors
/// The program cannot be started, fails, or takes too long: one sentence.
pub(in crate::console) fn drawn(program: &Path, scene: &[u8]) -> Result<Vec<u8>, String> {
    let failed = |error: &dyn std::fmt::Display| format!("{PROGRAM}: {error}");
    let mut child = Command::new(program)
        .arg("live")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| failed(&error))?;
    idle(&child);
    let (Some(mut to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
        return Err(failed(&"no pipes"));
    };
    let (tell, told) = mpsc::channel();
    // The program reads the whole scene before it writes.
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let sent = live::write(&mut to, Kind::Scene, scene);
            drop(to);
            let part = sent.and_then(|()| live::read(&mut BufReader::new(from)));
            // An error means that the wait has ended.
            let _ = tell.send(part);
        });
        let part = told.recv_timeout(LONGEST);
        // The end of the program ends the pipes, and thus the thread.
        let _ = child.kill();
        let _ = child.wait();
        match part {
            Ok(Ok(Some((Kind::Begin, part)))) => Ok(part),
            Ok(Ok(_)) => Err(failed(&"the program drew nothing")),
            Ok(Err(error)) => Err(failed(&error)),
            Err(_) => Err(failed(&"the program took too long")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_draws_nothing_and_none_are_sentences() {
        let none = drawn(Path::new("/none/sulcus-review"), &[1]);
        assert!(none.expect_err("no program").starts_with(PROGRAM));
        let silent = drawn(Path::new("/bin/true"), &[1]);
        assert!(silent.expect_err("no part").starts_with(PROGRAM));
    }
}
