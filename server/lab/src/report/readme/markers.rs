//! The marked part of a document: the lines between two markers, each alone on its line.

use anyhow::bail;

/// Line before the marked part.
pub(super) const BEGIN: &str = "<!-- begin: measured -->";
/// Line behind the marked part.
pub(super) const END: &str = "<!-- end: measured -->";

/// Replaces the marked part of `text` by `block`, with an empty line around the block.
///
/// All bytes outside of the marked part stay. `file` is the name of the document for the error.
///
/// # Errors
/// A marker is missing or doubled, or the end stands before the beginning.
pub(super) fn replaced(file: &str, text: &str, block: &str) -> anyhow::Result<String> {
    let begin = only(file, text, BEGIN)?;
    let end = only(file, text, END)?;
    if end.0 < begin.1 {
        bail!("{file}: the marker `{END}` stands before `{BEGIN}`, expected behind it");
    }
    let (before, after) = (&text[..begin.1], &text[end.0..]);
    Ok(format!("{before}\n{}\n\n{after}", block.trim_end()))
}

/// Byte range of the one line that is `marker`, with its line break.
fn only(file: &str, text: &str, marker: &str) -> anyhow::Result<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if line.trim_end() == marker {
            found.push((at, at + line.len()));
        }
        at += line.len();
    }
    match found[..] {
        [line] => Ok(line),
        [] => bail!("{file}: no line is the marker `{marker}`, expected one"),
        _ => bail!(
            "{file}: {} lines are the marker `{marker}`, expected one",
            found.len()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        let error = replaced("a.md", text, "new").expect_err("refused");
        format!("{error:#}")
    }

    #[test]
    fn text_outside_of_the_markers_stays_byte_for_byte() {
        let before = "# Töpfe\r\n\ttab  \n\nno trailing change \n";
        let after = "\n## Proofs\r\nwithout a last line break";
        let text = format!("{before}{BEGIN}\nold 1\nold 2\n{END}\n{after}");
        let found = replaced("a.md", &text, "new\n").expect("marked");
        assert_eq!(found, format!("{before}{BEGIN}\n\nnew\n\n{END}\n{after}"));
        // A second replacement replaces the first one.
        let again = replaced("a.md", &found, "newer").expect("marked");
        assert_eq!(again, found.replace("new", "newer"));
        // An empty marked part is one, too; so is a document that ends with its marker.
        let text = format!("{BEGIN}\n{END}");
        let found = replaced("a.md", &text, "new").expect("marked");
        assert_eq!(found, format!("{BEGIN}\n\nnew\n\n{END}"));
    }

    #[test]
    fn a_marker_within_a_line_is_text() {
        let text = format!("The markers are `{BEGIN}` and `{END}`.\n{BEGIN}\n{END}\n");
        let found = replaced("a.md", &text, "new").expect("marked");
        assert!(found.starts_with("The markers are `<!--"));
    }

    #[test]
    fn wrong_markers_are_refused_with_file_and_marker() {
        for (text, marker, fault) in [
            (String::new(), BEGIN, "no line"),
            (format!("{END}\n"), BEGIN, "no line"),
            (format!("{BEGIN}\n"), END, "no line"),
            (format!("{BEGIN}\n{BEGIN}\n{END}\n"), BEGIN, "2 lines"),
            (format!("{BEGIN}\n{END}\n{END}\n{END}\n"), END, "3 lines"),
            (format!("{END}\n{BEGIN}\n"), END, "before"),
        ] {
            let said = refused(&text);
            assert!(said.contains("a.md"), "{said}");
            assert!(said.contains(marker) && said.contains(fault), "{said}");
        }
    }
}
