//! Motion of the tools, live, for the console.
//!
//! A station's feed is read from outside of its threads: the newest state waits in one place, and nobody waits for a
//! reader. Streams for the viewer are drawn by a child process, one for each watched session, so that a fault of the
//! viewer's library touches no station.

mod drawing;
mod outline;
pub(super) mod still;
mod viewer;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use sulcus_console::house::{Feeds, Glance, Live, Outlines, SiteDepth, Viewer};
use sulcus_proto::station::Phase;
use sulcus_sessions::cli::sibling::{BUILDS_REVIEW, find};

use crate::outlets::feed::Latest;
use crate::station::door::Door;
use drawing::{Drawing, Source};

/// Program that draws and holds the viewer's files.
const PROGRAM: &str = "sulcus-review";

/// Motion of the tools, live, of a running server.
pub(super) struct OwnFeeds {
    doors: Vec<Door>,
    /// Running programs, by station.
    drawings: Mutex<BTreeMap<Arc<str>, Drawing>>,
    viewer: Mutex<Option<Arc<Viewer>>>,
}

impl OwnFeeds {
    pub fn new(doors: &[Door]) -> Self {
        Self {
            doors: doors.to_vec(),
            drawings: Mutex::default(),
            viewer: Mutex::default(),
        }
    }

    fn door(&self, station: &str) -> Option<&Door> {
        self.doors.iter().find(|door| *door.name == *station)
    }

    /// Newest state of a station whose session can be watched. A feed keeps the last scene after the end of a session.
    fn latest(&self, station: &str) -> Option<Latest> {
        let door = self.door(station)?;
        is_watchable(door.status().phase).then(|| door.feed().borrow().clone())
    }
}

/// Path of the program.
pub(super) fn program() -> Result<PathBuf, String> {
    find(PROGRAM, BUILDS_REVIEW).map_err(|error| {
        format!("no view in three dimensions: {error}; the flat view needs no program")
    })
}

/// Whether a station has a session that can be watched.
fn is_watchable(phase: Phase) -> bool {
    matches!(phase, Phase::Running | Phase::Waiting)
}

impl Feeds for OwnFeeds {
    fn glance(&self, station: &str) -> Option<Glance> {
        self.door(station)?;
        let latest = self.latest(station);
        Some(latest.map_or_else(Glance::default, |latest| Glance {
            begun: latest.begun,
            hands: latest.hands,
        }))
    }

    fn outlines(&self, station: &str) -> Option<Outlines> {
        let latest = self.latest(station)?;
        Some(outline::of(latest.display?.scene(), latest.begun))
    }

    fn depths(&self, station: &str) -> Vec<SiteDepth> {
        let depths = self.latest(station).map(|latest| latest.depths);
        let depths = depths.iter().flat_map(|depths| depths.iter());
        depths
            .map(|depth| SiteDepth {
                tooth: depth.tooth,
                site: depth.site.name(),
                depth_mm: depth.depth_mm,
            })
            .collect()
    }

    fn live(&self, station: &str) -> Result<Live, String> {
        let door = self
            .door(station)
            .ok_or("this sign-in has no such station")?;
        let Latest { display, begun, .. } = self.latest(station).unwrap_or_default();
        let display = display.ok_or_else(|| format!("no session runs at {station}"))?;
        let mut drawings = self.drawings.lock().unwrap_or_else(PoisonError::into_inner);
        drawings.retain(|_, drawing| !drawing.is_over());
        let running = drawings.get(station);
        if let Some(live) = running
            .filter(|drawing| drawing.begun() == begun)
            .and_then(Drawing::watch)
        {
            return Ok(live);
        }
        let (feed, status) = (door.feed(), door.statuses());
        let source = Source {
            begun,
            scene: display.bytes().clone(),
            newest: Box::new(move || {
                // An error means that the station is gone.
                let is_there = feed.has_changed().is_ok() && is_watchable(status.borrow().phase);
                let latest = feed.borrow();
                (is_there && latest.begun == begun).then_some(latest.hands)
            }),
        };
        let drawing = Drawing::start(&program()?, door.name.clone(), source)?;
        let live = drawing.watch().ok_or("the live view has ended at once")?;
        drawings.insert(door.name.clone(), drawing);
        Ok(live)
    }

    fn viewer(&self) -> Result<Arc<Viewer>, String> {
        let mut kept = self.viewer.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(viewer) = &*kept {
            return Ok(viewer.clone());
        }
        let viewer = Arc::new(viewer::read(&program()?)?);
        *kept = Some(viewer.clone());
        Ok(viewer)
    }
}
