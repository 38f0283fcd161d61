//! Connection of a display to its station, kept up until it is dropped.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use quinn::{Connection, Endpoint, RecvStream, SendStream};
use sulcus_proto::control::Show;
use sulcus_proto::{ClientMessage, CodecError, Role, ServerMessage};
use tokio::sync::watch;

use super::{Cache, Feed, FeedEnd, FeedStats, Picture, receive};
use crate::link::{LAST_PACKETS, LinkConfig, LinkError, control, handshake, reach};

/// Wait before another attempt to connect.
const AGAIN: Duration = Duration::from_millis(500);

/// A display's connection. A lost connection is made again, until the value is dropped.
pub struct DisplayLink {
    feeds: Receiver<Feed>,
    feed: Option<Feed>,
    /// Newest error, while there is no connection.
    trouble: Arc<Mutex<Option<String>>>,
    stop: watch::Sender<bool>,
    thread: Option<JoinHandle<()>>,
}

impl DisplayLink {
    /// Begins to connect as a display with the ticket of a student's link, on a thread of its own.
    ///
    /// # Errors
    /// The system has no thread or no runtime.
    pub fn begin(config: &LinkConfig, cache: Option<Cache>) -> Result<Self, LinkError> {
        let config = LinkConfig {
            role: Role::Display,
            ..config.clone()
        };
        let (feeds_in, feeds) = channel();
        let (stop, stopped) = watch::channel(false);
        let trouble = Arc::new(Mutex::new(None));
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let told = trouble.clone();
        let thread = std::thread::Builder::new()
            .name("sulcus-display".into())
            .spawn(move || {
                runtime.block_on(keep(config, cache, stopped, &mut |now| match now {
                    Now::Feed(feed) => {
                        *told.lock().unwrap_or_else(PoisonError::into_inner) = None;
                        // The owner takes the next feed with its next picture.
                        let _ = feeds_in.send(*feed);
                    }
                    Now::Trouble(text) => {
                        *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(text);
                    }
                }));
            })?;
        Ok(Self {
            feeds,
            feed: None,
            trouble,
            stop,
            thread: Some(thread),
        })
    }

    /// Newest picture so far; `None` before the first scene. The call waits for nothing.
    pub fn newest(&mut self) -> Option<&Picture> {
        match self.feeds.try_recv() {
            Ok(feed) => self.feed = Some(feed),
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => {}
        }
        self.feed.as_mut()?.newest()
    }

    /// Counts of the present feed.
    pub fn stats(&self) -> FeedStats {
        self.feed.as_ref().map(Feed::stats).unwrap_or_default()
    }

    /// Sentence about the missing connection; `None` while connected and before the first attempt has ended.
    pub fn trouble(&self) -> Option<String> {
        self.trouble
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

impl Drop for DisplayLink {
    fn drop(&mut self) {
        let _ = self.stop.send(true);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// News of the connection.
enum Now {
    Feed(Box<Feed>),
    Trouble(String),
}

/// Connects again and again until `stop` is true.
async fn keep(
    config: LinkConfig,
    cache: Option<Cache>,
    mut stop: watch::Receiver<bool>,
    tell: &mut dyn FnMut(Now),
) {
    while !*stop.borrow() {
        let shown = tokio::select! {
            shown = show(&config, cache.as_ref()) => shown,
            _ = stop.changed() => return,
        };
        let (endpoint, connection, _send, _recv) = match shown {
            Ok(parts) => parts,
            Err(error) => {
                tell(Now::Trouble(error.to_string()));
                tokio::select! {
                    () = tokio::time::sleep(AGAIN) => continue,
                    _ = stop.changed() => return,
                }
            }
        };
        let (feed, reading) = receive(connection.clone(), cache.clone());
        tell(Now::Feed(Box::new(feed)));
        tokio::select! {
            end = reading => match end {
                // The damaged file is gone from the cache: the next connection asks for the whole scene.
                FeedEnd::Missing(_) => {}
                end => tell(Now::Trouble(end.to_string())),
            },
            _ = stop.changed() => {}
        }
        connection.close(0u32.into(), b"bye");
        // Without this wait the close is never sent, and the server keeps the connection until its timeout.
        let _ = tokio::time::timeout(LAST_PACKETS, endpoint.wait_idle()).await;
        tokio::select! {
            () = tokio::time::sleep(AGAIN) => {}
            _ = stop.changed() => {}
        }
    }
}

type Shown = (Endpoint, Connection, SendStream, RecvStream);

/// Connects, and subscribes to the shapes of the station.
async fn show(config: &LinkConfig, cache: Option<&Cache>) -> Result<Shown, LinkError> {
    let (endpoint, connection) = reach::reach(config).await?;
    let server = connection.remote_address();
    let lost = |error: quinn::ConnectionError| LinkError::Lost(error.to_string());
    let greeting = async {
        let (mut send, mut recv) = connection.open_bi().await.map_err(lost)?;
        control::write(&mut send, &handshake::client_hello(config, Duration::ZERO)).await?;
        match sulcus_link::control::read(&mut recv).await? {
            ServerMessage::Welcome(_) => {
                let known = cache.map(Cache::known).unwrap_or_default();
                control::write(&mut send, &ClientMessage::Show(Show { known })).await?;
                Ok((send, recv))
            }
            ServerMessage::Refused(refused) => Err(handshake::turned_away(refused)),
            _ => Err(CodecError::NotCanonical("the first message is no welcome").into()),
        }
    };
    let greeted = tokio::time::timeout(config.timeout, greeting).await;
    let (send, recv) = greeted.map_err(|_| LinkError::Absent { server })??;
    Ok((endpoint, connection, send, recv))
}
