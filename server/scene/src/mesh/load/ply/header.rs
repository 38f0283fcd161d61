//! Header of a PLY file in the spelling of the reader, and the beginning of the data.
//!
//! The reader expects LF or CR LF, and keeps properties by name. Of two properties with one name it would forget the
//! first, and every later column would shift.
//!
//! Here lines may end in CR alone, and repeated names get a number.

use crate::mesh::load::lines;
use crate::mesh::load::{Malformed, brief};

use super::{CORNERS, SURFACES};

/// Longest header that is read, bytes.
const LONGEST_HEADER: usize = 1 << 20;

/// A header in ASCII, lines ending in LF, names different.
pub(super) struct Normalised {
    pub text: String,
    /// Lines of the file's header.
    pub lines: usize,
    /// Bytes of the file's header, with the end of its last line.
    pub length: usize,
}

/// Reads the header of a file.
pub(super) fn normalised(bytes: &[u8]) -> Result<Normalised, Malformed> {
    let whole = bytes;
    let start = &bytes[..bytes.len().min(LONGEST_HEADER)];
    let mut found = Normalised {
        text: String::new(),
        lines: 0,
        length: 0,
    };
    let mut names = Names::default();
    let mut rest = start;
    loop {
        let Some((line, behind)) = lines::first(rest) else {
            return Err(Malformed::new(
                format!("no line `end_header` in the first {} bytes", start.len()),
                "a PLY header",
            ));
        };
        found.lines += 1;
        // Comments may have any character set; the reader expects UTF-8.
        let line: String = line
            .iter()
            .map(|&byte| {
                if byte.is_ascii() {
                    char::from(byte)
                } else {
                    '?'
                }
            })
            .collect();
        let line = line.trim_end();
        if line == "end_header" {
            let behind = start.len() - behind.len();
            found.length = behind - data_taken_for_an_end(whole, behind);
            found.text.push_str("end_header\n");
            return Ok(found);
        }
        found.text.push_str(&names.different(line, found.lines)?);
        found.text.push('\n');
        rest = behind;
    }
}

/// Returns 1 if the end of the header was read as CR LF but its lines end in CR alone: then LF is the first byte of
/// data.
fn data_taken_for_an_end(bytes: &[u8], behind: usize) -> usize {
    let first = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    let cr_alone = first.is_some_and(|at| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
    usize::from(cr_alone && bytes[..behind].ends_with(b"\r\n"))
}

/// The names of elements and of the present element's properties.
#[derive(Default)]
struct Names {
    elements: Vec<String>,
    properties: Vec<String>,
}

impl Names {
    /// Returns the line with a name that did not occur before. Names that define the surface cannot be repeated.
    fn different(&mut self, line: &str, number: usize) -> Result<String, Malformed> {
        let mut words = line.split_whitespace();
        let kind = words.next();
        let (name, taken) = match kind {
            // The reader refuses blank lines.
            None => return Ok("comment".to_owned()),
            Some("element") => {
                self.properties.clear();
                (words.next(), &mut self.elements)
            }
            Some("property") => (words.last(), &mut self.properties),
            _ => return Ok(line.to_owned()),
        };
        let Some(name) = name else {
            return Ok(line.to_owned());
        };
        if !taken.iter().any(|known| known == name) {
            taken.push(name.to_owned());
            return Ok(line.to_owned());
        }
        let element = kind == Some("element");
        let shape = match element {
            true => name == "vertex" || SURFACES.contains(&name),
            false => ["x", "y", "z"].contains(&name) || CORNERS.contains(&name),
        };
        if shape {
            return Err(Malformed::new(
                format!("`{}` a second time in line {number}", brief(line)),
                "each element, each coordinate and each list of corners once",
            ));
        }
        let mut other = format!("{name}_2");
        for count in 3.. {
            if !taken.contains(&other) {
                break;
            }
            other = format!("{name}_{count}");
        }
        taken.push(other.clone());
        // The name is the last word of a property and the second of an element.
        let mut words: Vec<&str> = line.split_whitespace().collect();
        let at = if element { 1 } else { words.len() - 1 };
        words[at] = &other;
        Ok(words.join(" "))
    }
}
