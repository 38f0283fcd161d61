//! The value of every metric, from the evidence and the zones. None where there is nothing to measure.

use sulcus_core::math::fmax;

use super::crown::Crown;
use super::evidence::Evidence;
use super::hands::Pressed;
use super::rubric::Settings;
use super::sites::SiteGrade;
use super::stats::{longest_rising, mean, median, percent};
use super::touches::{Touch, steps};
use crate::exercise::Exercise;
use crate::exercise::events::call::Call;

/// What a hand's tremor adds to the target band is forgiven up to this, newtons.
pub const FORGIVEN: f64 = 0.05;
/// Farthest that a call counts as within a millimetre, and as exact, mm; what is left of a tie after conversion.
const WITHIN: f64 = 1.0 + 1e-9;
pub const EXACT: f64 = 0.5 + 1e-9;

/// What is done for less than this share of the exercise's length, and for less than so many seconds, was not done: else who
/// grazes a crown once, or looks once, is graded by that. Chosen.
const LEAST_SHARE: f64 = 0.25;
pub const LEAST_S: f64 = 5.0;
/// But a critical error is looked for in what was done for so long, seconds: a knock is none. Chosen.
pub const CRITICAL_S: f64 = 1.0;

/// What values are made of.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The exercise.
    pub exercise: &'a Exercise,
    /// Everything gathered; the moves have ended.
    pub evidence: &'a Evidence,
    /// Zone by zone.
    pub sites: &'a [SiteGrade],
    /// Calls, in order.
    pub calls: &'a [Call],
    /// Touches of the floor.
    pub touches: &'a [Touch],
    /// Median SPARC of the leading tool's free moves.
    pub smoothness: Option<f64>,
    /// Settings of the rubric.
    pub set: &'a Settings,
}

impl Measured<'_> {
    /// The value of a metric of the table.
    pub fn value(&self, name: &str) -> Option<f64> {
        let evidence = self.evidence;
        match name {
            "zones_charted" => self.share(|_| true, SiteGrade::is_charted),
            "tour_order" => self.tour_order(),
            "floor_reached" => self.share(|site| site.probed, |site| site.is_reached(self.set)),
            "misread" => self.share(
                |site| site.is_charted() && site.is_reached(self.set),
                |site| site.is_misread(self.set),
            ),
            "called_exact" => self.called_within(EXACT),
            "called_within_1mm" => self.called_within(WITHIN),
            "called_bias" => {
                let asked = self.sites.iter().filter(|site| site.asked);
                mean(&asked.filter_map(SiteGrade::error_mm).collect::<Vec<_>>())
            }
            "touches_too_light" => self.share_of_touches(|touch| touch.peak < self.set.force_n[0]),
            "touches_too_heavy" => {
                self.share_of_touches(|touch| touch.peak > self.set.force_n[1] + FORGIVEN)
            }
            "readings_held" => self.share(SiteGrade::is_charted, SiteGrade::is_held),
            "readings_too_heavy" => self.share(SiteGrade::is_charted, SiteGrade::is_pressed),
            "force_in_band" => evidence.floor.in_band_percent(),
            // Who never lets go enters once.
            "trauma_events" => Some(fmax(
                evidence.trauma as f64,
                evidence.floor.trauma_s.floor(),
            )),
            "damage_events" => Some(evidence.damage as f64),
            "angle_mid" => self.angle(false),
            "angle_proximal" => self.angle(true),
            "walking_step" => {
                let ours: Vec<Touch> = self.ours().copied().collect();
                median(&steps(&ours)).map(|step| step * 1e3)
            }
            "withdrawals" => Some(evidence.withdrawals as f64),
            "recession_within_1mm" => self.share_once_said(
                self.set.ask_recession,
                |_| true,
                |site| site.recession_called_mm.is_some(),
                |site| {
                    let both = site.recession_called_mm.zip(site.recession_truth_mm);
                    both.is_some_and(|(said, is)| (f64::from(said) - is).abs() <= WITHIN)
                },
            ),
            "bleeding_agreement" => self.share_once_said(
                self.set.ask_bleeding,
                |_| true,
                |site| site.bleeding_called.is_some(),
                |site| site.bleeding_called == Some(site.bled),
            ),
            "furcation_agreement" => self.share_once_said(
                self.set.ask_furcation,
                |site| site.furcation_truth.is_some(),
                |site| site.furcation_called.is_some(),
                |site| site.furcation_called == site.furcation_truth,
            ),
            "target_visible" => self.visible(),
            "coordination" => evidence.hands.together_percent(),
            "mirror_force" => self.pressed(&evidence.mirror),
            "mirror_peak" => evidence.mirror.peak(),
            "probe_peak" => evidence.probe.peak(),
            "crown_covered" => evidence.crown.as_ref().map(Crown::covered_percent),
            "contact_force" => self.pressed(&evidence.probe),
            "smoothness" => self.smoothness,
            "path_length" => Some(evidence.moves[evidence.leading].ways().0 * 1e3),
            "time" => evidence.hands.span_s(),
            _ => None,
        }
    }

    /// The value that a critical error is looked for in: what was done too briefly to be graded can be one all the same.
    pub fn critical(&self, name: &str) -> Option<f64> {
        let pressed = |tool: &Pressed| tool.p95().filter(|_| tool.seconds() >= CRITICAL_S);
        match name {
            "mirror_force" => pressed(&self.evidence.mirror),
            "contact_force" => pressed(&self.evidence.probe),
            _ => self.value(name),
        }
    }

    /// How long something has to be done before it is measured how well, seconds.
    fn least_s(&self) -> f64 {
        let quarter = LEAST_SHARE * self.exercise.duration_s;
        if quarter < LEAST_S { quarter } else { LEAST_S }
    }

    fn pressed(&self, tool: &Pressed) -> Option<f64> {
        tool.p95().filter(|_| tool.seconds() >= self.least_s())
    }

    fn visible(&self) -> Option<f64> {
        let hands = &self.evidence.hands;
        // (Zones have a measure of their own for how much was done.)
        let long = hands.span_s().is_some_and(|span| span >= self.least_s());
        let long = long || !self.exercise.zones.is_empty();
        hands.visible_percent().filter(|_| long)
    }

    /// Of the zones asked for that are `of`: the share that is `part`, percent.
    fn share(
        &self,
        of: impl Fn(&SiteGrade) -> bool,
        part: impl Fn(&SiteGrade) -> bool,
    ) -> Option<f64> {
        let all: Vec<&SiteGrade> = self
            .sites
            .iter()
            .filter(|site| site.asked && of(site))
            .collect();
        percent(all.iter().filter(|site| part(site)).count(), all.len())
    }

    /// Of the zones asked for that were probed and are `of`: the share that is `part`, percent; none where nothing was `said` of any,
    /// unless it was `required`.
    fn share_once_said(
        &self,
        required: bool,
        of: impl Fn(&SiteGrade) -> bool,
        said: impl Fn(&SiteGrade) -> bool,
        part: impl Fn(&SiteGrade) -> bool,
    ) -> Option<f64> {
        let of = |site: &SiteGrade| site.is_probed_first() && of(site);
        let any = |site: &SiteGrade| site.asked && of(site) && said(site);
        let any = required || self.sites.iter().any(any);
        self.share(of, part).filter(|_| any)
    }

    fn called_within(&self, most: f64) -> Option<f64> {
        self.share(
            |site| site.called_mm.is_some(),
            |site| site.error_mm().is_some_and(|error| error.abs() <= most),
        )
    }

    fn angle(&self, proximal: bool) -> Option<f64> {
        self.share(
            |site| site.site.is_proximal() == proximal && site.probed,
            |site| site.tilt_right == Some(true),
        )
    }

    /// Touches of the teeth that were asked for.
    fn ours(&self) -> impl Iterator<Item = &Touch> {
        let asked = |touch: &&Touch| {
            self.exercise
                .zones
                .iter()
                .any(|zone| zone.tooth == touch.tooth)
        };
        self.touches.iter().filter(asked)
    }

    fn share_of_touches(&self, part: impl Fn(&Touch) -> bool) -> Option<f64> {
        let part = self.ours().filter(|touch| part(touch)).count();
        percent(part, self.ours().count())
    }

    /// Share of the zones called that lie in the longest run in the order asked for, by their first call.
    fn tour_order(&self) -> Option<f64> {
        let mut order: Vec<usize> = Vec::new();
        for call in self.calls {
            let is_it = |site: &SiteGrade| (site.tooth, site.site) == (call.tooth, call.site);
            let at = self.sites.iter().position(|site| site.asked && is_it(site));
            if let Some(at) = at.filter(|at| !order.contains(at)) {
                order.push(at);
            }
        }
        percent(longest_rising(&order), order.len())
    }
}

#[cfg(test)]
mod tests;
