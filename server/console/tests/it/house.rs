//! A server with two stations and a token of each role, and a browser that keeps its cookie.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::connect_info::MockConnectInfo;
use axum::http::{Method, Request, Response, StatusCode, header};
use sulcus_console::house::{
    Answering, Cases, Feeds, Grades, Holder, House, Instructed, Recorded, Register, Room, Station,
};
use sulcus_console::{App, routes};
use sulcus_proto::Role;
use sulcus_proto::control::Answer;
use sulcus_proto::station::{StationEvent, StationStatus};
use tokio::sync::{broadcast, watch};
use tower::ServiceExt as _;

/// Names of the stations.
pub const STATIONS: [&str; 2] = ["a", "b"];

/// File of the folder of clients.
pub const CLIENT: &str = "sulcus-client_1_amd64.deb";

/// Ends of a station that a test holds.
pub struct Behind {
    pub status: watch::Sender<StationStatus>,
    pub events: broadcast::Sender<StationEvent>,
}

/// Server of a test. A token is the name of its role, at station `a`; `admin` is valid at every station.
#[derive(Default)]
pub struct Fake {
    pub behind: Vec<Behind>,
    pub revoked: Mutex<Vec<String>>,
    pub instructed: Mutex<Vec<Instructed>>,
    /// Recorded sessions.
    pub recorded: Mutex<Vec<Recorded>>,
    /// Calls of the register.
    pub registered: crate::register::Calls,
    /// Passwords by login name.
    pub passwords: Mutex<BTreeMap<String, String>>,
    /// Live views.
    pub views: crate::view::Views,
    /// Cases.
    pub shelf: crate::cases::Shelf,
}

impl Fake {
    pub fn new() -> Arc<Self> {
        let behind = STATIONS.map(|name| Behind {
            status: watch::Sender::new(status(name)),
            events: broadcast::Sender::new(16),
        });
        Arc::new(Self {
            behind: behind.into(),
            recorded: Mutex::new(crate::results::sessions()),
            ..Self::default()
        })
    }
}

pub fn status(station: &str) -> StationStatus {
    StationStatus {
        station: station.into(),
        learner: format!("learner-of-{station}-1"),
        ..StationStatus::default()
    }
}

impl House for Fake {
    fn stations(&self) -> Vec<Station> {
        STATIONS
            .iter()
            .zip(&self.behind)
            .map(|(name, behind)| Station {
                name: (*name).into(),
                status: behind.status.subscribe(),
                events: behind.events.subscribe(),
            })
            .collect()
    }

    fn find(&self, secret: &str) -> Result<Holder, String> {
        let role: Role = secret.parse().map_err(|_| "unknown token".to_owned())?;
        let holder = Holder {
            id: format!("t-{role}"),
            role,
            station: (role != Role::Admin).then(|| "a".to_owned()),
        };
        self.still(&holder.id).map(|()| holder)
    }

    fn still(&self, id: &str) -> Result<(), String> {
        let revoked = self.revoked.lock().unwrap();
        if revoked.iter().any(|other| other == id) {
            return Err("revoked".into());
        }
        Ok(())
    }

    fn person(&self, login: &str, password: &str) -> Result<Holder, String> {
        let right = self
            .passwords
            .lock()
            .unwrap()
            .get(login)
            .is_some_and(|own| own == password);
        let wrong = || "name or password is wrong".to_owned();
        right.then(|| self.find("admin")).ok_or_else(wrong)?
    }

    fn set_password(&self, _: &str, old: &str, new: &str) -> Result<(), String> {
        let mut passwords = self.passwords.lock().unwrap();
        let own = passwords.values_mut().find(|own| *own == old);
        *own.ok_or("the old password is wrong")? = new.to_owned();
        Ok(())
    }

    fn is_without_teachers(&self) -> bool {
        self.passwords.lock().unwrap().is_empty()
    }

    fn make_first(&self, login: &str, password: &str) -> Result<Holder, String> {
        if password.len() < 10 {
            return Err("the password is too short".into());
        }
        self.passwords
            .lock()
            .unwrap()
            .insert(login.into(), password.into());
        self.find("admin")
    }

    fn instruct(&self, instructed: Instructed) -> Answering {
        self.instructed.lock().unwrap().push(instructed);
        Box::pin(async {
            Answer {
                number: 0,
                taken: true,
                tick: 1234,
                text: String::new(),
            }
        })
    }

    fn obstacles(&self) -> Vec<String> {
        Vec::new()
    }

    fn room(&self) -> Option<Room> {
        Some(Room {
            free_gb: 61.7,
            station_hours: 51.4,
        })
    }

    fn clients(&self) -> Option<PathBuf> {
        static FOLDER: OnceLock<PathBuf> = OnceLock::new();
        let folder = FOLDER.get_or_init(|| {
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("clients");
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join(CLIENT), "program").unwrap();
            folder
        });
        Some(folder.clone())
    }

    fn register(&self) -> &dyn Register {
        self
    }

    fn cases(&self) -> &dyn Cases {
        self
    }

    fn grades(&self) -> &dyn Grades {
        self
    }

    fn feeds(&self) -> &dyn Feeds {
        self
    }
}

/// Router of a server. Needs a runtime.
pub fn router(house: &Arc<Fake>) -> Router {
    router_of(App::new(house.clone()))
}

/// Router with given data.
pub fn router_of(app: App) -> Router {
    let from: SocketAddr = "192.0.2.9:1000".parse().unwrap();
    routes::router(app).layer(MockConnectInfo(from))
}

/// A request of a page of this origin, with a cookie.
pub fn request(method: &Method, path: &str, cookie: Option<&str>, body: &str) -> Request<Body> {
    let form = !path.starts_with("/api");
    let content = if form {
        "application/x-www-form-urlencoded"
    } else {
        "application/json"
    };
    let mut request = Request::builder()
        .method(method)
        .uri(path)
        .header("sec-fetch-site", "same-origin")
        .header(header::CONTENT_TYPE, content);
    if let Some(cookie) = cookie {
        request = request.header(header::COOKIE, cookie);
    }
    request.body(Body::from(body.to_owned())).unwrap()
}

pub async fn send(router: &Router, request: Request<Body>) -> Response<Body> {
    router.clone().oneshot(request).await.unwrap()
}

/// Cookie of a person who signs in with a token.
pub async fn sign_in(router: &Router, token: &str) -> String {
    let asked = request(&Method::POST, "/sign-in", None, &format!("token={token}"));
    let answer = send(router, asked).await;
    assert_eq!(answer.status(), StatusCode::SEE_OTHER, "{token}");
    let cookie = answer.headers()[header::SET_COOKIE].to_str().unwrap();
    for part in [
        "__Host-sulcus=",
        "HttpOnly",
        "Secure",
        "SameSite=Strict",
        "Path=/",
    ] {
        assert!(cookie.contains(part), "{cookie}");
    }
    assert!(!cookie.contains("Domain"), "{cookie}");
    cookie.split(';').next().unwrap().to_owned()
}

pub async fn text(answer: Response<Body>) -> String {
    let bytes = to_bytes(answer.into_body(), 1 << 20).await.unwrap();
    String::from_utf8(bytes.into()).unwrap()
}

pub fn run(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.unwrap().block_on(test);
}
