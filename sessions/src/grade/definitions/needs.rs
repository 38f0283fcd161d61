//! Content that an exercise and its scene must have for a metric to apply.

use sulcus_core::tissue::gingiva::Site;

use crate::exercise::{Exercise, Kind};

/// Content that an exercise must have for a metric to apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Zones to probe.
    Zones,
    /// Zones beside a neighbouring tooth.
    ProximalZones,
    /// Zones in the middle of a side.
    MidZones,
    /// A target behind the tongue.
    Target,
    /// Zones and a target: a task for two hands.
    BothHands,
    /// A task for a mirror.
    Mirror,
    /// A crown to follow.
    Crown,
    /// A task for a probe.
    Probe,
    /// Nothing: the metric applies to every exercise.
    Nothing,
}

impl Needs {
    /// Whether the exercise has this content.
    pub fn are_met(self, exercise: &Exercise) -> bool {
        let zones = !exercise.zones.is_empty();
        let any = |proximal: bool| {
            exercise
                .tour()
                .any(|(_, site)| site.is_proximal() == proximal)
        };
        match self {
            Self::Zones => zones,
            Self::ProximalZones => any(true),
            Self::MidZones => any(false),
            Self::Target => exercise.target.is_some(),
            Self::BothHands => zones && exercise.target.is_some(),
            Self::Mirror => matches!(exercise.kind, Kind::Retraction | Kind::Bimanual),
            Self::Crown => exercise.kind == Kind::Crown,
            Self::Probe => zones || exercise.kind == Kind::Crown,
            Self::Nothing => true,
        }
    }

    /// Whether the scene has this content, given the sites of the exercise's zones that the scene has.
    /// A tooth that is missing in the scene has no zones.
    pub fn are_there(self, sites: impl IntoIterator<Item = Site>) -> bool {
        let mut sites = sites.into_iter();
        match self {
            Self::ProximalZones => sites.any(Site::is_proximal),
            Self::MidZones => sites.any(|site| !site.is_proximal()),
            _ => true,
        }
    }

    /// Whether a rubric for this exercise may weigh a metric with this need. Zones of either kind meet both needs of
    /// zones: an exercise without proximal zones leaves the proximal metric out of the score.
    pub fn may_be_weighed(self, exercise: &Exercise) -> bool {
        match self {
            Self::ProximalZones | Self::MidZones => Self::Zones.are_met(exercise),
            other => other.are_met(exercise),
        }
    }

    /// Name of the content, for error messages.
    pub fn what(self) -> &'static str {
        match self {
            Self::Zones => "zones to probe",
            Self::ProximalZones => "zones beside a neighbouring tooth",
            Self::MidZones => "zones in the middle of a side",
            Self::Target => "a target behind the tongue",
            Self::BothHands => "zones together with a target",
            Self::Mirror => "a task for a mirror",
            Self::Crown => "a crown to follow",
            Self::Probe => "a task for a probe",
            Self::Nothing => "nothing",
        }
    }
}
