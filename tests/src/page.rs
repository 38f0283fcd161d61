//! A page of the console as a script sees it: `curl` follows the events of all stations and asks for lists.

use std::io::{BufRead as _, BufReader};
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::Value;

use crate::{Place, Serving};

/// Whether this machine has the program.
///
/// # Errors
/// The reason why not.
pub fn can() -> Result<(), String> {
    let asked = Command::new("curl").arg("--version").output();
    match asked {
        Ok(ended) if ended.status.success() => Ok(()),
        _ => Err("curl does not start".into()),
    }
}

/// The program with a token. The certificate is that of a school's own server.
fn curl(place: &Place, server: &Serving, token: &str, path: &str) -> Command {
    let console = server.console.as_deref().expect("a console");
    let mut command = Command::new("curl");
    command
        .args(["--silent", "--insecure", "--no-buffer", "--max-time", "900"])
        .arg("--header")
        .arg(format!("Authorization: Bearer {token}"))
        .arg(format!("https://{console}{path}"))
        .current_dir(place.path("."))
        .stdin(Stdio::null());
    command
}

/// Answer to a request, as text.
pub fn asked(place: &Place, server: &Serving, token: &str, path: &str) -> String {
    let output = curl(place, server, token, path).output();
    String::from_utf8(output.expect("curl runs").stdout).expect("text")
}

/// Answer to a request with a body in JSON, as text.
pub fn posted(place: &Place, server: &Serving, token: &str, path: &str, body: &Value) -> String {
    let mut command = curl(place, server, token, path);
    command.args(["--header", "Content-Type: application/json", "--data"]);
    let output = command.arg(body.to_string()).output();
    String::from_utf8(output.expect("curl runs").stdout).expect("text")
}

/// Answer to a form, as text.
pub fn sent(place: &Place, server: &Serving, token: &str, path: &str, form: &str) -> String {
    let mut command = curl(place, server, token, path);
    let output = command.args(["--data", form]).output();
    String::from_utf8(output.expect("curl runs").stdout).expect("text")
}

/// A page that follows a server. A drop closes the page.
pub struct Page {
    process: Child,
    file: String,
}

impl Page {
    /// Begins to follow the events, and keeps them in a file of this name in the place.
    pub fn follow(place: &Place, server: &Serving, token: &str, file: &str) -> Self {
        let mut command = curl(place, server, token, "/api/events");
        let process = command.args(["--output", file]).spawn();
        Self {
            process: process.expect("curl starts"),
            file: file.to_owned(),
        }
    }

    /// The same with the events in a pipe. A pipe that nobody reads stalls the page.
    pub fn piped(place: &Place, server: &Serving, token: &str) -> (Self, ChildStdout) {
        let mut command = curl(place, server, token, "/api/events");
        let mut process = command.stdout(Stdio::piped()).spawn().expect("curl starts");
        let pipe = process.stdout.take().expect("piped");
        let file = String::new();
        (Self { process, file }, pipe)
    }

    /// Ends a page with a file. Returns the kinds of its events, with their data.
    pub fn close(mut self, place: &Place) -> Vec<(String, Value)> {
        self.end();
        let file = std::fs::File::open(place.path(&self.file)).expect("events");
        events(BufReader::new(file).lines().map_while(Result::ok)).collect()
    }

    fn end(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.end();
    }
}

/// Events of the lines of a stream. An event that is cut off is left out.
pub fn events(lines: impl Iterator<Item = String>) -> impl Iterator<Item = (String, Value)> {
    let mut kind = String::new();
    lines.filter_map(move |line| {
        if let Some(name) = line.strip_prefix("event: ") {
            name.clone_into(&mut kind);
            return None;
        }
        let data = line.strip_prefix("data: ")?;
        Some((kind.clone(), serde_json::from_str(data).ok()?))
    })
}
