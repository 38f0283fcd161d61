//! Recording of a session: queue, rows, replay, gaps. Invariants 11 and 12.

use super::Found;
use super::bounds::Bounds;

/// Judges the length of the recorder's queue, entries.
pub(super) fn queue(bounds: &Bounds, recorder: usize, found: &mut Found) {
    found.must(recorder <= bounds.facts.queue_rows, 11, || {
        format!(
            "{recorder} entries wait for the recorder; at most {}",
            bounds.facts.queue_rows
        )
    });
}

/// End of the session as the server stated it.
struct Stated {
    ticks: u64,
    rows_dropped: u64,
    error: Option<String>,
}

/// Content that the recording must have.
///
/// A gap begins with the first tick without the student, and ends with the first tick with the student. A gap without
/// such an end may or may not count; the contract says nothing of it.
#[derive(Default)]
pub(super) struct Recording {
    is_gone: bool,
    /// Whether the present absence has had a tick.
    is_marked: bool,
    /// Whether a gap has no end yet.
    is_open: bool,
    /// Number of gaps with an end.
    gaps_least: u64,
    /// Number of all absences in which ticks ran.
    gaps_most: u64,
    stated: Option<Stated>,
}

impl Recording {
    /// Takes the begin of an epoch.
    pub(super) fn attach(&mut self) {
        self.is_gone = false;
    }

    /// Takes the loss of a connection.
    pub(super) fn detach(&mut self) {
        if !self.is_gone {
            (self.is_gone, self.is_marked) = (true, false);
        }
    }

    /// Takes a tick.
    pub(super) fn tick(&mut self) {
        if self.is_gone && !self.is_marked {
            self.gaps_most += 1;
            (self.is_marked, self.is_open) = (true, true);
        }
        if !self.is_gone && self.is_open {
            self.gaps_least += 1;
            self.is_open = false;
        }
    }

    /// Takes the statement of the server at the end.
    pub(super) fn finish(&mut self, ticks: u64, rows_dropped: u64, error: Option<&str>) {
        let error = error.map(str::to_string);
        self.stated = Some(Stated {
            ticks,
            rows_dropped,
            error,
        });
    }

    /// Judges a replay of the recording. A replay without an end of the session is judged by `End`.
    ///
    /// A failed recorder leaves a readable file up to the failure: fewer rows and gaps, but equal ones.
    pub(super) fn replay(
        &self,
        rows: u64,
        is_equal: bool,
        is_whole: bool,
        gaps: u64,
        found: &mut Found,
    ) {
        let Some(stated) = &self.stated else { return };
        let (dropped, error) = (stated.rows_dropped, &stated.error);
        let expected = stated.ticks.checked_sub(dropped);
        let are_counted =
            expected.is_some_and(|expected| rows == expected || error.is_some() && rows < expected);
        found.must(are_counted, 11, || {
            format!(
                "{rows} rows of {} ticks, {dropped} dropped, error {error:?}",
                stated.ticks
            )
        });
        found.must(is_equal || dropped > 0, 12, || {
            format!("the replay differs; no row dropped, error {error:?}")
        });
        let is_complete = dropped == 0 && error.is_none();
        found.must(is_whole || !is_complete, 12, || {
            "the recording is not whole; no row dropped, no error".to_string()
        });
        let least = if is_complete { self.gaps_least } else { 0 };
        found.must((least..=self.gaps_most).contains(&gaps), 12, || {
            format!(
                "the recording names {gaps} gaps; seen: {least} to {}",
                self.gaps_most
            )
        });
    }
}
