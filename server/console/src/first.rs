//! The first start: a link that makes the first administrator, once.

use std::net::SocketAddr;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::Form;
use axum::extract::{ConnectInfo, Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use axum_extra::extract::CookieJar;
use serde::Deserialize;
use sulcus_proto::hex::hex;

use crate::{App, pages, sign_in};

/// Time for which the link is valid.
const VALID: Duration = Duration::from_secs(60 * 60);
/// Answer to a link that is used, old or wrong.
const GONE: &str = "this link is used, older than an hour, or wrong; a restart of the server prints a new one while nobody can sign in";

/// Secret of the link, as its hash; `None`: used, or never made.
#[derive(Default)]
pub struct First(Mutex<Option<(blake3::Hash, Instant)>>);

impl First {
    /// Makes the link. Returns its path.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn make(&self, now: Instant) -> Result<String, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        let secret = hex(&bytes);
        let hash = blake3::hash(secret.as_bytes());
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((hash, now));
        Ok(format!("/first/{secret}"))
    }

    /// Whether a link with this secret is valid.
    fn is(&self, secret: &str, now: Instant) -> bool {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.is_some_and(|(hash, made)| {
            // Hashes compare in constant time.
            hash == blake3::hash(secret.as_bytes()) && now.saturating_duration_since(made) < VALID
        })
    }

    /// Ends the link. `false`: another request has used it.
    fn take(&self) -> bool {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
            .is_some()
    }
}

/// Form of the page.
#[derive(Deserialize)]
pub struct Wanted {
    login: String,
    password: String,
    again: String,
}

/// Page with the form.
pub async fn page(State(app): State<App>, Path(secret): Path<String>) -> Response {
    if app.first.is(&secret, Instant::now()) {
        pages::first(StatusCode::OK, "")
    } else {
        pages::problem(StatusCode::NOT_FOUND, GONE)
    }
}

/// Makes the first administrator and signs this browser in.
pub async fn submit(
    State(app): State<App>,
    ConnectInfo(address): ConnectInfo<SocketAddr>,
    Path(secret): Path<String>,
    jar: CookieJar,
    Form(form): Form<Wanted>,
) -> Response {
    let now = Instant::now();
    let is_closed = app.attempts.must_wait(address.ip(), now);
    if is_closed || !app.first.is(&secret, now) {
        app.attempts.wrong(address.ip(), now);
        return pages::problem(StatusCode::NOT_FOUND, GONE);
    }
    if form.password != form.again {
        return pages::first(
            StatusCode::BAD_REQUEST,
            "the password and its repetition differ",
        );
    }
    let house = app.house.clone();
    let made = app
        .slow(move || house.make_first(form.login.trim(), &form.password))
        .await;
    match made {
        Ok(holder) if app.first.take() => {
            tracing::info!(
                "console: first administrator {}, from {}",
                holder.id,
                address.ip()
            );
            sign_in::begin(&app, jar, holder)
        }
        Ok(_) => pages::problem(StatusCode::NOT_FOUND, GONE),
        Err(why) => pages::first(StatusCode::BAD_REQUEST, &why),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_valid_for_an_hour_once_and_by_its_secret_alone() {
        let (first, now) = (First::default(), Instant::now());
        assert!(!first.is("", now));
        let path = first.make(now).expect("made");
        let secret = path.strip_prefix("/first/").expect("a path");
        assert!(first.is(secret, now) && !first.is(&secret[1..], now));
        assert!(!first.is(secret, now + VALID));
        assert!(first.take() && !first.take());
        assert!(!first.is(secret, now));
    }
}
