//! Patients from a seed: as healthy or as diseased as asked for, the same on every machine.

use serde::{Deserialize, Serialize};
use sulcus_core::tissue::gingiva::Site;

use super::{Furcations, LOWER, Patient, Sides, ToothChart};
use crate::random::Random;

/// What a generated patient has. Depths are whole millimetres, as they are charted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Depths of 1 to 3 mm, hardly any bleeding.
    Healthy,
    /// Swollen margins, depths of 2 to 4 mm, bleeding at every other site; no attachment lost.
    Gingivitis,
    /// Attachment lost beside several teeth: depths up to 7 mm, recession, furcations, a missing tooth now and then.
    #[default]
    Periodontitis,
}

impl Condition {
    /// All of them.
    pub const ALL: [Condition; 3] = [
        Condition::Healthy,
        Condition::Gingivitis,
        Condition::Periodontitis,
    ];

    /// Name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Condition::Healthy => "healthy",
            Condition::Gingivitis => "gingivitis",
            Condition::Periodontitis => "periodontitis",
        }
    }
}

impl std::str::FromStr for Condition {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|c| c.name() == name);
        found.ok_or_else(|| {
            format!("condition is `{name}`, expected healthy, gingivitis or periodontitis")
        })
    }
}

/// Share of patients with periodontitis that lack a tooth.
const LACKING: f64 = 0.3;
/// Share of teeth that such a patient's disease has reached; molars more often.
const REACHED: [f64; 2] = [0.35, 0.7];
/// Farthest above the CEJ that a margin stands, mm: the papilla has no more room under the contact.
const HIGHEST: f64 = -2.5;
/// Attachment loss at a mid site that opens a molar's furcation, and for each further degree, mm.
const FURCATION: f64 = 4.0;

/// A patient of that condition from a seed.
pub fn generate(seed: u64, condition: Condition) -> Patient {
    let mut random = Random::new(seed ^ (condition as u64 + 1) << 56);
    // The first numbers of neighbouring seeds are alike.
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

/// One papilla fills the gap between two teeth: what it has lost it has lost on both sides.
fn share_papillae(teeth: &mut [ToothChart]) {
    for k in 1..teeth.len() {
        let (before, after) = teeth.split_at_mut(k);
        let (Some(right), Some(left)) = (before.last_mut(), after.first_mut()) else {
            continue;
        };
        // (In the order of `LOWER`; 41 and 31 meet mesially.)
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
            // (`to` included.)
            (from + random.unit() * (to - from + 1.0)).floor()
        };
        (depths[k], recessions[k]) = if sick {
            let loss = whole(2.0, 2.0 + 4.5 * severity, random);
            let across = depths[5 - k];
            let depth = if proximal && across > 0.0 {
                // The same col from the other side.
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
