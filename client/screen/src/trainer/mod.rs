//! Band trainer: a lesson that shows a probe in a pocket, asks for the depth, and grades the answers.
//!
//! No force and no device are needed. A [`Lesson`] is a seeded series of tasks for the bands of one probe. A [`Task`]
//! is the length of the probe below the gingival margin. A [`Rule`] turns the length into the number that is right.

mod answer;
mod chance;
mod grade;
pub mod place;
mod rule;

pub use answer::{Answer, BAND_READ};
pub use grade::{Leaning, LessonGrade};
pub use rule::Rule;

use crate::readings::{Key, number};
use chance::Chance;
use sulcus_proto::display::DisplayBand;

/// Shortest length below the margin, tenths of a millimetre.
const LEAST_TENTHS: u16 = 5;
/// Longest length below the margin, tenths of a millimetre. Deeper pockets are rare.
const MOST_TENTHS: u16 = 120;
/// Largest answer that is taken, mm: the limit of a called depth.
pub const MOST_MM: u8 = crate::readings::MOST_DEPTH_MM;

/// Task: a probe in a pocket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// Length of the probe below the margin, from the tip along the probe, tenths of a millimetre.
    pub tenths: u16,
}

impl Task {
    /// Length of the probe below the margin, metres, for a picture.
    pub fn depth_m(self) -> f32 {
        f32::from(self.tenths) * 1e-4
    }

    /// Number of the band that the margin crosses, with the border on the tip's side of a mark. `None`: the margin lies
    /// beyond the last band.
    pub fn band(self, bands: &[DisplayBand]) -> Option<usize> {
        bands
            .iter()
            .position(|band| self.tenths <= tenths(band.to) && self.tenths > tenths(band.from))
    }
}

/// Nearest tenth of a millimetre of a length in metres.
fn tenths(metres: f32) -> u16 {
    // The conversion limits to the range of the integer, and NaN becomes 0.
    (metres * 1e4).round() as u16
}

/// Reason why there is no lesson.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LessonError {
    /// The tool has no bands, or all of them end less than 1 mm from the tip.
    #[error("the tool has no bands by which a depth can be read")]
    NoBands,
}

/// Series of tasks with their answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lesson {
    rule: Rule,
    tasks: Vec<Task>,
    answers: Vec<Answer>,
    /// Number that is being typed, mm.
    typed: Option<u8>,
}

impl Lesson {
    /// Lesson of `count` tasks for a probe. Equal seeds give equal tasks on every machine.
    ///
    /// Lengths are drawn from 0.5 mm to the last mark, at most 12 mm. No task has the length of the task before.
    ///
    /// # Errors
    /// The bands do not reach 1 mm.
    pub fn new(
        bands: &[DisplayBand],
        rule: Rule,
        seed: u64,
        count: usize,
    ) -> Result<Self, LessonError> {
        let last = bands.iter().map(|band| tenths(band.to)).max().unwrap_or(0);
        let most = last.min(MOST_TENTHS);
        if most < 10 {
            return Err(LessonError::NoBands);
        }
        let mut chance = Chance::new(seed);
        let mut tasks: Vec<Task> = Vec::with_capacity(count);
        while tasks.len() < count {
            let tenths = LEAST_TENTHS + chance.below(most - LEAST_TENTHS + 1);
            let task = Task { tenths };
            if tasks.last() != Some(&task) {
                tasks.push(task);
            }
        }
        Ok(Self {
            rule,
            tasks,
            answers: Vec::new(),
            typed: None,
        })
    }

    /// Rule of the lesson.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// Present task; `None` at the end of the lesson.
    pub fn task(&self) -> Option<Task> {
        self.tasks.get(self.answers.len()).copied()
    }

    /// Number of tasks.
    pub fn len(&self) -> usize {
        self.tasks.len()
    }

    /// Whether the lesson has no task.
    pub fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }

    /// Takes the answer to the present task, whole millimetres, and goes on to the next one. `None`: the lesson has
    /// ended, or the number is above [`MOST_MM`]; nothing changes.
    pub fn answer(&mut self, said_mm: u8) -> Option<Answer> {
        let task = self.task().filter(|_| said_mm <= MOST_MM)?;
        let right_mm = self.rule.whole_mm(task.tenths);
        let answer = Answer {
            task,
            rule: self.rule,
            right_mm,
            said_mm,
        };
        self.answers.push(answer);
        self.typed = None;
        Some(answer)
    }

    /// Number that is being typed, mm.
    pub fn typed(&self) -> Option<u8> {
        self.typed
    }

    /// Takes in a key, the same as of readings: digits or a count, undo for the whole number, next for the answer.
    /// Other keys change nothing. Returns the answer that the key completes.
    pub fn press(&mut self, key: Key) -> Option<Answer> {
        match key {
            Key::Digit(digit) if self.task().is_some() => {
                self.typed = number::typed(self.typed, digit, MOST_MM).or(self.typed);
            }
            Key::Count(mm) if self.task().is_some() && mm <= MOST_MM => self.typed = Some(mm),
            Key::Undo | Key::Depth => self.typed = None,
            Key::Next => return self.answer(self.typed?),
            _ => {}
        }
        None
    }

    /// Answers so far, in order.
    pub fn answers(&self) -> &[Answer] {
        &self.answers
    }

    /// Grade of the answers so far; `None` before the first.
    pub fn grade(&self) -> Option<LessonGrade> {
        LessonGrade::of(&self.answers)
    }
}

#[cfg(test)]
mod tests;
