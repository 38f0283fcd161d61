//! Paths as text, without loss.
//!
//! A path is a byte string that may be invalid UTF-8. A replacement character would name another file.

use std::fmt::{self, Display, Formatter, Write as _};
use std::path::Path;

use serde::Serializer;

/// Conversion of a path to text, without loss.
pub trait PathText {
    /// Returns the path as text.
    ///
    /// A path in UTF-8 without control characters is unchanged. Any other path is quoted for bash and zsh:
    /// `$'r\351sum\351.mcap'`.
    fn shown(&self) -> impl Display + '_;
}

impl PathText for Path {
    fn shown(&self) -> impl Display + '_ {
        Text(self)
    }
}

/// Serializes a path as the text of [`PathText::shown`].
///
/// For `#[serde(serialize_with = "sulcus_program::path::text")]`: Serde alone refuses a path that is not UTF-8.
///
/// # Errors
/// The serializer failed.
pub fn text<P: AsRef<Path>, S: Serializer>(path: &P, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(&path.as_ref().shown())
}

/// Serializes an optional path: as [`text()`] does, or as null for `None`.
///
/// # Errors
/// The serializer failed.
pub fn text_or_null<P: AsRef<Path>, S: Serializer>(
    path: &Option<P>,
    to: S,
) -> Result<S::Ok, S::Error> {
    match path {
        Some(path) => text(path, to),
        None => to.serialize_none(),
    }
}

/// Formatter of [`PathText::shown`].
struct Text<'a>(&'a Path);

impl Display for Text<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let plain = |text: &&str| !text.contains(char::is_control);
        if let Some(text) = self.0.to_str().filter(plain) {
            return f.write_str(text);
        }
        f.write_str("$'")?;
        for chunk in self.0.as_os_str().as_encoded_bytes().utf8_chunks() {
            for c in chunk.valid().chars() {
                match c {
                    '\'' | '\\' => write!(f, "\\{c}")?,
                    // Always three digits, because a digit may follow the escape.
                    c if c.is_ascii_control() => write!(f, "\\{:03o}", u32::from(c))?,
                    c if c.is_control() => {
                        for byte in c.encode_utf8(&mut [0; 4]).bytes() {
                            write!(f, "\\{byte:03o}")?;
                        }
                    }
                    c => f.write_char(c)?,
                }
            }
            for byte in chunk.invalid() {
                write!(f, "\\{byte:03o}")?;
            }
        }
        f.write_str("'")
    }
}

#[cfg(test)]
mod tests {
    use std::ffi::OsStr;
    use std::os::unix::ffi::{OsStrExt as _, OsStringExt as _};
    use std::process::Command;

    use super::*;

    fn shown(bytes: &[u8]) -> String {
        Path::new(OsStr::from_bytes(bytes)).shown().to_string()
    }

    #[test]
    fn plain_names_stay_as_they_are_and_others_lose_nothing() {
        assert_eq!(shown("Übung/it's 1.mcap".as_bytes()), "Übung/it's 1.mcap");
        assert_eq!(shown(b"r\xe9sum\xe9/1.mcap"), r"$'r\351sum\351/1.mcap'");
        assert_eq!(shown(b"\xff'\\\n1"), r"$'\377\'\\\0121'");
        assert_ne!(shown(b"\xfe"), shown(b"\xff"));
    }

    #[test]
    fn a_shell_finds_the_file_by_the_text() {
        for name in [
            &b"\xff1"[..],
            b"it's\xe9",
            b"a\\b\xfe",
            b"line\nbreak",
            b"\x1b[2J",
        ] {
            let print = format!("printf %s {}", shown(name));
            let ended = Command::new("bash").args(["-c", &print]).output();
            assert_eq!(ended.expect("bash").stdout, name, "{print}");
        }
        let all: Vec<u8> = (1..=255).collect();
        let print = format!("printf %s {}", shown(&all));
        let ended = Command::new("bash").args(["-c", &print]).output();
        let all = std::ffi::OsString::from_vec(all);
        assert_eq!(ended.expect("bash").stdout, all.as_bytes());
    }
}
