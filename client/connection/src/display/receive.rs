//! Reading of the feed's streams.

use std::sync::{Arc, Mutex, PoisonError};

use quinn::{Connection, ConnectionError, ReadError, ReadExactError, ReadToEndError, RecvStream};
use sulcus_proto::CodecError;
use sulcus_proto::display::stream::{self, Content};
use sulcus_proto::display::{DisplayFrame, DisplayScene, SceneHash};
use tokio::task::JoinSet;
use triple_buffer::{Input, triple_buffer};

use super::{Cache, Feed, FeedStats, Picture};

/// Reason for the end of a feed.
#[derive(Debug, thiserror::Error)]
pub enum FeedEnd {
    /// The connection ended; the text is QUIC's.
    #[error("the display's connection ended: {0}")]
    Closed(ConnectionError),
    /// The server relies on a cached scene that is gone. A new connection that does not list the hash gets the scene.
    #[error("the cached scene {0} is gone; connect again")]
    Missing(SceneHash),
    /// The server sent a scene that this program cannot show.
    #[error("the server sent an invalid scene: {0}")]
    Scene(CodecError),
}

/// Content of a whole stream.
enum Got {
    Scene(SceneHash, Option<Vec<u8>>),
    Frame(DisplayFrame),
    /// The server reset the stream.
    Reset,
    Malformed,
}

/// Receives a feed on a connection. Returns the window's end, and the future that reads until the connection ends.
/// `cache` is the one whose hashes the client's hello has listed.
pub fn receive(
    connection: Connection,
    cache: Option<Cache>,
) -> (Feed, impl Future<Output = FeedEnd> + Send) {
    let (pictures_in, pictures) = triple_buffer(&None);
    let stats = Arc::new(Mutex::new(FeedStats::default()));
    let feed = Feed {
        pictures,
        stats: stats.clone(),
    };
    let receiver = Receiver {
        cache,
        pictures: pictures_in,
        stats,
        present: None,
    };
    (feed, receiver.run(connection))
}

struct Receiver {
    cache: Option<Cache>,
    pictures: Input<Option<Picture>>,
    stats: Arc<Mutex<FeedStats>>,
    present: Option<(SceneHash, Arc<DisplayScene>)>,
}

impl Receiver {
    async fn run(mut self, connection: Connection) -> FeedEnd {
        // QUIC's limit of streams bounds the number of tasks.
        let mut streams = JoinSet::new();
        loop {
            let got = tokio::select! {
                stream = connection.accept_uni() => match stream {
                    Ok(stream) => {
                        streams.spawn(read(stream));
                        continue;
                    }
                    Err(error) => return FeedEnd::Closed(error),
                },
                Some(got) = streams.join_next() => got.unwrap_or(Got::Malformed),
            };
            match got {
                Got::Frame(frame) => self.frame(frame),
                Got::Scene(hash, bytes) => {
                    if let Err(end) = self.scene(hash, bytes) {
                        return end;
                    }
                }
                Got::Reset => self.count(|stats| stats.reset += 1),
                Got::Malformed => self.count(|stats| stats.malformed += 1),
            }
        }
    }

    fn count<T>(&self, count: impl FnOnce(&mut FeedStats) -> T) -> T {
        count(&mut self.stats.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Takes a scene, from the stream or from the cache.
    fn scene(&mut self, hash: SceneHash, sent: Option<Vec<u8>>) -> Result<(), FeedEnd> {
        let is_cached = sent.is_none();
        let bytes = sent.or_else(|| self.cache.as_ref()?.load(&hash));
        let bytes = bytes.ok_or(FeedEnd::Missing(hash))?;
        let scene = Arc::new(DisplayScene::from_bytes(&bytes).map_err(FeedEnd::Scene)?);
        self.count(|stats| {
            stats.scenes_cached += u64::from(is_cached);
            stats.scenes += u64::from(!is_cached);
        });
        self.present = Some((hash, scene.clone()));
        self.pictures.write(Some(Picture {
            hash,
            scene,
            frame: None,
        }));
        if let Some(cache) = self.cache.clone().filter(|_| !is_cached) {
            // Without a cache the server sends the scene again next time.
            tokio::task::spawn_blocking(move || {
                if let Err(error) = cache.store(&bytes) {
                    tracing::warn!("the scene of the display cannot be cached: {error}");
                }
            });
        }
        Ok(())
    }

    fn frame(&mut self, frame: DisplayFrame) {
        let is_newest = self.count(|stats| stats.arrived(frame.sequence));
        let present = self.present.as_ref();
        let own = present.filter(|(hash, scene)| hash.short() == frame.scene && frame.fits(scene));
        let Some((hash, scene)) = own else {
            return self.count(|stats| stats.foreign += 1);
        };
        if is_newest {
            let picture = Picture {
                hash: *hash,
                scene: scene.clone(),
                frame: Some(frame),
            };
            self.pictures.write(Some(picture));
        }
    }
}

/// Reads one stream to its end.
async fn read(mut stream: RecvStream) -> Got {
    let mut head = [0; stream::HEAD];
    match stream.read_exact(&mut head).await {
        Ok(()) => {}
        Err(ReadExactError::ReadError(ReadError::Reset(_))) => return Got::Reset,
        Err(_) => return Got::Malformed,
    }
    let Ok(content) = stream::content(head) else {
        return Got::Malformed;
    };
    let bytes = match stream.read_to_end(content.limit()).await {
        Ok(bytes) => bytes,
        Err(ReadToEndError::Read(ReadError::Reset(_))) => return Got::Reset,
        Err(_) => return Got::Malformed,
    };
    let got = match content {
        Content::Frame => DisplayFrame::from_bytes(&bytes).map(Got::Frame),
        Content::Scene => {
            stream::scene(&bytes).map(|(hash, scene)| Got::Scene(hash, scene.map(<[u8]>::to_vec)))
        }
    };
    got.unwrap_or(Got::Malformed)
}
