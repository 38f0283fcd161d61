//! Policy of a recording about its channels for viewers.

use std::fmt;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::record::channels::topics::SESSION_METRICS;

/// Policy about the channels for viewers. The station sets the policy, and signs it with the rest of the header.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ViewersPolicy {
    /// All channels are in the recording.
    #[default]
    Recorded,
    /// Only what a replay cannot make again is in the recording; `sulcus-sessions viewers` makes the rest.
    OnDemand,
}

impl ViewersPolicy {
    /// Name on the command line, in files of stations, in JSON and in recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Recorded => "recorded",
            Self::OnDemand => "on-demand",
        }
    }

    /// Policy of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        let all = [Self::Recorded, Self::OnDemand];
        all.into_iter().find(|policy| policy.name() == name)
    }

    /// Whether the recorder writes the channel of this topic.
    pub(crate) fn writes(self, topic: &str) -> bool {
        self == Self::Recorded || is_kept(topic)
    }
}

/// Whether a channel for viewers has values that the exact record lacks: CPU times of ticks, and whether the shapes of
/// a tick reached the recorder. Every recording has this channel.
pub(crate) fn is_kept(topic: &str) -> bool {
    topic == SESSION_METRICS
}

impl fmt::Display for ViewersPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_policy_has_one_name_everywhere() {
        for policy in ViewersPolicy::value_variants() {
            assert_eq!(ViewersPolicy::from_name(policy.name()), Some(*policy));
            let on_the_command_line = policy.to_possible_value().expect("not hidden");
            assert_eq!(on_the_command_line.get_name(), policy.name());
            assert_eq!(serde_json::json!(policy), policy.name());
        }
        assert_eq!(ViewersPolicy::from_name("none"), None);
        assert!(ViewersPolicy::Recorded.writes("/tf"));
        assert!(!ViewersPolicy::OnDemand.writes("/tf"));
        assert!(ViewersPolicy::OnDemand.writes(SESSION_METRICS));
    }
}
