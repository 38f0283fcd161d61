//! Sign-in by a name and a password or by a ticket; sign-out; change of a password.

use std::net::SocketAddr;
use std::time::Instant;

use axum::extract::{ConnectInfo, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Redirect, Response};
use axum::{Extension, Form};
use axum_extra::extract::CookieJar;
use axum_extra::extract::cookie::{Cookie, SameSite};
use serde::Deserialize;
use sulcus_proto::permission::{Kind, may};

use crate::App;
use crate::guard::Caller;
use crate::house::Holder;
use crate::pages;
use crate::sessions::COOKIE;

/// Longest text of a field, bytes.
const LONGEST: usize = 512;

/// Form of the page: a name with a password, or a token.
#[derive(Deserialize)]
pub struct SignIn {
    #[serde(default)]
    login: String,
    #[serde(default)]
    password: String,
    /// Token, or a ticket, which begins with it.
    #[serde(default)]
    token: String,
}

/// Page with the form.
pub async fn page() -> Response {
    pages::sign_in(StatusCode::OK, "")
}

/// Takes the form: a valid token, or a name with its password, begins a session.
pub async fn submit(
    State(app): State<App>,
    ConnectInfo(address): ConnectInfo<SocketAddr>,
    jar: CookieJar,
    Form(form): Form<SignIn>,
) -> Response {
    let now = Instant::now();
    if app.attempts.must_wait(address.ip(), now) {
        let why = "too many wrong attempts from this address: wait a minute";
        return pages::sign_in(StatusCode::TOO_MANY_REQUESTS, why);
    }
    match find(&app, form).await {
        Ok(holder) => {
            tracing::info!(
                "console: {} {} signs in from {}",
                holder.role,
                holder.id,
                address.ip()
            );
            begin(&app, jar, holder)
        }
        Err(why) => {
            app.attempts.wrong(address.ip(), now);
            pages::sign_in(StatusCode::FORBIDDEN, &why)
        }
    }
}

async fn find(app: &App, form: SignIn) -> Result<Holder, String> {
    let SignIn {
        login,
        password,
        token,
    } = form;
    if [&login, &password, &token]
        .iter()
        .any(|text| text.len() > LONGEST)
    {
        return Err("a field is too long".to_owned());
    }
    let token = token.trim();
    if token.is_empty() {
        let house = app.house.clone();
        let login = login.trim().to_owned();
        return app.slow(move || house.person(&login, &password)).await;
    }
    let token = token.split_once('.').map_or(token, |(token, _)| token);
    app.house.find(token)
}

/// Begins the session of a person and sends the browser to the person's page.
pub(crate) fn begin(app: &App, jar: CookieJar, holder: Holder) -> Response {
    let is_teacher = may(holder.role, Kind::Watch, true);
    // A session of before ends: another person may sit at this browser now.
    if let Some(old) = jar.get(COOKIE) {
        app.sessions.end(old.value());
    }
    let Ok(id) = app.sessions.begin(holder, Instant::now()) else {
        let why = "the system gives no random numbers";
        return pages::sign_in(StatusCode::INTERNAL_SERVER_ERROR, why);
    };
    let cookie = Cookie::build((COOKIE, id))
        .path("/")
        .secure(true)
        .http_only(true)
        .same_site(SameSite::Strict);
    let to = if is_teacher { "/" } else { "/home" };
    (jar.add(cookie), Redirect::to(to)).into_response()
}

/// Ends the session.
pub async fn out(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    jar: CookieJar,
) -> Response {
    if let Some(id) = &caller.session {
        app.sessions.end(id);
    }
    let gone = Cookie::build((COOKIE, "")).path("/").secure(true);
    (jar.remove(gone), Redirect::to("/sign-in")).into_response()
}

/// Form of a change of the password.
#[derive(Deserialize)]
pub struct NewPassword {
    old: String,
    new: String,
    again: String,
}

/// Page with the form of a change.
pub async fn password_page(Extension(caller): Extension<Caller>) -> Response {
    pages::password(StatusCode::OK, &caller, "")
}

/// Changes the password. All sessions of the person end, and this browser begins a new one.
pub async fn set_password(
    State(app): State<App>,
    ConnectInfo(address): ConnectInfo<SocketAddr>,
    Extension(caller): Extension<Caller>,
    jar: CookieJar,
    Form(form): Form<NewPassword>,
) -> Response {
    let now = Instant::now();
    let NewPassword { old, new, again } = form;
    let set = if app.attempts.must_wait(address.ip(), now) {
        Err("too many wrong attempts from this address: wait a minute".to_owned())
    } else if new != again {
        Err("the new password and its repetition differ".to_owned())
    } else {
        let (house, id) = (app.house.clone(), caller.holder.id.clone());
        let set = app.slow(move || house.set_password(&id, &old, &new)).await;
        if set.is_err() {
            app.attempts.wrong(address.ip(), now);
        }
        set
    };
    match set {
        Ok(()) => {
            app.sessions.end_of(&caller.holder.id);
            begin(&app, jar, caller.holder)
        }
        Err(why) => pages::password(StatusCode::FORBIDDEN, &caller, &why),
    }
}
