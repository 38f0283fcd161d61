//! Metrics: one table with name, unit, words and function of each metric.
//!
//! A rubric weighs metrics by their names, and carries their definitions into the recording. Each topic has a file.
//! Words for people count "zones of the exercise": zones that the exercise lists and the scene has.

mod crown;
mod depths;
mod earlier;
mod feels;
mod findings;
mod forces;
mod hands;
mod motion;
mod needs;
mod strokes;
#[cfg(test)]
mod tests;

use super::measured::Measured;

pub use feels::Feels;
pub use needs::Needs;

/// Function of a metric: its value in a session, in the metric's unit. None without anything to measure.
type Measure = fn(&Measured<'_>) -> Option<f64>;

/// A metric.
#[derive(Clone, Copy, Debug)]
pub struct Definition {
    /// Name in rubrics, tables and JSON.
    pub name: &'static str,
    /// Title on pages and in messages, at most 30 characters.
    pub title: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Quantity, ticks or events that count, thresholds, and the meaning of a missing value.
    pub definition: &'static str,
    /// Publication, or the note that a number was chosen.
    pub source: &'static str,
    /// Content of an exercise without which the metric does not apply.
    pub needs: Needs,
    /// Score of a missing value: 0 if true; if false, the metric is left out of the total.
    pub missing_is_zero: bool,
    /// Advice to a learner with a low score.
    pub advice: &'static str,
    /// Function that computes the value.
    value: Measure,
    /// Function for critical errors, where a critical error needs less time than a value. None: the same function.
    critical: Option<Measure>,
}

impl Definition {
    /// Whether a recorded definition has the meaning of this one: the same words, or earlier words of the same
    /// function.
    pub fn is_meant_by(&self, recorded: &str) -> bool {
        recorded == self.definition || earlier::is_same(self.name, recorded)
    }

    /// Value in a session, in the metric's unit. None without anything to measure.
    pub(super) fn value(&self, session: &Measured<'_>) -> Option<f64> {
        (self.value)(session)
    }

    /// Value that decides on a critical error. An activity that is too short for a value can still be a critical error.
    pub(super) fn critical_value(&self, session: &Measured<'_>) -> Option<f64> {
        self.critical.unwrap_or(self.value)(session)
    }
}

/// Source of a number without a publication.
const CHOSEN: &str = "chosen for this simulator";

/// All metrics, in the order of pages.
pub const METRICS: [Definition; 31] = [
    depths::ZONES_CHARTED,
    depths::TOUR_ORDER,
    depths::FLOOR_REACHED,
    depths::MISREAD,
    depths::CALLED_EXACT,
    depths::CALLED_WITHIN_1MM,
    depths::CALLED_BIAS,
    forces::TOUCHES_TOO_LIGHT,
    forces::TOUCHES_TOO_HEAVY,
    forces::READINGS_HELD,
    forces::READINGS_TOO_HEAVY,
    forces::FORCE_IN_BAND,
    forces::TRAUMA_EVENTS,
    forces::DAMAGE_EVENTS,
    strokes::ANGLE_MID,
    strokes::ANGLE_PROXIMAL,
    strokes::WALKING_STEP,
    strokes::WITHDRAWALS,
    findings::RECESSION_WITHIN_1MM,
    findings::BLEEDING_AGREEMENT,
    findings::FURCATION_AGREEMENT,
    hands::TARGET_VISIBLE,
    hands::COORDINATION,
    hands::MIRROR_FORCE,
    hands::MIRROR_PEAK,
    hands::PROBE_PEAK,
    crown::CROWN_COVERED,
    crown::CONTACT_FORCE,
    motion::SMOOTHNESS,
    motion::PATH_LENGTH,
    motion::TIME,
];

/// Metric of that name. None for an unknown name.
pub fn find(name: &str) -> Option<&'static Definition> {
    METRICS.iter().find(|metric| metric.name == name)
}
