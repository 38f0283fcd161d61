//! What a session is for: who may see what of its grade, and when.

use std::fmt;

use clap::ValueEnum;
use serde::Serialize;

/// What a session is for. A station says it when the session begins, and it is signed with the rest of the recording's header.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Everything is shown.
    #[default]
    Practice,
    /// The learner's own score comes before the grade.
    SelfAssessment,
    /// By the recording's own rubric and a trusted key only; neither advice nor anything that tells how deep a pocket is.
    Exam,
}

impl Mode {
    /// As on the command line, in JSON, and in recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Practice => "practice",
            Self::SelfAssessment => "self-assessment",
            Self::Exam => "exam",
        }
    }

    /// The mode of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        let all = [Self::Practice, Self::SelfAssessment, Self::Exam];
        all.into_iter().find(|mode| mode.name() == name)
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_has_one_name_everywhere() {
        for mode in Mode::value_variants() {
            assert_eq!(Mode::from_name(mode.name()), Some(*mode));
            let on_the_command_line = mode.to_possible_value().expect("not hidden");
            assert_eq!(on_the_command_line.get_name(), mode.name());
            assert_eq!(serde_json::json!(mode), mode.name());
        }
        assert_eq!(Mode::from_name("Exam"), None);
    }
}
