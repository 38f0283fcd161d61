//! Patients from a seed, by condition. A seed gives the same patient on every machine.

use sulcus_core::tissue::gingiva::Site;

use super::chart::{Furcations, Patient, ToothChart};
use super::sides::Sides;
use crate::file::{Condition, LOWER};
use crate::random::Random;

/// Share of patients with periodontitis that lack a tooth.
const LACKING: f64 = 0.3;
/// Share of teeth that the disease has reached in such a patient; the second number is for molars.
const REACHED: [f64; 2] = [0.35, 0.7];
/// Highest margin over the CEJ, mm, as a negative recession. A higher papilla has no room under the contact.
const HIGHEST: f64 = -2.5;
/// Attachment loss at a mid site that opens a molar's furcation, and for each further degree, mm.
const FURCATION: f64 = 4.0;

/// Returns the patient of a condition and a seed.
pub fn generate(seed: u64, condition: Condition) -> Patient {
    let mut random = Random::new(seed ^ (condition as u64 + 1) << 56);
    // The first numbers of neighbouring seeds are similar.
    for _ in 0..8 {
        random.unit();
    }
    let mut missing = Vec::new();
    if condition == Condition::Periodontitis && random.unit() < LACKING {
        // A premolar or a molar.
        let lost = [34, 35, 36, 44, 45, 46][(random.unit() * 6.0) as usize];
        missing.push(lost);
    }
    let severity = random.between(0.4, 1.0);
    let mut teeth: Vec<ToothChart> = LOWER
        .into_iter()
        .filter(|fdi| !missing.contains(fdi))
        .map(|fdi| tooth(fdi, condition, severity, &mut random))
        .collect();
    share_papillae(&mut teeth);
    Patient {
        name: format!("generated {} {seed}", condition.name()),
        missing,
        teeth,
    }
}

/// Copies losses of a papilla to both its sides: one papilla fills the gap between two teeth.
fn share_papillae(teeth: &mut [ToothChart]) {
    for k in 1..teeth.len() {
        let (before, after) = teeth.split_at_mut(k);
        let (Some(right), Some(left)) = (before.last_mut(), after.first_mut()) else {
            continue;
        };
        // The order is that of `LOWER`; 41 and 31 meet mesially.
        let [towards_left, towards_right] = [
            if right.fdi / 10 == 4 { 0 } else { 2 },
            if left.fdi / 10 == 4 { 2 } else { 0 },
        ];
        let sides = [
            (
                &mut right.recession_mm.buccal,
                &mut left.recession_mm.buccal,
            ),
            (
                &mut right.recession_mm.lingual,
                &mut left.recession_mm.lingual,
            ),
        ];
        for (a, b) in sides {
            let shared = a[towards_left].min(b[towards_right]);
            (a[towards_left], b[towards_right]) = (shared, shared);
        }
    }
}

fn tooth(fdi: u8, condition: Condition, severity: f64, random: &mut Random) -> ToothChart {
    let molar = fdi % 10 >= 6;
    let sick = condition == Condition::Periodontitis && random.unit() < REACHED[usize::from(molar)];
    let (inflammation, share_bleeding) = match condition {
        _ if sick => (random.between(0.3, 0.7), 0.6),
        Condition::Healthy => (0.0, 0.04),
        Condition::Gingivitis => (random.between(0.3, 0.7), 0.5),
        Condition::Periodontitis => (random.between(0.0, 0.3), 0.15),
    };
    let (mut depths, mut recessions, mut bleeding) = ([0.0; 6], [0.0; 6], [false; 6]);
    for site in Site::ALL {
        let proximal = site.is_proximal();
        let k = site as usize;
        let whole = |from: f64, to: f64, random: &mut Random| {
            // `to` is included.
            (from + random.unit() * (to - from + 1.0)).floor()
        };
        (depths[k], recessions[k]) = if sick {
            let loss = whole(2.0, 2.0 + 4.5 * severity, random);
            let across = depths[5 - k];
            let depth = if proximal && across > 0.0 {
                // The same col, read from the other side.
                (across + whole(-1.0, 1.0, random)).clamp(3.0, 7.0)
            } else if proximal {
                whole(4.0, 3.0 + 4.0 * severity, random)
            } else {
                whole(2.0, 2.0 + 2.5 * severity, random)
            };
            (depth, (loss - depth).clamp(HIGHEST, 2.0))
        } else if condition == Condition::Gingivitis {
            (
                whole(2.0, if proximal { 4.0 } else { 3.0 }, random),
                HIGHEST,
            )
        } else {
            let depth = if proximal {
                whole(2.0, 3.0, random)
            } else {
                whole(1.0, 2.0, random)
            };
            (depth, if proximal { HIGHEST } else { -2.0 })
        };
        bleeding[k] = random.unit() < share_bleeding * if depths[k] >= 4.0 { 1.4 } else { 1.0 };
    }
    let loss = |site: Site| depths[site as usize] + recessions[site as usize];
    let degree = |site: Site| {
        let beyond = loss(site) - FURCATION;
        if molar && beyond >= 0.0 {
            1 + u8::from(beyond >= 1.5)
        } else {
            0
        }
    };
    let furcation = Furcations {
        buccal: degree(Site::Buccal),
        lingual: degree(Site::Lingual),
    };
    let worst = Site::ALL.map(loss).into_iter().fold(0.0, f64::max);
    ToothChart {
        fdi,
        depth_mm: Sides::from_round(depths),
        recession_mm: Sides::from_round(recessions),
        bleeding: Sides::from_round(bleeding),
        inflammation: (inflammation * 10.0).round() / 10.0,
        furcation,
        mobility: if worst >= 7.0 {
            2
        } else {
            u8::from(worst >= 5.0)
        },
    }
}
