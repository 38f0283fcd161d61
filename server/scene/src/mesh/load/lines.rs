//! Lines of text files from any system. LF, CR LF or CR alone ends a line, in any mixture.

/// Returns the first line without its end, and the bytes behind its end; `None` if no bytes are left.
pub(super) fn first(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    if bytes.is_empty() {
        return None;
    }
    let Some(end) = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r')) else {
        return Some((bytes, &[]));
    };
    let behind = if bytes[end..].starts_with(b"\r\n") {
        2
    } else {
        1
    };
    Some((&bytes[..end], &bytes[end + behind..]))
}

/// All lines with their numbers from 1.
pub(super) fn numbered(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest = Some(text);
    let lines = std::iter::from_fn(move || {
        let text = rest.take().filter(|text| !text.is_empty())?;
        let Some(end) = text.find(['\n', '\r']) else {
            return Some(text);
        };
        let behind = if text[end..].starts_with("\r\n") {
            2
        } else {
            1
        };
        rest = Some(&text[end + behind..]);
        Some(&text[..end])
    });
    (1..).zip(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_of_a_line_counts_once() {
        let text = "a\nb\r\nc\rd\r\r\ne\n\nf";
        let found: Vec<_> = numbered(text).collect();
        let expected = ["a", "b", "c", "d", "", "e", "", "f"];
        assert_eq!(found, (1..).zip(expected).collect::<Vec<_>>());
        let mut rest = text.as_bytes();
        for expected in expected {
            let (line, behind) = first(rest).expect("a line");
            assert_eq!(line, expected.as_bytes());
            rest = behind;
        }
        assert_eq!(first(rest), None);
    }
}
