//! Reader of tables that spreadsheets saved: encoding, separator, and columns by their headings.
//!
//! - Excel's "CSV" has commas or semicolons, by the country's decimal sign, in Windows-1252.
//! - Excel's "CSV UTF-8" begins with a byte-order mark. "Unicode text" is UTF-16 with tabs.
//! - Some programs write a first line `sep=;`.
//! - Saved tables have empty rows and columns at their ends. Headings have capitals and blanks.

use csv::{Position, ReaderBuilder, StringRecord};
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Separators of cells.
const SEPARATORS: [u8; 4] = *b",;\t|";

/// Row with the cells of the named columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row<const N: usize> {
    /// Line in the file, from 1.
    pub line: u64,
    /// Text of the cells, without blanks at the ends.
    pub cells: [String; N],
}

/// Failure to read a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SheetError {
    /// Bytes that are not text.
    Text(String),
    /// Line that is not valid.
    Line {
        /// Line, from 1.
        line: u64,
        /// Part of the line.
        field: &'static str,
        /// Text found.
        found: String,
        /// Text expected.
        expected: String,
    },
}

/// Rows of a table that are not empty, with the cells under `headings`.
///
/// # Errors
/// The first line that is not valid: its number, the text found and the text expected.
pub fn read<const N: usize>(bytes: &[u8], headings: [&str; N]) -> Result<Vec<Row<N>>, SheetError> {
    let every = |columns: &[Option<usize>; N]| columns.iter().all(Option::is_some);
    let names = headings.map(|name| format!("`{name}`")).join(" and ");
    let expected = format!("the columns {names}, each once");
    read_some(bytes, headings, every, &expected).map(|(rows, _)| rows)
}

/// The same for tables that need not have every column: `fits` judges the columns found, `None` for a missing one.
/// Cells of a missing column are empty. Returns the rows, and whether each column was found.
///
/// # Errors
/// The first line that is not valid. `expected` is the sentence about a head that does not fit.
pub fn read_some<const N: usize>(
    bytes: &[u8],
    headings: [&str; N],
    fits: impl Fn(&[Option<usize>; N]) -> bool,
    expected: &str,
) -> Result<(Vec<Row<N>>, [bool; N]), SheetError> {
    let text = lines_of(&decode(bytes)?);
    let (named, body, above) = named_separator(&text);
    let mut seen: Option<(u64, StringRecord)> = None;
    for separator in named.into_iter().chain(SEPARATORS) {
        let Some((line, head)) = head(body, separator) else {
            continue;
        };
        if let Some(columns) = columns(&head, headings).filter(&fits) {
            let rows = rows(body, separator, &head, columns, above)?;
            return Ok((rows, columns.map(|at| at.is_some())));
        }
        // The separator with the most cells in the head is the likeliest.
        if seen
            .as_ref()
            .is_none_or(|(_, widest)| head.len() > widest.len())
        {
            seen = Some((line, head));
        }
    }
    let (line, head) = seen.unwrap_or_default();
    let cells: Vec<&str> = head.iter().map(trimmed).collect();
    Err(SheetError::Line {
        line: line.max(1) + above,
        field: "header",
        found: format!("`{}`", cells.join(",").escape_debug()),
        expected: format!("{expected}, separated by commas, semicolons or tabs"),
    })
}

/// Text of the bytes: by their byte-order mark, else as UTF-16, UTF-8 or Windows-1252, the first that fits.
fn decode(bytes: &[u8]) -> Result<String, SheetError> {
    let (encoding, bytes) = match Encoding::for_bom(bytes) {
        Some((encoding, mark)) => (encoding, &bytes[mark..]),
        None if bytes.contains(&0) => (utf_16(bytes), bytes),
        None if std::str::from_utf8(bytes).is_ok() => (encoding_rs::UTF_8, bytes),
        None => (WINDOWS_1252, bytes),
    };
    let text = encoding.decode_without_bom_handling_and_without_replacement(bytes);
    text.map(|text| text.into_owned()).ok_or_else(|| {
        SheetError::Text(format!("the bytes are not {} throughout", encoding.name()))
    })
}

/// Byte order of UTF-16 without a mark. Most characters of a table have a zero in their high byte.
fn utf_16(bytes: &[u8]) -> &'static Encoding {
    let zeros = |at: usize| {
        bytes
            .iter()
            .skip(at)
            .step_by(2)
            .filter(|byte| **byte == 0)
            .count()
    };
    if zeros(1) >= zeros(0) {
        UTF_16LE
    } else {
        UTF_16BE
    }
}

/// Text with line feeds as its only line ends.
fn lines_of(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n")
}

/// Separator of a first line such as `sep=;`, text below that line, and number of lines above the text.
fn named_separator(text: &str) -> (Option<u8>, &str, u64) {
    let (first, below) = text.split_once('\n').unwrap_or((text, ""));
    let whole = first.trim_end_matches('"');
    let first = trimmed(first).trim_start_matches('"');
    let Some(name) = first
        .get(..4)
        .filter(|name| name.eq_ignore_ascii_case("sep="))
    else {
        return (None, text, 0);
    };
    let separator = match first[name.len()..].trim_matches('"') {
        "\\t" => Some(b'\t'),
        // A tab at the end of the line was trimmed away as a blank.
        "" => whole.ends_with('\t').then_some(b'\t'),
        rest => rest
            .bytes()
            .next()
            .filter(|byte| byte.is_ascii() && !b"\"\n".contains(byte)),
    };
    (separator, below, 1)
}

fn trimmed(cell: &str) -> &str {
    cell.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}' || c == '\u{200b}')
}

fn records(body: &str, separator: u8) -> impl Iterator<Item = (u64, StringRecord)> {
    let reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .from_reader(body.as_bytes());
    // The reader cannot fail: the text is UTF-8, and rows may have any length.
    reader
        .into_records()
        .filter_map(Result::ok)
        .filter_map(|record| {
            let (at, line) = record.position().map_or((0, 0), |place| {
                (place.byte() as usize, Position::line(place))
            });
            // The reader's place is before the empty lines that it skipped.
            let rest = body.as_bytes().get(at..).unwrap_or_default();
            let skipped = rest.iter().take_while(|byte| **byte == b'\n').count();
            let line = line + skipped as u64;
            let says = record.iter().any(|cell| !trimmed(cell).is_empty());
            says.then_some((line, record))
        })
}

/// First row that is not empty, with its line.
fn head(body: &str, separator: u8) -> Option<(u64, StringRecord)> {
    records(body, separator).next()
}

/// Heading without capitals, blanks, `_` and `-`, for comparison.
fn plain(heading: &str) -> String {
    let letters = heading.chars().filter(|c| c.is_alphanumeric());
    letters.flat_map(char::to_lowercase).collect()
}

/// Columns of the headings; a missing heading has none. No answer if a heading occurs twice.
fn columns<const N: usize>(head: &StringRecord, headings: [&str; N]) -> Option<[Option<usize>; N]> {
    let mut found = [None; N];
    for (at, heading) in found.iter_mut().zip(headings) {
        let wanted = plain(heading);
        let mut all = head
            .iter()
            .enumerate()
            .filter(|(_, cell)| plain(cell) == wanted);
        *at = all.next().map(|(at, _)| at);
        if all.next().is_some() {
            return None;
        }
    }
    Some(found)
}

fn rows<const N: usize>(
    body: &str,
    separator: u8,
    head: &StringRecord,
    columns: [Option<usize>; N],
    above: u64,
) -> Result<Vec<Row<N>>, SheetError> {
    let mut all = Vec::new();
    for (line, record) in records(body, separator).skip(1) {
        let line = line + above;
        let wrong = |field, found: &str, expected: &str| {
            Err(SheetError::Line {
                line,
                field,
                found: format!("`{}`", found.escape_debug()),
                expected: expected.to_owned(),
            })
        };
        for (k, cell) in record.iter().map(trimmed).enumerate() {
            let heading = head.get(k).map_or("", trimmed);
            if !cell.is_empty() && heading.is_empty() {
                let expected =
                    "a heading over it, or quotation marks around a text with a separator";
                return wrong("a cell", cell, expected);
            }
            if cell.contains('\n') {
                return wrong(
                    "a cell",
                    cell,
                    "one line of text, and every quotation mark closed",
                );
            }
        }
        let cells = columns.map(|at| {
            let cell = at.and_then(|at| record.get(at));
            trimmed(cell.unwrap_or("")).to_owned()
        });
        all.push(Row { line, cells });
    }
    Ok(all)
}
