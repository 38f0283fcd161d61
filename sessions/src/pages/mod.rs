//! HTML pages for people: one session with its periodontal chart on a sheet of A4, and a class.
//!
//! A page is self-contained: inline SVG and CSS, no scripts, no network. Line, hatching and words repeat the meaning of
//! every colour for prints in grey.
//!
//! The words and the structure of the pages are in `templates`. View structs hold the facts of a template, numbers and
//! texts. Drawings are built as `svg::Svg`. All text is escaped by `markup::PageText`, in templates and drawings.

mod chart;
mod class;
mod data_uri;
mod filters;
pub mod instants;
mod jaw;
mod markup;
pub mod moments;
mod pictured;
mod plots;
#[cfg(test)]
mod sample;
mod student;
mod svg;
#[cfg(test)]
mod tests;
mod tooth;
mod trend;

pub use class::class_page;
pub use jaw::Numbering;
pub use pictured::{Picture, Pictures};
pub use student::student_page;

use askama::Template;

use crate::grade::names::Names;

/// Presentation of pages.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Key table. None: ids only.
    pub names: Option<&'a Names>,
    /// Numbering of teeth.
    pub numbering: Numbering,
    /// Whether prescribed values are shown.
    pub truth: bool,
}

impl Look<'_> {
    /// Label of a learner.
    fn learner(&self, id: &str) -> String {
        match self.names {
            Some(names) => names.label(id),
            None if id.is_empty() => "(no id)".into(),
            None => id.to_owned(),
        }
    }
}

/// Text of a page.
///
/// # Panics
/// Never: a `String` takes any text, and the filters have no errors.
fn rendered(page: &impl Template) -> String {
    page.render().expect("templates and filters without errors")
}

/// A moment as a date and a time of day, UTC.
pub fn date(unix_ns: u64) -> String {
    let seconds = unix_ns / 1_000_000_000;
    let (days, day) = (seconds / 86_400, seconds % 86_400);
    // Days since 1 March of the year 0 (Howard Hinnant, "chrono-compatible low-level date algorithms").
    let z = days + 719_468;
    let (era, of_era) = (z / 146_097, z % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    format!(
        "{year:04}-{month:02}-{of_month:02} {:02}:{:02} UTC",
        day / 3600,
        day % 3600 / 60
    )
}
