//! Lines of a text with their numbers, and the numbers on a line.

use std::path::Path;
use std::str::{FromStr, Lines as Texts, SplitWhitespace};

use crate::error::FemError;

/// The remaining lines of a text.
pub struct Lines<'a> {
    path: &'a Path,
    rest: Texts<'a>,
    number: u64,
}

/// A line that is not blank, without blanks at its ends.
#[derive(Clone, Copy)]
pub struct Line<'a> {
    path: &'a Path,
    /// Number of the line, from 1.
    pub number: u64,
    pub text: &'a str,
}

impl<'a> Lines<'a> {
    pub fn new(path: &'a Path, text: &'a str) -> Self {
        Self {
            path,
            rest: text.lines(),
            number: 0,
        }
    }

    /// Returns the next line, if there is one.
    pub fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let text = self.rest.next()?.trim();
            self.number += 1;
            if !text.is_empty() {
                return Some(Line {
                    path: self.path,
                    number: self.number,
                    text,
                });
            }
        }
    }

    /// Returns the next line; an error if there is none.
    pub fn take(&mut self, expected: &str) -> Result<Line<'a>, FemError> {
        self.next().ok_or_else(|| FemError::Row {
            path: self.path.to_owned(),
            line: self.number + 1,
            found: "the end of the file".into(),
            expected: expected.into(),
        })
    }

    /// Checks that the next line is `text`.
    pub fn end(&mut self, text: &str) -> Result<(), FemError> {
        let line = self.take(text)?;
        if line.text == text {
            return Ok(());
        }
        Err(line.wrong(line.text, text))
    }
}

impl<'a> Line<'a> {
    /// Returns the error that this line is not as expected.
    pub fn wrong(&self, found: &str, expected: &str) -> FemError {
        wrong(self.path, self.number, found, expected)
    }

    /// Returns the numbers on the line.
    pub fn numbers(&self) -> Numbers<'a> {
        Numbers {
            line: *self,
            rest: self.text.split_whitespace(),
        }
    }
}

/// Returns the error that a line is not as expected.
pub fn wrong(path: &Path, line: u64, found: &str, expected: &str) -> FemError {
    // A damaged line may be as long as the file.
    let found = match found.char_indices().nth(60) {
        Some((end, _)) => format!("{}...", &found[..end]),
        None => found.to_owned(),
    };
    FemError::Row {
        path: path.to_owned(),
        line,
        found,
        expected: expected.into(),
    }
}

/// The unread numbers of a line.
pub struct Numbers<'a> {
    line: Line<'a>,
    rest: SplitWhitespace<'a>,
}

impl Numbers<'_> {
    /// Returns the next number.
    pub fn next<T: FromStr>(&mut self, expected: &str) -> Result<T, FemError> {
        let Some(word) = self.rest.next() else {
            return Err(self.line.wrong("the end of the line", expected));
        };
        let number = word.parse();
        number.map_err(|_| self.line.wrong(word, expected))
    }

    /// Returns the next `count` numbers.
    pub fn all<T: FromStr>(&mut self, count: usize, expected: &str) -> Result<Vec<T>, FemError> {
        (0..count).map(|_| self.next(expected)).collect()
    }
}
