//! A table of the document, as Markdown.

use std::fmt::Write;

use crate::report::times::Times;

/// Number of ticks from which a 99.9th percentile is given.
const TAIL: usize = 1_000;

/// A table without its title.
pub(super) struct Table {
    /// One sentence: case, reference and quantities.
    pub(super) caption: String,
    /// Command that measures the table again.
    pub(super) command: String,
    /// Names of the columns, with units.
    pub(super) columns: Vec<&'static str>,
    /// Cells, row by row.
    pub(super) rows: Vec<Vec<String>>,
    /// Numbered notes below the table.
    pub(super) notes: Vec<String>,
}

impl Table {
    /// Writes the table with its title.
    pub(super) fn markdown(&self, title: &str) -> String {
        let mut text = format!(
            "### {title}\n\n{}\nCommand: `{}`.\n\n",
            self.caption, self.command
        );
        let _ = writeln!(text, "| {} |", self.columns.join(" | "));
        let _ = writeln!(text, "|{}", "---|".repeat(self.columns.len()));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|cell| in_cell(cell)).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        if !self.notes.is_empty() {
            text.push('\n');
        }
        for (k, note) in self.notes.iter().enumerate() {
            let _ = writeln!(text, "{}. {}", k + 1, note.replace('\n', " "));
        }
        text
    }
}

/// Text without the signs that end a cell.
fn in_cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// A number with three significant digits, or a dash for a number that is not finite.
pub(super) fn number(x: f64) -> String {
    if !x.is_finite() {
        return "–".to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let size = x.abs();
    if size < 1e-4 {
        return format!("{x:.1e}");
    }
    // Rounding may add a digit before the point: 99.96 is 100.
    let magnitude = format!("{size:.2e}");
    let power = magnitude.split_once('e').map_or("0", |(_, power)| power);
    let power: i32 = power.parse().unwrap_or(0);
    let digits = usize::try_from(2 - power).unwrap_or(0);
    format!("{x:.digits$}")
}

/// Median, 99th and 99.9th percentile of a tick, microseconds, with half of the 95 % interval over the runs.
pub(super) fn tick_cells(times: &Times) -> [String; 3] {
    let half = times.tick_us_ci95.as_ref();
    let cell = |value: f64, half: Option<f64>| match half {
        Some(half) => format!("{} ± {}", number(value), number(half)),
        None => number(value),
    };
    let us = &times.tick_us;
    let mut cells = [
        cell(us.p50, half.map(|half| half.p50)),
        cell(us.p99, half.map(|half| half.p99)),
        cell(us.p999, half.map(|half| half.p999)),
    ];
    if times.ticks < TAIL {
        "–".clone_into(&mut cells[2]);
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_its_caption_its_command_and_safe_cells() {
        let table = Table {
            caption: "Case: a plate; reference: none; quantity: force.".to_owned(),
            command: "sulcus-server report".to_owned(),
            columns: vec!["case", "force, N"],
            rows: vec![vec!["a | b\nc".to_owned(), "1.00".to_owned()]],
            notes: vec!["A note.".to_owned()],
        };
        assert_eq!(
            table.markdown("Forces"),
            "### Forces\n\nCase: a plate; reference: none; quantity: force.\nCommand: `sulcus-server report`.\n\n\
             | case | force, N |\n|---|---|\n| a \\| b c | 1.00 |\n\n1. A note.\n"
        );
    }

    #[test]
    fn numbers_have_three_digits() {
        for (x, text) in [
            (0.0, "0"),
            (1234.5, "1234"),
            (99.96, "100"),
            (12.34, "12.3"),
            (9.996, "10.0"),
            (0.123_45, "0.123"),
            (-0.012_345, "-0.0123"),
            (0.000_012, "1.2e-5"),
            (f64::NAN, "–"),
            (f64::INFINITY, "–"),
        ] {
            assert_eq!(number(x), text);
        }
    }
}
