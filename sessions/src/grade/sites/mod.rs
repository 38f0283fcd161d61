//! Zones of a graded session: those of the exercise, then other zones that were called.

mod cause;
mod finding;
mod site_grade;

use std::collections::BTreeMap;

use sulcus_core::Scene;
use sulcus_core::tissue::gingiva::{Prescribed, Site};

use super::evidence::Evidence;
use super::patient::PatientChart;
use super::settings::Settings;
use super::stats::rounded;
use crate::exercise::Exercise;
use crate::exercise::events::call::Call;
use crate::exercise::events::pocket;

pub use finding::Finding;
pub use site_grade::SiteGrade;
#[cfg(test)]
pub use site_grade::{HELD_S, PRESSED_S, READ_MM};

/// Values that a scene prescribes at a site of a tooth. None if the scene has no such pocket.
pub fn prescribed(scene: &Scene, tooth: u8, site: Site) -> Option<Prescribed> {
    let pockets = pocket::all(scene);
    let pocket = pockets.iter().find(|pocket| pocket.fdi == tooth)?;
    Some(*pocket.gingiva(scene)?.prescribed(site))
}

/// Calls of a zone, merged.
#[derive(Clone, Copy)]
struct Heard {
    call: Call,
    /// Whether a call came after the zone was probed.
    felt: bool,
}

/// Zones of the exercise that the scene has, in its order, then other called zones, by tooth and site.
/// `calls` are the calls with the last tick before each.
pub fn sites(
    scene: &Scene,
    exercise: &Exercise,
    evidence: &Evidence,
    calls: &[(u64, Call)],
    patient: Option<&PatientChart>,
    set: &Settings,
) -> Vec<SiteGrade> {
    let mut called: BTreeMap<(u8, Site), Heard> = BTreeMap::new();
    for (tick, call) in calls {
        let before = called.get(&(call.tooth, call.site)).copied();
        let stayed = evidence.zones.of(call.tooth, call.site);
        let stayed = stayed.and_then(|seen| seen.stayed_at);
        let felt = stayed.is_some_and(|since| *tick >= since);
        // A later call replaces the depth, and of the other findings those that it contains.
        let kept = before.map_or(*call, |before| before.call);
        let merged = Call {
            recession_mm: call.recession_mm.or(kept.recession_mm),
            bleeding: call.bleeding.or(kept.bleeding),
            furcation: call.furcation.or(kept.furcation),
            ..*call
        };
        let heard = Heard {
            call: merged,
            felt: felt || before.is_some_and(|before| before.felt),
        };
        called.insert((call.tooth, call.site), heard);
    }
    let mut asked: Vec<(u8, Site)> = Vec::new();
    for zone in exercise.tour() {
        if !asked.contains(&zone) && prescribed(scene, zone.0, zone.1).is_some() {
            asked.push(zone);
        }
    }
    let more = called.keys().filter(|zone| !asked.contains(zone));
    let all: Vec<((u8, Site), bool)> = (asked.iter().map(|zone| (*zone, true)))
        .chain(more.map(|zone| (*zone, false)))
        .collect();
    let grade = |((tooth, site), asked)| {
        let call = called.get(&(tooth, site));
        let mut grade = one(scene, (tooth, site, asked), evidence, call, set);
        let said = patient.filter(|_| SiteGrade::is_furcation(tooth, site));
        grade.furcation_truth = said.map(|chart| chart.furcation(tooth, site.is_buccal()));
        grade
    };
    all.into_iter().map(grade).collect()
}

fn one(
    scene: &Scene,
    (tooth, site, asked): (u8, Site, bool),
    evidence: &Evidence,
    heard: Option<&Heard>,
    set: &Settings,
) -> SiteGrade {
    let mm = |metres: f64| rounded(metres * 1e3, 2);
    let truth = prescribed(scene, tooth, site);
    let seen = evidence.zones.of(tooth, site);
    let stood = evidence.zones.stood(tooth, site);
    let call = heard.map(|heard| &heard.call);
    let mut grade = SiteGrade {
        tooth,
        site,
        asked,
        probed: seen.is_some_and(|seen| seen.stayed_at.is_some()),
        truth_mm: truth.map(|truth| mm(truth.depth)),
        measured_mm: seen.and_then(|seen| seen.measured).map(mm),
        called_mm: call.map(|call| call.depth_mm),
        deepest_mm: seen.map(|seen| mm(seen.deepest)),
        shown_mm: stood.map(|stood| mm(stood.shown())),
        max_force_n: seen.map(|seen| rounded(seen.max_force, 3)),
        held_s: seen.map(|seen| rounded(seen.held, 3)),
        pressed_s: seen.map(|seen| rounded(seen.pressed, 3)),
        tilt_deg: stood.map(|stood| rounded(stood.tilt().to_degrees(), 1)),
        into_col_deg: stood
            .filter(|_| site.is_proximal())
            .map(|stood| rounded(stood.towards_col().to_degrees(), 1)),
        tilt_right: stood.map(|stood| stood.is_right()),
        recession_truth_mm: truth.map(|truth| mm(truth.recession)),
        recession_called_mm: call.and_then(|call| call.recession_mm),
        bled: evidence.bled.contains(&(tooth, site)),
        bleeding_called: call.and_then(|call| call.bleeding),
        furcation_truth: None,
        furcation_called: call.and_then(|call| call.furcation),
        finding: Finding::Missed,
    };
    let heard_before = heard.is_some_and(|heard| !heard.felt);
    grade.finding = grade.find(grade.probed && !heard_before, set);
    grade
}
