//! Table of stations for a terminal: one line each, the most urgent first.

use std::collections::VecDeque;

use sulcus_proto::alert::{Alert, Alerts, Urgency, urgency};
use sulcus_proto::station::{Phase, StationEvent, StationStatus};

/// Number of last events and answers below the table.
const LAST: usize = 8;
/// Largest force of the trace, newtons; a line of dots has one more for each step.
const TRACE_N: [f32; 7] = [0.02, 0.1, 0.2, 0.4, 0.7, 1.5, 3.0];
/// Marks of the trace, from no force to the largest.
const MARKS: [char; 8] = ['.', '_', '-', '=', '+', '*', '#', '@'];
/// Length of the trace, statuses.
const TRACE: usize = 12;
/// Longest text of an event in a line, characters.
const EVENT_CHARACTERS: usize = 100;
/// Head of the table.
const HEAD: &str = "station      state    learner      exercise     time   site           force N  last 2 s      depth mm  pose ms";

/// Row of a station.
pub(super) struct Row {
    alerts_over_time: Alerts,
    /// Newest status.
    pub status: StationStatus,
    /// Present alerts.
    pub alerts: Vec<Alert>,
    /// Largest force of each of the last statuses, newtons.
    trace: VecDeque<f32>,
    known: bool,
}

/// Table of all stations.
pub(super) struct Table {
    rows: Vec<Row>,
    last: VecDeque<String>,
}

impl Table {
    pub fn new(stations: &[String]) -> Self {
        let row = |station: &String| Row {
            alerts_over_time: Alerts::default(),
            status: StationStatus {
                station: station.clone(),
                ..StationStatus::default()
            },
            alerts: Vec::new(),
            trace: VecDeque::new(),
            known: false,
        };
        Self {
            rows: stations.iter().map(row).collect(),
            last: VecDeque::new(),
        }
    }

    /// Whether every station has sent a status.
    pub fn is_whole(&self) -> bool {
        self.rows.iter().all(|row| row.known)
    }

    /// Names of the stations without a status.
    pub fn missing(&self) -> Vec<&str> {
        let missing = self.rows.iter().filter(|row| !row.known);
        missing.map(|row| row.status.station.as_str()).collect()
    }

    pub fn row(&self, station: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.status.station == station)
    }

    /// Takes a status.
    pub fn status(&mut self, status: StationStatus, now_ms: u64) {
        let found = self
            .rows
            .iter_mut()
            .find(|row| row.status.station == status.station);
        let Some(row) = found else { return };
        row.alerts = row.alerts_over_time.take(&status, now_ms);
        let peaks = status.tools.iter().map(|tool| tool.peak_force_n);
        row.trace.push_back(peaks.fold(0.0, f32::max));
        if row.trace.len() > TRACE {
            row.trace.pop_front();
        }
        (row.status, row.known) = (status, true);
    }

    /// Adds a line below the table.
    pub fn say(&mut self, line: String) {
        self.last.push_back(line);
        if self.last.len() > LAST {
            self.last.pop_front();
        }
    }

    /// Table, most urgent station first, each alert on a line below its station.
    pub fn lines(&self) -> Vec<String> {
        let mut rows: Vec<&Row> = self.rows.iter().collect();
        // Stable: stations of one urgency keep the order of the server.
        rows.sort_by_key(|row| std::cmp::Reverse(urgency(&row.alerts)));
        let mut lines = vec![HEAD.to_owned()];
        for row in rows {
            lines.push(row.line());
            let alerts = row.alerts.iter().map(|alert| {
                let mark = match alert.urgency {
                    Urgency::Alarm => "!!!",
                    Urgency::Warning => "!!",
                    Urgency::Notice | Urgency::None => "!",
                };
                format!("  {mark:<3} {} ({} s)", alert.text, alert.for_ms / 1000)
            });
            lines.extend(alerts);
        }
        lines
    }

    /// Table with the last events and answers.
    pub fn screen(&self) -> Vec<String> {
        let mut lines = self.lines();
        lines.push(String::new());
        lines.extend(self.last.iter().cloned());
        lines
    }
}

impl Row {
    fn line(&self) -> String {
        let status = &self.status;
        let state = match status.phase {
            _ if status.paused => "PAUSED",
            Phase::Free => "free",
            Phase::Ready => "ready",
            Phase::Running => "runs",
            Phase::Waiting => "WAITING",
            Phase::Ending => "ending",
        };
        let probing = status.tools.iter().find(|tool| tool.tooth != 0);
        let site = probing.map_or_else(String::new, |tool| format!("{} {}", tool.tooth, tool.site));
        let depth = probing.map_or_else(String::new, |tool| {
            format!("{:.1} of {:.1}", tool.depth_mm, tool.true_depth_mm)
        });
        let held = || status.tools.iter().filter(|tool| tool.present);
        let force = held().map(|tool| tool.force_n).fold(0.0, f32::max);
        let age = held()
            .map(|tool| tool.pose_age_ms.to_string())
            .collect::<Vec<_>>()
            .join("/");
        let seconds = status.elapsed_ms / 1000;
        let time = format!("{}:{:02}", seconds / 60, seconds % 60);
        let trace: String = self.trace.iter().map(|force| mark(*force)).collect();
        format!(
            "{:<12} {state:<8} {:<12} {:<12} {time:>5}  {site:<14} {force:>6.2}   {trace:<TRACE$}  {depth:<11} {age:>5}",
            short(&status.station, 12),
            short(&status.learner, 12),
            short(&status.exercise, 12),
        )
    }
}

/// Line about an event. The text cannot move the cursor.
pub(super) fn event(event: &StationEvent, now_ms: u64) -> String {
    let text = event.text.chars().filter(|c| !c.is_control());
    let text: String = text.take(EVENT_CHARACTERS).collect();
    format!("{} s {}: {text}", now_ms / 1000, event.station)
}

/// Text of at most `characters`, without control characters. A text that is cut ends in `~`.
fn short(text: &str, characters: usize) -> String {
    let clean: Vec<char> = text.chars().filter(|c| !c.is_control()).collect();
    if clean.len() <= characters {
        return clean.into_iter().collect();
    }
    clean[..characters - 1].iter().chain(&['~']).collect()
}

/// Mark of a force in the trace.
fn mark(newtons: f32) -> char {
    MARKS[TRACE_N.iter().filter(|step| newtons >= **step).count()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(station: &str) -> StationStatus {
        StationStatus {
            station: station.into(),
            phase: Phase::Running,
            learner: "a7f3".into(),
            exercise: "bimanual".into(),
            elapsed_ms: 83_000,
            disk_free_mib: 90_000,
            ..StationStatus::default()
        }
    }

    #[test]
    fn a_station_with_an_alarm_comes_first_and_says_why() {
        let mut table = Table::new(&["a".into(), "b".into()]);
        assert!(!table.is_whole());
        assert_eq!(table.missing(), ["a", "b"]);
        table.status(status("a"), 0);
        let mut hurt = status("b");
        let tool = &mut hurt.tools[1];
        (tool.present, tool.force_n, tool.peak_force_n) = (true, 0.62, 0.8);
        (tool.tooth, tool.site, tool.peak_zone) = (36, "mesiobuccal".into(), 2);
        (tool.depth_mm, tool.true_depth_mm) = (4.2, 5.0);
        table.status(hurt, 0);
        let lines = table.lines();
        assert!(table.is_whole() && lines.len() == 4, "{lines:#?}");
        assert!(
            lines[1].starts_with(
                "b            runs     a7f3         bimanual      1:23  36 mesiobuccal"
            )
        );
        assert!(
            lines[1].contains("0.62") && lines[1].contains("4.2 of 5.0"),
            "{}",
            lines[1]
        );
        assert!(
            lines[1].contains('*'),
            "the trace holds the peak: {}",
            lines[1]
        );
        assert!(lines[2].contains("!!! trauma") && lines[2].contains("36 mesiobuccal"));
        assert!(lines[3].starts_with("a  "));
        for line in lines {
            assert!(line.chars().count() <= 120, "{line}");
        }
    }

    #[test]
    fn an_event_cannot_move_the_cursor_and_the_list_is_short() {
        let mut table = Table::new(&["a".into()]);
        for tick in 0..20 {
            let text = format!("note at tick {tick}: \u{1b}[2J{}", "x".repeat(500));
            let told = StationEvent {
                station: "a".into(),
                tick,
                text,
            };
            table.say(event(&told, 1000));
        }
        let screen = table.screen();
        assert_eq!(screen.len(), 2 + 1 + LAST);
        assert!(
            screen
                .iter()
                .all(|line| !line.contains('\u{1b}') && line.len() <= 120)
        );
        assert!(screen.last().is_some_and(|line| line.contains("tick 19")));
    }

    #[test]
    fn long_names_are_cut_visibly() {
        assert_eq!(short("abcdefghijkl", 12), "abcdefghijkl");
        assert_eq!(short("abcdefghijklm", 12), "abcdefghijk~");
    }
}
