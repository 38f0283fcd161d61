//! Grade of a lesson.

use super::answer::Answer;

/// Side to which wrong answers lean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaning {
    /// As many wrong answers are too deep as too shallow, or none is wrong.
    Neither,
    /// More wrong answers are too deep.
    Deep,
    /// More wrong answers are too shallow.
    Shallow,
}

/// Grade of a lesson.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LessonGrade {
    /// Number of answers.
    pub answers: usize,
    /// Share of right answers, 0 to 1.
    pub right: f64,
    /// Share of answers with an error of at most 1 mm, 0 to 1.
    pub within_1_mm: f64,
    /// Mean of answered minus right number, mm; positive for too deep.
    pub mean_error_mm: f64,
    /// Number of answers that are too deep.
    pub deep: usize,
    /// Number of answers that are too shallow.
    pub shallow: usize,
}

impl LessonGrade {
    /// Grade of `answers`; `None` without any.
    pub fn of(answers: &[Answer]) -> Option<Self> {
        if answers.is_empty() {
            return None;
        }
        let errors = || answers.iter().map(Answer::error_mm);
        let count = |of: fn(i16) -> bool| errors().filter(|mm| of(*mm)).count();
        let share = |part: usize| part as f64 / answers.len() as f64;
        Some(Self {
            answers: answers.len(),
            right: share(count(|mm| mm == 0)),
            within_1_mm: share(count(|mm| mm.abs() <= 1)),
            mean_error_mm: errors().map(f64::from).sum::<f64>() / answers.len() as f64,
            deep: count(|mm| mm > 0),
            shallow: count(|mm| mm < 0),
        })
    }

    /// Side to which the wrong answers lean.
    pub fn leaning(&self) -> Leaning {
        match self.deep.cmp(&self.shallow) {
            std::cmp::Ordering::Equal => Leaning::Neither,
            std::cmp::Ordering::Greater => Leaning::Deep,
            std::cmp::Ordering::Less => Leaning::Shallow,
        }
    }
}
