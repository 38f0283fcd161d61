//! Lines of a text in a box.

/// Mark of an omitted end. The font has no ellipsis of one character.
const OMITTED: &str = "...";

/// Text of at most `columns` characters. A longer text ends in three dots, as far as there is room for them.
pub fn fit(text: &str, columns: usize) -> String {
    if text.chars().count() <= columns {
        return text.to_owned();
    }
    let kept = columns.saturating_sub(OMITTED.len());
    let start: String = text.chars().take(kept).collect();
    let dots = columns.min(OMITTED.len());
    format!("{}{}", start.trim_end(), &OMITTED[..dots])
}

/// Lines of `text`, each of at most `columns` characters, broken at blanks. A word longer than a line is split.
///
/// Line ends and tabs in the text count as blanks. If `most` lines do not hold the text, the last one ends in three
/// dots.
pub fn wrap(text: &str, columns: usize, most: usize) -> Vec<String> {
    if columns == 0 || most == 0 {
        return Vec::new();
    }
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    let mut length = 0;
    for word in text.split_whitespace() {
        let letters: Vec<char> = word.chars().collect();
        for (k, part) in letters.chunks(columns).enumerate() {
            // Only the first part of a split word may join the words before.
            let joins = k == 0 && length > 0 && length + 1 + part.len() <= columns;
            if joins {
                line.push(' ');
                length += 1;
            } else if length > 0 {
                lines.push(std::mem::take(&mut line));
                length = 0;
            }
            line.extend(part);
            length += part.len();
        }
    }
    if length > 0 {
        lines.push(line);
    }
    if lines.len() > most {
        let rest = lines.split_off(most - 1).join(" ");
        lines.push(fit(&rest, columns));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_break_at_blanks() {
        assert_eq!(
            wrap("walk the probe along", 8, 9),
            ["walk the", "probe", "along"]
        );
        assert_eq!(wrap("interproximal", 5, 9), ["inter", "proxi", "mal"]);
        assert_eq!(
            wrap("a interproximal b", 5, 9),
            ["a", "inter", "proxi", "mal b"]
        );
        assert_eq!(wrap("walk the probe along", 8, 2), ["walk the", "probe..."]);
        assert_eq!(wrap("  \n ", 8, 2), [""; 0]);
        assert_eq!(wrap("text", 0, 2), [""; 0]);
    }

    #[test]
    fn a_short_text_is_whole_and_a_long_one_shows_that_it_goes_on() {
        assert_eq!(fit("Tooth 36", 8), "Tooth 36");
        assert_eq!(fit("Tooth 36 buccal", 11), "Tooth 36...");
        assert_eq!(fit("Tooth", 2), "..");
        assert_eq!(fit("Tooth", 0), "");
        assert_eq!(fit("größer als", 8), "größe...");
    }

    proptest! {
        #[test]
        fn no_line_is_too_wide_and_no_letter_is_lost(
            text in "[a-zäöü \n]{0,120}", columns in 1usize..40, most in 1usize..12,
        ) {
            let lines = wrap(&text, columns, most);
            prop_assert!(lines.len() <= most);
            for line in &lines {
                prop_assert!(line.chars().count() <= columns);
                prop_assert!(!line.is_empty());
            }
            let all: String = wrap(&text, columns, 1000).concat();
            let letters = |text: &str| text.split_whitespace().collect::<String>();
            prop_assert_eq!(letters(&all), letters(&text));
        }
    }
}
