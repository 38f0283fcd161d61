//! The feed for displays: encodes each frame once and offers the newest one to all displays of a station.
//!
//! The newest frame waits in one place, a `watch` channel. A display takes it when it can. A display that does not read
//! skips frames and delays nobody: publishing never waits, and holds one frame however many displays there are.

use std::sync::Arc;

use sulcus_core::{Scene, TickOutput};
use sulcus_display::{Display, Frames};
use sulcus_proto::display::DisplayFrame;
use sulcus_proto::live::Hands;
use sulcus_sessions::{Moved, Occurrence};
use tokio::sync::watch;

use super::hands::{TrueDepth, depths};

/// Encoded frame.
#[derive(Clone, Debug)]
pub struct EncodedFrame {
    /// Number of the frame in the station's feed, from 1.
    pub sequence: u64,
    /// The frame, encoded.
    pub bytes: Arc<[u8]>,
}

/// Newest state of a station's feed.
#[derive(Clone, Default)]
pub struct Latest {
    /// Scene to show; `None` before the first plan.
    pub display: Option<Arc<Display>>,
    /// Newest frame of that scene; `None` before its first tick.
    pub frame: Option<EncodedFrame>,
    /// Number of scenes that have begun; each session begins one.
    pub begun: u64,
    /// State of the tools after the newest frame, for instructors alone; `None` before the first tick.
    pub hands: Option<Hands>,
    /// Depths of all sites by the scene, for instructors alone.
    pub depths: Arc<[TrueDepth]>,
}

/// Reader's end of a station's feed; one for each display.
pub type Feed = watch::Receiver<Latest>;

/// Writer's end of a station's feed. One for each station; it outlives sessions.
pub struct FeedPublisher {
    latest: watch::Sender<Latest>,
    sequence: u64,
    dropped: u64,
}

impl FeedPublisher {
    /// Creates a feed without a scene, and its first reader. The reader is cloned for each display.
    pub fn new() -> (Self, Feed) {
        let (latest, feed) = watch::channel(Latest::default());
        let publisher = Self {
            latest,
            sequence: 0,
            dropped: 0,
        };
        (publisher, feed)
    }

    /// Begins a scene. Displays show it at rest until its first frame.
    pub fn begin(&mut self, display: Arc<Display>) {
        self.begin_with(display, Arc::default());
    }

    /// The same, with the depths of all sites for instructors.
    fn begin_with(&mut self, display: Arc<Display>, depths: Arc<[TrueDepth]>) {
        let begun = self.latest.borrow().begun + 1;
        self.latest.send_replace(Latest {
            display: Some(display),
            frame: None,
            begun,
            hands: None,
            depths,
        });
    }

    /// Sets the state of the tools after the newest frame. Displays are not woken for it: they never get it.
    pub(crate) fn hands(&mut self, hands: Hands) {
        self.latest.send_if_modified(|latest| {
            latest.hands = Some(hands);
            false
        });
    }

    /// Publishes a frame of the present scene under the next number. A frame that cannot be encoded, and a frame of
    /// another scene, is dropped and counted.
    pub fn publish(&mut self, mut frame: DisplayFrame) {
        self.sequence += 1;
        frame.sequence = self.sequence;
        let Ok(bytes) = frame.to_bytes() else {
            self.dropped += 1;
            return;
        };
        let encoded = EncodedFrame {
            sequence: self.sequence,
            bytes: bytes.into(),
        };
        let mut fits = false;
        self.latest.send_if_modified(|latest| {
            let display = latest.display.as_ref();
            fits = display.is_some_and(|display| display.hash().short() == frame.scene);
            if fits {
                latest.frame = Some(encoded);
            }
            fits
        });
        self.dropped += u64::from(!fits);
    }

    /// Number of frames that were not published.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}

/// Feed of one session: makes the frames and publishes them.
pub struct SessionFeed {
    display: Arc<Display>,
    frames: Frames,
}

impl SessionFeed {
    /// Begins the feed of a session. `display` is that of `scene`.
    pub fn begin(publisher: &mut FeedPublisher, scene: &Scene, display: Arc<Display>) -> Self {
        publisher.begin_with(display.clone(), depths(scene).into());
        Self {
            frames: Frames::new(scene, &display),
            display,
        }
    }

    /// Takes an event of the exercise. Must precede the frame of its tick.
    pub fn occurred(&mut self, event: &Occurrence) {
        self.frames.occurred(event);
    }

    /// Takes a tick, and publishes a frame on due ticks. `moved` has the newest places of the spheres. Returns whether
    /// the tick was due.
    pub fn tick(
        &mut self,
        publisher: &mut FeedPublisher,
        output: &TickOutput,
        paused: bool,
        moved: &Moved,
    ) -> bool {
        let is_due = self.frames.is_due(output.tick);
        if is_due {
            let frame = self.frames.frame(&self.display, output, paused, moved);
            publisher.publish(frame);
        }
        is_due
    }

    /// Number of impossible cases so far; see [`Frames::faults`].
    pub fn faults(&self) -> u64 {
        self.frames.faults()
    }
}
