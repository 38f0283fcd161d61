//! Measured session: input of the functions of all metrics, with the sums that several of them share.

use super::evidence::Evidence;
use super::pressed::Pressed;
use super::settings::Settings;
use super::sites::SiteGrade;
use super::stats::{longest_rising, mean, median, percent};
use super::tolerances::{CRITICAL_S, LEAST_S, LEAST_SHARE};
use super::touches::{Touch, steps};
use crate::exercise::Exercise;
use crate::exercise::events::call::Call;

/// Measured session. A missing value of a sum means that there was nothing to measure.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Exercise.
    pub exercise: &'a Exercise,
    /// Evidence of the whole session, after the end of the last move.
    pub evidence: &'a Evidence,
    /// Zones of the exercise that the scene has, then other zones that were called.
    pub sites: &'a [SiteGrade],
    /// Calls, in order of time.
    pub calls: &'a [Call],
    /// Touches of the floor, in order of time.
    pub touches: &'a [Touch],
    /// Median SPARC of the leading tool's free moves.
    pub smoothness: Option<f64>,
    /// Settings of the rubric.
    pub set: &'a Settings,
}

impl Measured<'_> {
    /// Force that 95 % of a tool's ticks in contact do not exceed, newtons. None below the least time of contact.
    pub fn usual_force(&self, tool: &Pressed) -> Option<f64> {
        tool.p95().filter(|_| tool.seconds() >= self.least_s())
    }

    /// The same for critical errors, newtons: from [`CRITICAL_S`] of contact.
    pub fn critical_force(&self, tool: &Pressed) -> Option<f64> {
        tool.p95().filter(|_| tool.seconds() >= CRITICAL_S)
    }

    /// Share of the working time in which the target was visible, percent. Without zones, a least working time is
    /// needed. With zones, other metrics measure how much was done.
    pub fn visible_percent(&self) -> Option<f64> {
        let hands = &self.evidence.hands;
        let long = hands.span_s().is_some_and(|span| span >= self.least_s());
        let long = long || !self.exercise.zones.is_empty();
        hands.visible_percent().filter(|_| long)
    }

    /// Of the exercise's zones that are `of`: share that is `part`, percent.
    pub fn share(
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

    /// Of the exercise's zones that were probed first and are `of`: share that is `part`, percent.
    /// None if no such zone is `called`, unless calls are `required`.
    pub fn share_once_called(
        &self,
        required: bool,
        of: impl Fn(&SiteGrade) -> bool,
        called: impl Fn(&SiteGrade) -> bool,
        part: impl Fn(&SiteGrade) -> bool,
    ) -> Option<f64> {
        let of = |site: &SiteGrade| site.is_probed_first() && of(site);
        let any = |site: &SiteGrade| site.asked && of(site) && called(site);
        let any = required || self.sites.iter().any(any);
        self.share(of, part).filter(|_| any)
    }

    /// Of the exercise's zones that were called: share with an error of at most `most` millimetres, percent.
    pub fn called_within(&self, most: f64) -> Option<f64> {
        self.share(
            |site| site.called_mm.is_some(),
            |site| site.error_mm().is_some_and(|error| error.abs() <= most),
        )
    }

    /// Mean of called minus prescribed depth over the exercise's zones that were called, mm.
    pub fn mean_error_mm(&self) -> Option<f64> {
        let asked = self.sites.iter().filter(|site| site.asked);
        mean(&asked.filter_map(SiteGrade::error_mm).collect::<Vec<_>>())
    }

    /// Of the exercise's probed zones of one kind: share with the right tilt, percent.
    pub fn angle(&self, proximal: bool) -> Option<f64> {
        self.share(
            |site| site.site.is_proximal() == proximal && site.probed,
            |site| site.tilt_right == Some(true),
        )
    }

    /// Touches of the exercise's teeth.
    fn ours(&self) -> impl Iterator<Item = &Touch> {
        let asked = |touch: &&Touch| {
            self.exercise
                .zones
                .iter()
                .any(|zone| zone.tooth == touch.tooth)
        };
        self.touches.iter().filter(asked)
    }

    /// Share of the touches of the exercise's teeth that are `part`, percent.
    pub fn share_of_touches(&self, part: impl Fn(&Touch) -> bool) -> Option<f64> {
        let part = self.ours().filter(|touch| part(touch)).count();
        percent(part, self.ours().count())
    }

    /// Median step along the exercise's teeth, mm.
    pub fn median_step_mm(&self) -> Option<f64> {
        let ours: Vec<Touch> = self.ours().copied().collect();
        median(&steps(&ours)).map(|step| step * 1e3)
    }

    /// Path of the leading tool's tip through the air, mm.
    pub fn free_path_mm(&self) -> f64 {
        self.evidence.moves[self.evidence.leading].ways().0 * 1e3
    }

    /// Share of the called zones that lie in the longest sequence in the order of the exercise, percent.
    /// The first call of a zone counts.
    pub fn tour_order(&self) -> Option<f64> {
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

    /// Time that an activity must last to have a value, seconds.
    fn least_s(&self) -> f64 {
        let quarter = LEAST_SHARE * self.exercise.duration_s;
        if quarter < LEAST_S { quarter } else { LEAST_S }
    }
}
