//! The instructor's console: one page that shows every station of a server live, and takes instructions.
//!
//! The console serves HTTPS on a thread of its own with ordinary scheduling. It knows the simulation only through
//! [`House`]: newest statuses, events, instructions with their answers. A page that stalls fills its own queue and
//! delays nobody.
//!
//! | module | content |
//! |---|---|
//! | [`house`] | interface to the server |
//! | [`routes`] | table of all routes with the roles that may use each; the router is made from it |
//! | [`guard`] | sign-in, role and origin of each request, by that table |
//! | [`sessions`] | signed-in browsers |
//! | [`sign_in`], [`attempts`], [`first`] | sign-in, wrong attempts, the first administrator |
//! | [`hub`] | status and events, encoded once for all pages |
//! | [`live`] | the stream of a page |
//! | [`instructions`] | instructions of a page, each carried out once |
//! | `connections` | bound of open connections |
//! | [`pages`], [`assets`] | HTML, style and script |
//! | `register`, `cases`, `results`, `view` | classes and seats, patients, grades, live view: each with its own routes |

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod assets;
pub mod attempts;
mod cases;
mod clients;
mod connections;
pub mod first;
pub mod guard;
pub mod health;
pub mod house;
pub mod hub;
pub mod instructions;
pub mod live;
pub mod pages;
mod register;
mod results;
pub mod routes;
mod serve;
pub mod sessions;
pub mod sign_in;
pub mod view;

use std::sync::Arc;

pub use house::House;
pub use serve::{Console, ConsoleError, Identity};

/// Data of all requests.
#[derive(Clone)]
pub struct App {
    /// The server.
    pub house: Arc<dyn House>,
    /// Signed-in browsers.
    pub sessions: Arc<sessions::Sessions>,
    /// Status and events for all pages.
    pub hub: Arc<hub::Hub>,
    /// Answers of instructions that a page may ask for again.
    pub answers: Arc<instructions::Answers>,
    /// Attempts to sign in, by address.
    pub attempts: Arc<attempts::Attempts>,
    /// Link of the first administrator.
    pub first: Arc<first::First>,
    /// Unused paths of live streams.
    pub capabilities: Arc<view::capabilities::Capabilities>,
    /// Turns of passwords that are being checked: one at a time, so that a class that signs in takes one core at most.
    pub turns: Arc<tokio::sync::Semaphore>,
    /// Turns of replays: one at a time.
    pub replays: Arc<tokio::sync::Semaphore>,
}

impl App {
    /// Data for a new console of a server.
    pub fn new(house: Arc<dyn House>) -> Self {
        Self {
            hub: hub::Hub::start(&house),
            house,
            sessions: Arc::default(),
            answers: Arc::default(),
            attempts: Arc::default(),
            first: Arc::default(),
            capabilities: Arc::default(),
            turns: Arc::new(tokio::sync::Semaphore::new(1)),
            replays: Arc::new(tokio::sync::Semaphore::new(1)),
        }
    }

    /// Runs work of many milliseconds beside the requests, one at a time.
    ///
    /// # Errors
    /// The error of the work, or the server is ending.
    pub(crate) async fn slow<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, String> + Send + 'static,
    ) -> Result<T, String> {
        let ending = || "the server is ending".to_owned();
        let _turn = self.turns.acquire().await.map_err(|_| ending())?;
        let done = tokio::task::spawn_blocking(work).await;
        done.map_err(|_| ending())?
    }
}
