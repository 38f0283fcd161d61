//! Text in the cells of exported tables, written so that a spreadsheet keeps it, and read back.
//!
//! A spreadsheet turns `007` into 7, `1e5` into 100000, `3-4` into a date, and `=1+1` into 2. An apostrophe before such
//! a text prevents this. Columns of hashes and keys have the apostrophe in every row, other text only if necessary.
//! Columns of numbers never have an apostrophe.

use std::borrow::Cow;

/// Names of months. Spreadsheets know the first three letters and the full name.
const MONTHS: [&str; 12] = [
    "january",
    "february",
    "march",
    "april",
    "may",
    "june",
    "july",
    "august",
    "september",
    "october",
    "november",
    "december",
];

/// Cell of any text.
pub fn text(text: &str) -> Cow<'_, str> {
    if is_misread(text) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Cell of a hash or a key, marked in every row, so that all cells of a column look alike.
pub(crate) fn code(code: &str) -> String {
    match code {
        "" => String::new(),
        code => format!("'{code}"),
    }
}

/// Text of a cell. The cell was written by [`text`], or by a person with the marks of spreadsheets, `'007` and
/// `="007"`.
pub fn read(cell: &str) -> &str {
    if let Some(text) = cell
        .strip_prefix("=\"")
        .and_then(|rest| rest.strip_suffix('"'))
    {
        return text;
    }
    cell.strip_prefix('\'')
        .filter(|text| is_misread(text))
        .unwrap_or(cell)
}

/// Whether a spreadsheet would change a text. A marked text counts, too, so that reading is exact.
fn is_misread(text: &str) -> bool {
    let shown = text.trim();
    let formula = ['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠'];
    text.starts_with(formula)
        || shown.starts_with(formula)
        || is_number_or_date(shown)
        || ["true", "false"]
            .iter()
            .any(|word| shown.eq_ignore_ascii_case(word))
        // A blank behind the mark counts: [`read`] sees the untrimmed rest.
        || [text, shown]
            .iter()
            .any(|marked| marked.strip_prefix('\'').is_some_and(is_misread))
}

fn is_number_or_date(text: &str) -> bool {
    let in_numbers = |c: char| c.is_ascii_digit() || "+-.,:/% ".contains(c);
    let letters: String = text.chars().filter(|c| !in_numbers(*c)).collect();
    let first = text.chars().next();
    if !text.contains(|c: char| c.is_ascii_digit()) {
        return false;
    }
    let letters = letters.to_ascii_lowercase();
    let is_month = |month: &&str| letters == **month || letters == month[..3] || letters == "sept";
    match letters.as_str() {
        "" => true,
        "e" => first.is_some_and(|c| c.is_ascii_digit() || c == '.'),
        "am" | "pm" | "a" | "p" => text.contains(' ') || text.contains(':'),
        _ => MONTHS.iter().any(is_month),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn text_that_a_spreadsheet_would_change_is_marked_and_other_text_is_not() {
        for changed in [
            "007", "7", "1e5", "12E34", "1.5", "1,5", "3-4", "2026-014", "1/2", "12:30", "10%",
            "mar1", "Dec-01", "1-may", "sept2", "TRUE", "=1+1", "+1", "-1", "@sum", "\tx", "\rx",
            " =1", "＝1", "'007", "3 pm", "'\t", "'\r", " '007",
        ] {
            assert_eq!(text(changed), format!("'{changed}"));
        }
        for kept in [
            "",
            "a7f3",
            "s-17, \"b\"",
            "S_7",
            "e5",
            "2026-11-24T10-00-00Z-bimanual.mcap",
            "1e5a",
            "'t Hooft",
            "7a",
            "maybe1",
            "tooth 36",
            "3p",
        ] {
            assert_eq!(text(kept), kept);
        }
        assert_eq!((code("1e5f"), code("")), ("'1e5f".into(), String::new()));
    }

    #[test]
    fn marks_of_people_are_taken_off_and_apostrophes_of_names_are_not() {
        assert_eq!(read("=\"007\""), "007");
        assert_eq!(read("'007"), "007");
        assert_eq!(read("'t Hooft"), "'t Hooft");
    }

    /// The mark was looked for behind the trimmed text alone, which has no tab left.
    #[test]
    fn a_mark_before_nothing_but_a_blank_is_read_again() {
        for blank in ['\t', '\r', '\n', ' ', '\u{a0}', '\u{b}', '\u{2003}'] {
            for original in [
                format!("'{blank}"),
                format!("''{blank}"),
                format!("'{blank}'{blank}"),
                format!("{blank}'{blank}"),
            ] {
                assert_eq!(read(&text(&original)), original, "{original:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_again(original in ".{0,12}|'{0,3}[0-9e./-]{0,6}|[' \t\r\n=+@7e-]{0,5}") {
            // A formula with nothing but a text is a form of that text.
            prop_assume!(!original.starts_with("=\""));
            let written = text(&original);
            prop_assert_eq!(read(&written), original.as_str());
            prop_assert!(!written.starts_with(['=', '+', '-', '@']));
            prop_assert!(written.trim().parse::<f64>().is_err() || !original.contains(|c: char| c.is_ascii_digit()));
        }
    }
}
