//! What to practise next: where most points were lost, with the zones that show it.

use super::definitions;
use super::report::{CriticalError, ShownBy};
use super::rubric::Settings;
use super::sites::{Finding, SiteGrade};
use super::values::{EXACT, FORGIVEN};
use super::{Advice, MetricGrade};

/// Most pieces of advice that are given: more are not heard.
const MOST: usize = 4;
/// A metric with at least this score is no matter for advice.
const GOOD: f64 = 80.0;
/// Most zones that are named.
const MOST_ZONES: usize = 3;

/// The advice of a session: what failed it at once first, then the dearest.
pub fn advice(
    metrics: &[MetricGrade],
    critical: &[CriticalError],
    sites: &[SiteGrade],
    set: &Settings,
) -> Vec<Advice> {
    // Who called before probing has one thing to mend; what was not measured for want of it says nothing of hand and eye.
    let not_charted = |metric: &MetricGrade| {
        metric.name == "zones_charted" && metric.score.is_some_and(|score| score < GOOD)
    };
    let not_charted = metrics.iter().any(not_charted);
    let of_zones = |name: &str| {
        use definitions::Needs::{MidZones, ProximalZones, Zones};
        definitions::find(name)
            .is_some_and(|known| matches!(known.needs, Zones | MidZones | ProximalZones))
    };
    let follows =
        |metric: &MetricGrade| not_charted && metric.value.is_none() && of_zones(metric.name);
    let mut lost: Vec<(f64, &MetricGrade)> = metrics
        .iter()
        .filter_map(|metric| {
            if critical.iter().any(|one| one.metric == metric.name) {
                return Some((f64::INFINITY, metric));
            }
            if follows(metric) {
                return None;
            }
            let score = metric.score.filter(|score| *score < GOOD)?;
            let points = metric.weight * (100.0 - score);
            (points > 0.0).then_some((points, metric))
        })
        .collect();
    // (Stable: of equal ones the table's order.)
    lost.sort_by(|a, b| b.0.total_cmp(&a.0));
    lost.truncate(MOST);
    lost.into_iter()
        .map(|(_, metric)| {
            let known = definitions::find(metric.name).map_or("", |known| known.advice);
            let text = if metric.name.starts_with("called_") {
                of_calls(sites).unwrap_or(known)
            } else {
                known
            };
            Advice {
                metric: metric.name,
                title: metric.title,
                text: text.into(),
                sites: shown_by(metric.name, sites, set),
            }
        })
        .collect()
}

/// Why depths were called wrong, by what most of the zones say whose called depth is not the nearest millimetre; of equal
/// numbers the hand's fault comes before the eye's. None where hand and eye did well in all of these.
fn of_calls(sites: &[SiteGrade]) -> Option<&'static str> {
    let off = |site: &&SiteGrade| {
        let error = site.error_mm();
        site.asked && error.is_some_and(|error| error.abs() > EXACT)
    };
    let count = |finding| {
        let of = sites.iter().filter(off);
        of.filter(|site| site.finding == finding).count()
    };
    let causes = [
        (
            Finding::ReadTooHeavy,
            "The depth was read while the probe was pressed too hard: let the force go back to what is taught, then read.",
        ),
        (
            Finding::ReadTilted,
            "The depth was read along a tilted probe, which shows more: stand it right, then read.",
        ),
        (
            Finding::NeverReachedFloor,
            "The depth was called before the floor was felt: go down to it, then read.",
        ),
        (
            Finding::Misread,
            "The tip was on the floor and the mark was read wrong: call the depth that the band shows, to the millimetre.",
        ),
        (
            Finding::NotProbed,
            "The depth was called where the probe had not been: probe first, then call.",
        ),
    ];
    let counts = causes.map(|(finding, _)| count(finding));
    let most = counts.into_iter().max().filter(|most| *most > 0)?;
    let mut first = causes.into_iter().zip(counts);
    let (cause, _) = first.find(|(_, count)| *count == most)?;
    Some(cause.1)
}

/// The zones that show a weakness, in words.
fn shown_by(metric: &str, sites: &[SiteGrade], set: &Settings) -> Vec<ShownBy> {
    let number = |x: Option<f64>| x.map_or("nothing".into(), |x| format!("{x:.1} mm"));
    let of = |site: &SiteGrade| -> Option<ShownBy> {
        let called = site
            .called_mm
            .map_or("not called".into(), |mm| format!("called {mm}"));
        // (What is prescribed is shown on request alone.)
        let reach = format!("reached {}", number(site.measured_mm.or(site.deepest_mm)));
        let says = match metric {
            "zones_charted" => match site.finding {
                Finding::Missed | Finding::NotProbed | Finding::NotCalled => {
                    site.finding.words().to_owned()
                }
                _ => return None,
            },
            "floor_reached" if site.finding == Finding::NeverReachedFloor => reach,
            "misread" if site.finding == Finding::Misread => format!("{reach}, {called}"),
            "called_exact" | "called_within_1mm" | "called_bias" => {
                let at_fault = !matches!(site.finding, Finding::Right | Finding::Off);
                let most = if at_fault { EXACT } else { 1.0 };
                let error = site.error_mm().filter(|error| error.abs() > most)?;
                let way = if error > 0.0 {
                    "too deep"
                } else {
                    "too shallow"
                };
                format!("{called}, {way}: {}", site.finding.words())
            }
            "touches_too_heavy" | "trauma_events" | "readings_too_heavy" => {
                let heavy = set.force_n[1] + FORGIVEN;
                let force = site.max_force_n.filter(|force| *force > heavy)?;
                format!("up to {force:.2} N")
            }
            "touches_too_light" => {
                let force = site.max_force_n.filter(|force| *force < set.force_n[0])?;
                format!("{force:.2} N at most")
            }
            "readings_held" if site.called_mm.is_some() && !site.is_held() => {
                format!("held for {:.1} s", site.held_s?)
            }
            "angle_mid" if !site.site.is_proximal() && site.tilt_right == Some(false) => {
                format!("{:.0} degrees off the axis", site.tilt_deg?)
            }
            "angle_proximal" if site.site.is_proximal() && site.tilt_right == Some(false) => {
                let (into, all) = (site.into_col_deg?, site.tilt_deg?);
                format!("{all:.0} degrees off the axis, {into:.0} of them into the col")
            }
            "bleeding_agreement" if site.bleeding_called.is_some_and(|said| said != site.bled) => {
                if site.bled { "bled" } else { "did not bleed" }.to_owned()
            }
            _ => return None,
        };
        Some(ShownBy {
            tooth: site.tooth,
            says: format!("{}: {says}", site.site.name()),
        })
    };
    let mut asked: Vec<&SiteGrade> = sites.iter().filter(|site| site.asked).collect();
    if matches!(
        metric,
        "touches_too_heavy" | "trauma_events" | "readings_too_heavy"
    ) {
        // The heaviest first: they are what it is about.
        let force = |site: &SiteGrade| site.max_force_n.unwrap_or_default();
        asked.sort_by(|a, b| force(b).total_cmp(&force(a)));
    }
    asked.into_iter().filter_map(of).take(MOST_ZONES).collect()
}
