//! Messages of an instructor to the student's program.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use sulcus_core::{MAX_TOOLS, Vec3};
use sulcus_haptics::drawn;
use sulcus_haptics::guide::{Guide, GuideParams, Moment};
use sulcus_program::tell;
use sulcus_proto::control::Say;
use sulcus_proto::ghost::{self, Gathered, Gathering, GhostPart};

use super::LinkError;
use sulcus_core::RawPose;
use sulcus_proto::CodecError;

/// Number of messages that wait for the device's loop. A loop that takes none loses the next ones.
const WAITING: usize = 16;

/// Message of an instructor.
#[derive(Debug)]
pub enum Heard {
    /// Text for the screen, without control characters.
    Text(String),
    /// Ghost beside the hands, without a force; `None` ends the ghost.
    Ghost(Option<Box<Guide>>),
}

/// Link's end of the messages.
pub(super) struct Ear {
    to_loop: SyncSender<Heard>,
    gathering: Gathering,
}

impl Ear {
    pub fn new() -> (Self, Receiver<Heard>) {
        let (to_loop, heard) = sync_channel(WAITING);
        let gathering = Gathering::default();
        (Self { to_loop, gathering }, heard)
    }

    /// Takes a text: the terminal and the screen show it.
    pub fn say(&self, say: &Say) {
        let text = printable(&say.text);
        tell!("message of the instructor: {text}");
        self.pass(Heard::Text(text));
    }

    /// Takes a part of a ghost's path.
    ///
    /// # Errors
    /// The part does not follow the part before.
    pub fn ghost(&mut self, part: &GhostPart) -> Result<(), LinkError> {
        let gathered = self.gathering.take(part);
        match gathered.map_err(|why| LinkError::Protocol(CodecError::NotCanonical(why)))? {
            Gathered::Begun => {}
            Gathered::Whole(path) => self.pass(Heard::Ghost(guide(&path, part))),
        }
        Ok(())
    }

    fn pass(&self, heard: Heard) {
        // The loop of a session that is ending takes no more messages.
        let _ = self.to_loop.try_send(heard);
    }
}

/// Ghost along a path; `None` for an empty one.
fn guide(path: &[ghost::Moment], part: &GhostPart) -> Option<Box<Guide>> {
    if path.is_empty() {
        return None;
    }
    let pose = |pose: &sulcus_proto::datagram::WirePose| {
        drawn(&RawPose {
            position: pose.position,
            orientation: pose.orientation,
        })
    };
    let moment = |moment: &ghost::Moment| -> Moment {
        std::array::from_fn(|t| moment.get(t)?.as_ref().and_then(pose))
    };
    let path: Vec<Moment> = path.iter().map(moment).collect();
    let tips: [Vec3; MAX_TOOLS] = std::array::from_fn(|t| {
        let tip = part.tips.get(t).copied().unwrap_or_default();
        Vec3::from(tip.map(f64::from))
    });
    // A ghost of the server is seen and never felt.
    let params = GuideParams {
        most_n: 0.0,
        ..GuideParams::default()
    };
    let period_s = ghost::PERIOD_NS as f64 / 1e9;
    Some(Box::new(Guide::new(params, path, period_s, tips)))
}

/// Text of a peer without control characters.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}
