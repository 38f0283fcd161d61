//! Clients of this release for download.
//!
//! Everybody may fetch them: a station has no sign-in before it has the program. The folder of clients holds nothing
//! else.

use std::path::PathBuf;

use askama::Template;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::Response;
use axum::routing::get;

use crate::App;
use crate::pages::{download, html, problem};
use crate::routes::{Access, Form, Route, row};

/// Beginning of the name of every file that is offered.
const NAME: &str = "sulcus-client";
/// File with the SHA-256 hashes, as `sha256sum` writes it.
const SUMS: &str = "SHA256SUMS";
/// Largest number of files on the page.
const FILES: usize = 64;

/// Routes of the clients.
pub(crate) fn routes() -> Vec<Route> {
    let read = || Method::GET;
    let (open, page, data) = (Access::Open, Form::Page, Form::Data);
    vec![
        row(read(), "/clients", open, page, get(list)),
        row(read(), "/clients/{file}", open, data, get(file)),
    ]
}

/// File of the folder.
#[derive(Debug, PartialEq, Eq)]
struct Offered {
    name: String,
    /// Size, tenths of a megabyte.
    size: String,
    /// SHA-256 in hexadecimal digits; empty without an entry in [`SUMS`].
    hash: String,
    /// Systems and the way of installation.
    purpose: &'static str,
}

#[derive(Template)]
#[template(path = "clients.html")]
struct ClientsPage<'a> {
    release: &'a str,
    files: &'a [Offered],
}

/// Whether a name is that of a client: no part of a path, no other file.
fn is_client(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"._-+~".contains(&byte);
    name.starts_with(NAME) && name.bytes().all(is_plain)
}

/// System of a file, and the way of installation, by the ending of its name.
fn purpose(name: &str) -> &'static str {
    for (ending, purpose) in [
        (".deb", "Debian and Ubuntu: apt-get install ./FILE"),
        (".tar.gz", "other Linux: unpack the archive"),
        (".zip", "Windows: unpack the archive"),
        (".exe", "Windows: the program"),
    ] {
        if name.ends_with(ending) {
            return purpose;
        }
    }
    "see the file README.md of the release"
}

/// Clients of a folder, in the order of their names. A folder that cannot be read offers nothing.
fn offered(folder: Option<PathBuf>) -> Vec<Offered> {
    let Some(folder) = folder else {
        return Vec::new();
    };
    let sums = std::fs::read_to_string(folder.join(SUMS)).unwrap_or_default();
    let hash = |name: &str| {
        let found = sums.lines().filter_map(|line| line.split_once("  "));
        let mut found = found.filter(|(hash, of)| *of == name && hash.len() == 64);
        found
            .next()
            .map_or(String::new(), |(hash, _)| hash.to_owned())
    };
    let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
    let mut files: Vec<Offered> = entries
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            // A link does not count: its target may lie outside of the folder.
            let facts = entry.metadata().ok()?;
            (is_client(&name) && facts.is_file()).then(|| Offered {
                size: format!("{:.1}", facts.len() as f64 / 1e6),
                hash: hash(&name),
                purpose: purpose(&name),
                name,
            })
        })
        .collect();
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files.truncate(FILES);
    files
}

/// `GET /clients`: page with the clients of this release.
async fn list(State(app): State<App>) -> Response {
    let folder = app.house.clients();
    let files = tokio::task::spawn_blocking(move || offered(folder)).await;
    let page = ClientsPage {
        release: env!("CARGO_PKG_VERSION"),
        files: &files.unwrap_or_default(),
    };
    html(StatusCode::OK, &page)
}

/// `GET /clients/{file}`: one client.
async fn file(State(app): State<App>, Path(name): Path<String>, request: Request) -> Response {
    let missing = || problem(StatusCode::NOT_FOUND, "this server offers no such client");
    let Some(folder) = app.house.clients().filter(|_| is_client(&name)) else {
        return missing();
    };
    let path = folder.join(&name);
    match tokio::fs::symlink_metadata(&path).await {
        Ok(facts) if facts.is_file() => {}
        _ => return missing(),
    }
    let mut answer = download(&path, &name, request).await;
    if answer.status().is_success() {
        let binary = HeaderValue::from_static("application/octet-stream");
        answer.headers_mut().insert(header::CONTENT_TYPE, binary);
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clients_alone_are_offered_with_size_hash_and_purpose() {
        let place = tempfile::tempdir().expect("a file");
        let path = |name: &str| place.path().join(name);
        std::fs::write(path("sulcus-client_1.deb"), vec![0; 250_000]).expect("a file");
        std::fs::write(path("sulcus-client-1.tar.gz"), "").expect("a file");
        std::fs::write(path("station.key"), "secret").expect("a file");
        std::fs::write(path("sulcus-client <b>"), "").expect("a file");
        std::os::unix::fs::symlink(path("station.key"), path("sulcus-client-link"))
            .expect("a file");
        let hash = "a".repeat(64);
        std::fs::write(path(SUMS), format!("{hash}  sulcus-client_1.deb\nx  y\n")).expect("a file");
        let found = offered(Some(place.path().to_owned()));
        let names: Vec<&str> = found.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["sulcus-client-1.tar.gz", "sulcus-client_1.deb"]);
        assert_eq!((found[1].size.as_str(), &found[1].hash), ("0.2", &hash));
        assert!(found[1].purpose.contains("apt-get install"));
        assert_eq!(found[0].hash, "");
        assert_eq!(offered(Some(path("none"))), []);
        assert_eq!(offered(None), []);
    }
}
