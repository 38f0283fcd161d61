//! Pages for people: a session's report with its periodontal chart on one sheet of A4, and a class. Self-contained (inline SVG
//! and CSS, no scripts, no network); what colour says, line, hatching and words say too, so that a grey print reads as well.

mod chart;
mod class;
mod jaw;
mod plots;
mod student;
mod style;
mod tooth;
mod trend;

pub use class::class_page;
pub use jaw::Numbering;
pub use student::student_page;

use crate::grade::names::Names;

/// How pages look.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// The key table; none: ids only.
    pub names: Option<&'a Names>,
    /// How teeth are numbered.
    pub numbering: Numbering,
    /// Whether what is prescribed is shown.
    pub truth: bool,
}

impl Look<'_> {
    /// What a learner is called.
    fn learner(&self, id: &str) -> String {
        match self.names {
            Some(names) => escaped(&names.label(id)),
            None if id.is_empty() => "(no id)".into(),
            None => escaped(id),
        }
    }
}

/// Text in a page: what a recording says may be anything.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            c if c.is_control() => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

/// A moment as a date and a time of day, UTC.
pub(super) fn date(unix_ns: u64) -> String {
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

/// The whole of a page.
fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{}</style></head>\n<body><main>\n{body}</main></body></html>\n",
        style::STYLE
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_a_calendar() {
        for (seconds, said) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_790_000_000, "2026-09-21 14:13 UTC"),
            (4_107_542_399, "2100-02-28 23:59 UTC"),
        ] {
            assert_eq!(date(seconds * 1_000_000_000), said);
        }
    }

    #[test]
    fn what_a_recording_says_is_no_markup() {
        assert_eq!(
            escaped("<script>'a' & \"b\"\u{7}"),
            "&lt;script&gt;&#39;a&#39; &amp; &quot;b&quot;\u{fffd}"
        );
    }
}
