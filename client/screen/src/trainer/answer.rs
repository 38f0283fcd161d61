//! Answers to tasks, as events of a recording.

use serde_json::{Value, json};

use super::{Rule, Task};

/// Kind of the event of an answer.
pub const BAND_READ: &str = "band_read";

/// Answer to a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Task.
    pub task: Task,
    /// Rule of rounding.
    pub rule: Rule,
    /// Number that the rule calls right, mm.
    pub right_mm: u8,
    /// Number that was answered, mm.
    pub said_mm: u8,
}

impl Answer {
    /// Answered minus right number, mm; positive for too deep.
    pub fn error_mm(&self) -> i16 {
        i16::from(self.said_mm) - i16::from(self.right_mm)
    }

    /// Data of the event [`BAND_READ`]: shown length, rule, right and answered number.
    pub fn data(&self) -> Value {
        json!({
            "shown_mm": f64::from(self.task.tenths) / 10.0,
            "rule": self.rule.name(),
            "right_mm": self.right_mm,
            "said_mm": self.said_mm,
        })
    }

    /// Data of the event as JSON.
    pub fn json(&self) -> String {
        self.data().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_names_the_rule_beside_the_numbers() {
        let answer = Answer {
            task: Task { tenths: 35 },
            rule: Rule::NearestHalfUp,
            right_mm: 4,
            said_mm: 3,
        };
        let json = r#"{"right_mm":4,"rule":"nearest_half_up","said_mm":3,"shown_mm":3.5}"#;
        assert_eq!(answer.json(), json);
        assert_eq!(answer.error_mm(), -1);
    }
}
