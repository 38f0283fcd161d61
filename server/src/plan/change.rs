//! Change of a plan: any of its parts.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_program::PathText;
use sulcus_sessions::Mode;

use super::fields::{self, ClockInGap, PatientSeed};
use super::{Plan, RESUME_WITHIN_S};

/// Any parts of a [`Plan`], in a file, a request or a command. A part that is `None` stays as it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlanChange {
    /// [`Plan::exercise`].
    #[serde(
        deserialize_with = "fields::exercise",
        skip_serializing_if = "Option::is_none"
    )]
    pub exercise: Option<String>,
    /// [`Plan::scene`].
    #[serde(
        deserialize_with = "fields::scene",
        skip_serializing_if = "Option::is_none"
    )]
    pub scene: Option<PathBuf>,
    /// [`Plan::patient_seed`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patient_seed: Option<PatientSeed>,
    /// [`Plan::rate_hz`].
    #[serde(
        deserialize_with = "fields::rate_hz",
        skip_serializing_if = "Option::is_none"
    )]
    pub rate_hz: Option<u16>,
    /// [`Plan::mode`].
    #[serde(
        deserialize_with = "fields::mode::deserialize",
        serialize_with = "fields::mode::serialize_some",
        skip_serializing_if = "Option::is_none"
    )]
    pub mode: Option<Mode>,
    /// [`Plan::learner`].
    #[serde(
        deserialize_with = "fields::learner",
        skip_serializing_if = "Option::is_none"
    )]
    pub learner: Option<String>,
    /// [`Plan::rubric`].
    #[serde(
        deserialize_with = "fields::rubric",
        skip_serializing_if = "Option::is_none"
    )]
    pub rubric: Option<PathBuf>,
    /// [`Plan::time_limit_s`].
    #[serde(
        deserialize_with = "fields::time_limit_s",
        skip_serializing_if = "Option::is_none"
    )]
    pub time_limit_s: Option<u32>,
    /// [`Plan::resume_within_s`].
    #[serde(
        deserialize_with = "fields::resume_within_s",
        skip_serializing_if = "Option::is_none"
    )]
    pub resume_within_s: Option<u32>,
    /// [`Plan::clock_in_gap`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_in_gap: Option<ClockInGap>,
    /// [`Plan::force_limit_n`].
    #[serde(
        deserialize_with = "fields::force_limit_n",
        skip_serializing_if = "Option::is_none"
    )]
    pub force_limit_n: Option<f32>,
    /// [`Plan::tick_at_hand`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tick_at_hand: Option<bool>,
    /// [`Plan::detail_budget_us`].
    #[serde(
        deserialize_with = "fields::detail_budget_us",
        skip_serializing_if = "Option::is_none"
    )]
    pub detail_budget_us: Option<u32>,
    /// Names of parts that return to their defaults, before the other parts are set.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clear: Vec<String>,
}

/// Parts of a plan that do not fit each other.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Fault {
    /// Name of the part.
    pub field: &'static str,
    /// Value found.
    pub found: String,
    /// Value expected, with the reason.
    pub expected: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (field, found, expected) = (self.field, &self.found, &self.expected);
        write!(f, "{field} is {found}, expected {expected}")
    }
}

impl PlanChange {
    /// Names of all parts, as in files.
    pub const NAMES: [&'static str; 13] = [
        "exercise",
        "scene",
        "patient_seed",
        "rate_hz",
        "mode",
        "learner",
        "rubric",
        "time_limit_s",
        "resume_within_s",
        "clock_in_gap",
        "force_limit_n",
        "tick_at_hand",
        "detail_budget_us",
    ];

    /// Change that sets every part to that of `plan`.
    pub fn to(plan: &Plan) -> Self {
        let plan = plan.clone();
        Self {
            exercise: Some(plan.exercise),
            scene: plan.scene,
            patient_seed: plan.patient_seed,
            rate_hz: plan.rate_hz,
            mode: Some(plan.mode),
            learner: Some(plan.learner),
            rubric: plan.rubric,
            time_limit_s: plan.time_limit_s,
            resume_within_s: Some(plan.resume_within_s),
            clock_in_gap: Some(plan.clock_in_gap),
            force_limit_n: plan.force_limit_n,
            tick_at_hand: plan.tick_at_hand,
            detail_budget_us: plan.detail_budget_us,
            clear: Self::NAMES.map(str::to_owned).to_vec(),
        }
    }

    /// The change with relative paths of files resolved against `folder`.
    #[must_use]
    pub fn based(mut self, folder: &Path) -> Self {
        for path in [&mut self.scene, &mut self.rubric].into_iter().flatten() {
            *path = folder.join(&*path);
        }
        if let Some(exercise) = self
            .exercise
            .as_mut()
            .filter(|name| name.ends_with(".toml"))
            && let Some(path) = folder.join(&*exercise).to_str()
        {
            *exercise = path.to_owned();
        }
        self
    }

    /// Plan after this change, not checked as a whole.
    pub(super) fn applied(&self, plan: &Plan) -> Result<Plan, Fault> {
        let mut plan = plan.clone();
        for name in &self.clear {
            clear(&mut plan, name)?;
        }
        if self.scene.is_some() && self.exercise.is_none() {
            plan.exercise = Plan::FREE.into();
        }
        macro_rules! set {
            ($($field:ident)*) => {$(
                if let Some(value) = &self.$field {
                    plan.$field = value.clone().into();
                }
            )*};
        }
        set! {
            exercise scene patient_seed rate_hz mode learner rubric time_limit_s resume_within_s
            clock_in_gap force_limit_n tick_at_hand detail_budget_us
        }
        Ok(plan)
    }
}

/// Sets a part to its default.
fn clear(plan: &mut Plan, name: &str) -> Result<(), Fault> {
    match name {
        "exercise" => plan.exercise = Plan::default().exercise,
        "scene" => plan.scene = None,
        "patient_seed" => plan.patient_seed = None,
        "rate_hz" => plan.rate_hz = None,
        "mode" => plan.mode = Mode::default(),
        "learner" => plan.learner.clear(),
        "rubric" => plan.rubric = None,
        "time_limit_s" => plan.time_limit_s = None,
        "resume_within_s" => plan.resume_within_s = RESUME_WITHIN_S,
        "clock_in_gap" => plan.clock_in_gap = ClockInGap::default(),
        "force_limit_n" => plan.force_limit_n = None,
        "tick_at_hand" => plan.tick_at_hand = None,
        "detail_budget_us" => plan.detail_budget_us = None,
        other => {
            return Err(Fault {
                field: "clear",
                found: format!("`{}`", other.escape_debug()),
                expected: format!("one of {}", PlanChange::NAMES.join(", ")),
            });
        }
    }
    Ok(())
}

impl Plan {
    /// Checks that the parts fit each other and that each is in its range. Files and exercises are not opened.
    ///
    /// # Errors
    /// The first part that does not fit.
    pub fn check(&self) -> Result<(), Fault> {
        let wrong = |field, found: &dyn fmt::Display, expected: &str| {
            Err(Fault {
                field,
                found: found.to_string(),
                expected: expected.to_owned(),
            })
        };
        if let Some(PatientSeed::Number(_)) = self.patient_seed
            && self.mode == Mode::Exam
        {
            // The number stays out of the message: it may be the seed of another exam.
            return wrong(
                "patient_seed",
                &"a number",
                "`system` or none in an exam, whose seed comes from the system's random numbers",
            );
        }
        if let Some(rubric) = self.rubric.as_ref().filter(|_| self.exercise == Self::FREE) {
            let found = rubric.shown().to_string();
            return wrong(
                "rubric",
                &found,
                "none with the exercise `free`, which has no grade",
            );
        }
        if self.mode == Mode::Exam && self.detail_budget_us.is_some() {
            return wrong(
                "detail_budget_us",
                &"given",
                "none in an exam, in which all students feel the same level of detail",
            );
        }
        Ok(())
    }
}
