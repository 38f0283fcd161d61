//! Hand and finger rest of the person at the screen: settings that a recording names.

use std::str::FromStr;

use serde_json::json;

use crate::show::SCREEN;

/// Hand of the probe, which is also the hand of the mouse. The mirror is in the other hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Handed {
    /// Right hand. The operator sits at the patient's right.
    #[default]
    Right,
    /// Left hand. The operator sits at the patient's left, and all views are mirrored.
    Left,
}

impl Handed {
    /// Both hands.
    pub const ALL: [Self; 2] = [Self::Right, Self::Left];

    /// Name on the command line and in events.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// Other hand.
    pub fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// Factor of distances to the patient's left in the presets of a right-handed operator: 1 or -1.
    pub fn side(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }
}

impl FromStr for Handed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|hand| hand.name() == text);
        found.ok_or_else(|| format!("`{text}` is no hand, expected one of: right, left"))
    }
}

/// Finger rest that the student declares. The simulation has no model of the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FingerRest {
    /// No rest.
    #[default]
    None,
    /// A finger rests on a neighbouring tooth.
    Tooth,
    /// A finger rests on the chin.
    Chin,
}

impl FingerRest {
    /// All rests.
    pub const ALL: [Self; 3] = [Self::None, Self::Tooth, Self::Chin];

    /// Name on the command line and in events.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Tooth => "tooth",
            Self::Chin => "chin",
        }
    }
}

impl FromStr for FingerRest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|rest| rest.name() == text);
        found.ok_or_else(|| {
            format!("`{text}` is no finger rest, expected one of: none, tooth, chin")
        })
    }
}

/// Settings of the person at the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Person {
    /// Hand of the probe.
    pub hand: Handed,
    /// Declared finger rest.
    pub rest: FingerRest,
}

impl Person {
    /// Kind and JSON of the settings as an event of a recording. `tools` are the names of the tools by slot; the first
    /// one is in the hand of the probe.
    pub fn event(&self, tools: &[String]) -> (&'static str, String) {
        let hands = [self.hand, self.hand.other()].map(Handed::name);
        let held: Vec<_> = tools
            .iter()
            .zip(hands)
            .map(|(tool, hand)| json!({ "tool": tool, "hand": hand }))
            .collect();
        let data = json!({
            "hand": self.hand.name(), "finger_rest": self.rest.name(), "tools": held
        });
        (SCREEN, data.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back_and_others_are_refused() {
        for hand in Handed::ALL {
            assert_eq!(hand.name().parse(), Ok(hand));
            assert_eq!((hand.other().other(), hand.side().abs()), (hand, 1.0));
        }
        for rest in FingerRest::ALL {
            assert_eq!(rest.name().parse(), Ok(rest));
        }
        assert!("both".parse::<Handed>().is_err() && "nose".parse::<FingerRest>().is_err());
    }

    #[test]
    fn the_event_names_the_hand_of_each_tool() {
        let person = Person {
            hand: Handed::Left,
            rest: FingerRest::Tooth,
        };
        let tools = ["probe", "mirror"].map(str::to_owned);
        let (kind, data) = person.event(&tools);
        assert_eq!(kind, "screen");
        assert_eq!(
            data,
            r#"{"finger_rest":"tooth","hand":"left","tools":[{"hand":"left","tool":"probe"},{"hand":"right","tool":"mirror"}]}"#
        );
    }
}
