//! Contents of the panel, as plain data.

use super::trace::Trace;
use crate::handed::Person;
use crate::readings::{Draft, Entry, Field, Readings, Stop, Wrong};

/// Least force of a contact, newtons. A gauge calls a smaller force "no contact". Chosen: a tenth of the lightest force
/// that is taught.
pub const CONTACT_N: f64 = 0.01;

/// Purpose of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Practice: all helps are shown.
    Practice,
    /// Exam or assessment: no more is shown than a clinic would.
    #[default]
    Exam,
}

impl Mode {
    /// Mode of a station's word. Any word other than `practice` hides the helps.
    pub fn of(word: &str) -> Self {
        if word == "practice" {
            Self::Practice
        } else {
            Self::Exam
        }
    }
}

/// Contents of the panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelState {
    /// Purpose of the session.
    pub mode: Mode,
    /// Time.
    pub clock: Clock,
    /// Site to be read, and the findings of the student.
    pub tour: Option<Tour>,
    /// Link, recording, pause, limit and warnings.
    pub status: Status,
    /// Helps of practice.
    pub help: Help,
}

/// Time of a session, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Time since the start.
    pub elapsed_s: f64,
    /// Length of the session; `None` without an end.
    pub length_s: Option<f64>,
}

/// State of a tour.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tour {
    /// Present site, to be read; `None` at the end.
    pub stop: Option<Stop>,
    /// Site after the present one.
    pub following: Option<Stop>,
    /// Number of the site from 0 on.
    pub number: usize,
    /// Number of all sites.
    pub count: usize,
    /// Findings that are being typed.
    pub draft: Draft,
    /// Finding that takes the next digit.
    pub field: Field,
    /// Reason why the last key changed nothing.
    pub wrong: Option<Wrong>,
    /// Confirmed findings, in the order of confirmation.
    pub entries: Vec<Entry>,
}

impl Tour {
    /// State of `readings`. `wrong` is the answer to the last key.
    pub fn of(readings: &Readings, wrong: Option<Wrong>) -> Self {
        let (number, count) = readings.progress();
        Self {
            stop: readings.stop(),
            following: readings.following(),
            number,
            count,
            draft: readings.draft(),
            field: readings.field(),
            wrong,
            entries: readings.entries().copied().collect(),
        }
    }
}

/// Link to the server.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Link {
    /// The link is up; its delay in milliseconds, if known.
    Up(Option<u16>),
    /// The link is being restored.
    Returning,
    /// There is no link.
    #[default]
    Lost,
}

/// Recording of the session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Recording {
    /// The session is recorded.
    On,
    /// The session is not recorded.
    #[default]
    Off,
    /// The recording has failed.
    Failed,
}

/// Warning about the station.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Warning {
    /// The device, by its name, displays no force.
    NoForce(String),
    /// Pictures are late.
    SlowPicture,
    /// Any other warning, in the language of its author.
    Other(String),
}

/// State that the panel always shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// Link to the server.
    pub link: Link,
    /// Recording of the session.
    pub recording: Recording,
    /// Whether the student has paused.
    pub paused_by_student: bool,
    /// Whether the station's side has paused.
    pub paused_by_station: bool,
    /// Force limit of both sides, newtons; `None` for the scene's limit.
    pub force_limit_n: Option<f64>,
    /// Settings of the person; `None` without any.
    pub person: Option<Person>,
    /// Newest message of an instructor; `None` some time after it came.
    pub message: Option<String>,
    /// Warnings, most important first.
    pub warnings: Vec<Warning>,
}

impl Status {
    /// Whether either side has paused.
    pub fn is_paused(&self) -> bool {
        self.paused_by_student || self.paused_by_station
    }
}

/// Detail of the picture, from the best to the cheapest, as the governor of the frame time sets it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Full detail, worth no word.
    #[default]
    Full,
    /// Smaller shadows, no smoothed edges.
    Plain,
    /// Light for each vertex, no shadows.
    Low,
    /// Light for each vertex of coarser meshes.
    Lowest,
}

/// Helps of practice. An exam shows none of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Help {
    /// Title of the exercise.
    pub title: String,
    /// Task of the exercise.
    pub task: String,
    /// Forces by tool.
    pub tools: Vec<ToolForce>,
    /// Depth of the tip below the gingival margin, millimetres; `None` outside of pockets.
    pub depth_mm: Option<f64>,
    /// Detail of the picture.
    pub detail: Detail,
}

/// Force of a tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolForce {
    /// Name of the tool.
    pub name: String,
    /// Force, newtons.
    pub force_n: f64,
    /// Least and greatest force of the exercise, newtons; `None` if nothing is prescribed.
    pub zone_n: Option<[f64; 2]>,
    /// Last values of the force.
    pub trace: Trace,
}

/// Rating of a force against its zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rating {
    /// The tool touches nothing.
    NoContact,
    /// Below the zone.
    Light,
    /// In the zone.
    Right,
    /// Above the zone.
    Heavy,
}

impl ToolForce {
    /// Rating of the force; `None` without a zone. Both ends of the zone are right. A force that is not a number counts
    /// as none.
    pub fn rating(&self) -> Option<Rating> {
        let [low, high] = self.zone_n?;
        Some(if self.force_n > high {
            Rating::Heavy
        } else if self.force_n >= low {
            Rating::Right
        } else if self.force_n >= CONTACT_N {
            Rating::Light
        } else {
            Rating::NoContact
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_the_zone_are_right() {
        let rating = |force_n| {
            let zone_n = Some([0.2, 0.25]);
            let tool = ToolForce {
                force_n,
                zone_n,
                ..ToolForce::default()
            };
            tool.rating()
        };
        let expected = [
            (0.0, Rating::NoContact),
            (0.0099, Rating::NoContact),
            (0.01, Rating::Light),
            (0.2, Rating::Right),
            (0.25, Rating::Right),
            (0.2501, Rating::Heavy),
            (f64::NAN, Rating::NoContact),
            (f64::INFINITY, Rating::Heavy),
        ];
        for (force_n, right) in expected {
            assert_eq!(rating(force_n), Some(right), "{force_n}");
        }
        assert_eq!(ToolForce::default().rating(), None);
    }

    #[test]
    fn an_unknown_word_for_the_mode_hides_the_helps() {
        assert_eq!(Mode::of("practice"), Mode::Practice);
        for word in ["exam", "assessment", "", "Practice "] {
            assert_eq!(Mode::of(word), Mode::Exam, "{word}");
        }
    }
}
