//! Pictures of findings on a session's page: one PNG for each instant, with its sentence.

use super::data_uri;
use super::instants::Instant;
use super::jaw::Numbering;

/// Picture of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Instant that is shown.
    pub instant: Instant,
    /// Time in the session, seconds.
    pub at_s: u32,
    /// PNG file.
    pub png: Vec<u8>,
}

/// Pictures of a session's findings. No grade depends on them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pictures {
    /// The worst finding first; empty if no finding cost points.
    Drawn(Vec<Picture>),
    /// Reason why there are none, one sentence without its full stop.
    Missing(String),
}

/// Pictures, as the template `student/pictures.html` takes them.
pub struct Shown<'a> {
    /// Pictures.
    pub all: Vec<ShownPicture>,
    /// Reason why there are none.
    pub missing: Option<&'a str>,
}

/// Picture of a page.
pub struct ShownPicture {
    /// PNG file as a URI.
    pub uri: String,
    /// Sentence below the picture, and the text in its place.
    pub caption: String,
    /// Time in the session, minutes and seconds.
    pub time: String,
}

impl<'a> Shown<'a> {
    /// Pictures of a page with this numbering of teeth.
    pub fn of(pictures: &'a Pictures, numbering: Numbering) -> Self {
        let shown = |picture: &Picture| ShownPicture {
            uri: data_uri::png(&picture.png),
            caption: picture.instant.words(&numbering.of(picture.instant.tooth)),
            time: format!("{}:{:02}", picture.at_s / 60, picture.at_s % 60),
        };
        match pictures {
            Pictures::Drawn(all) => Self {
                all: all.iter().map(shown).collect(),
                missing: None,
            },
            Pictures::Missing(why) => Self {
                all: Vec::new(),
                missing: Some(why),
            },
        }
    }
}
