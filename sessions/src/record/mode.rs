//! Mode of a session: the rules for showing its grade.

use std::fmt;

use clap::ValueEnum;
use serde::Serialize;

/// Mode of a session. The station sets the mode at the start, and signs it with the rest of the header.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Everything is shown.
    #[default]
    Practice,
    /// The learner's own score precedes the grade.
    SelfAssessment,
    /// Only the recorded rubric and a trusted key count. Neither advice nor anything that tells a depth is shown.
    Exam,
}

impl Mode {
    /// Name on the command line, in JSON and in recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Practice => "practice",
            Self::SelfAssessment => "self-assessment",
            Self::Exam => "exam",
        }
    }

    /// Mode of a name.
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
