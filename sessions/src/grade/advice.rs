//! Advice to a learner: the metrics that cost most points, with the zones that show the weakness.

use super::definitions;
use super::report::{CriticalError, ShownBy};
use super::settings::Settings;
use super::sites::{Finding, SiteGrade};
use super::tolerances::{EXACT_MM, TREMOR_N};
use super::{Advice, MetricGrade};

/// Largest number of pieces of advice. Chosen: a learner can attend to a few.
const MOST: usize = 4;
/// Score from which a metric needs no advice. Chosen.
const GOOD: f64 = 80.0;
/// Largest number of zones that a piece of advice names.
const MOST_ZONES: usize = 3;

/// Advice of a session: metrics of critical errors first, then by points lost.
pub fn advice(
    metrics: &[MetricGrade],
    critical: &[CriticalError],
    sites: &[SiteGrade],
    set: &Settings,
) -> Vec<Advice> {
    // Zones that were not charted leave other metrics of zones without a value. These need no advice of their own.
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
    // The sort is stable: equal losses keep the order of the table.
    lost.sort_by(|a, b| b.0.total_cmp(&a.0));
    lost.truncate(MOST);
    let lost = lost.into_iter().map(|(_, metric)| {
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
    });
    lost.chain(not_judged(metrics)).collect()
}

/// Advice on the metrics that are not judged, after all other advice: one piece, with the first metric of the most
/// weight.
fn not_judged(metrics: &[MetricGrade]) -> Option<Advice> {
    let not = metrics.iter().filter(|metric| metric.not_judged.is_some());
    let first = not.reduce(|a, b| if b.weight > a.weight { b } else { a })?;
    let why = first.not_judged.as_deref()?;
    Some(Advice {
        metric: first.name,
        title: first.title,
        text: format!(
            "Not judged: {why}. Repeat the exercise with a device that displays this force."
        ),
        sites: Vec::new(),
    })
}

/// Advice on calls: the most frequent finding of the zones whose call is not exact. Of equally frequent findings, a
/// fault of the hand comes first. None if hand and eye were right in all of these zones.
fn of_calls(sites: &[SiteGrade]) -> Option<&'static str> {
    let off = |site: &&SiteGrade| {
        let error = site.error_mm();
        site.asked && error.is_some_and(|error| error.abs() > EXACT_MM)
    };
    let count = |finding| {
        let of = sites.iter().filter(off);
        of.filter(|site| site.finding == finding).count()
    };
    let causes = [
        (
            Finding::ReadTooHeavy,
            "The depth was read while the probe was pressed too hard: go back to the taught force, then read.",
        ),
        (
            Finding::ReadTilted,
            "The depth was read along a tilted probe, which shows more: correct the tilt, then read.",
        ),
        (
            Finding::NeverReachedFloor,
            "The depth was called before the tip reached the floor: go down to the floor, then read.",
        ),
        (
            Finding::Misread,
            "The tip was on the floor, but the band was misread: call the depth that the band shows, to the millimetre.",
        ),
        (
            Finding::NotProbed,
            "The depth was called before the zone was probed: probe first, then call.",
        ),
    ];
    let counts = causes.map(|(finding, _)| count(finding));
    let most = counts.into_iter().max().filter(|most| *most > 0)?;
    let mut first = causes.into_iter().zip(counts);
    let (cause, _) = first.find(|(_, count)| *count == most)?;
    Some(cause.1)
}

/// Zones that show a weakness, in words, at most [`MOST_ZONES`].
fn shown_by(metric: &str, sites: &[SiteGrade], set: &Settings) -> Vec<ShownBy> {
    let number = |x: Option<f64>| x.map_or("no depth".into(), |x| format!("{x:.1} mm"));
    let of = |site: &SiteGrade| -> Option<ShownBy> {
        let called = site
            .called_mm
            .map_or("not called".into(), |mm| format!("called {mm}"));
        // Prescribed values appear on request only.
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
                let most = if at_fault { EXACT_MM } else { 1.0 };
                let error = site.error_mm().filter(|error| error.abs() > most)?;
                let way = if error > 0.0 {
                    "too deep"
                } else {
                    "too shallow"
                };
                format!("{called}, {way}: {}", site.finding.words())
            }
            "touches_too_heavy" | "trauma_events" | "readings_too_heavy" => {
                let heavy = set.force_n[1] + TREMOR_N;
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
        // Zones with the largest forces come first.
        let force = |site: &SiteGrade| site.max_force_n.unwrap_or_default();
        asked.sort_by(|a, b| force(b).total_cmp(&force(a)));
    }
    asked.into_iter().filter_map(of).take(MOST_ZONES).collect()
}
