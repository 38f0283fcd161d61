//! Splitting a set of surface samples into at most eight parts: k-means++ seeds and balanced Lloyd
//! steps in six dimensions, place and inscribed-ball centre, so that a part is a piece of surface
//! that one ball can follow.

use sulcus_core::tree::MAX_CHILDREN;

use crate::random::Random;

/// Place and ball centre of a sample, weighted.
pub(crate) type Feature = [f64; 6];

const LLOYD_STEPS: usize = 14;
/// How strongly a part that is larger than its share is made to look farther away.
const BALANCE: f64 = 0.35;

/// Splits `members` (indices into `features`) into at most `parts`; none is empty.
pub(crate) fn split(
    features: &[Feature],
    members: &[u32],
    parts: usize,
    random: &mut Random,
) -> Vec<Vec<u32>> {
    let parts = parts.min(MAX_CHILDREN).min(members.len());
    let mut centres = seeds(features, members, parts, random);
    let mut labels = vec![0_usize; members.len()];
    let mut handicap = vec![1.0; centres.len()];
    for step in 0..=LLOYD_STEPS {
        let mut sums = vec![[0.0; 6]; centres.len()];
        let mut counts = vec![0_usize; centres.len()];
        for (label, &member) in labels.iter_mut().zip(members) {
            let feature = &features[member as usize];
            let mut best = (f64::INFINITY, 0);
            for (k, centre) in centres.iter().enumerate() {
                let apart = squared(feature, centre) * handicap[k];
                if apart < best.0 {
                    best = (apart, k);
                }
            }
            *label = best.1;
            counts[best.1] += 1;
            for (sum, x) in sums[best.1].iter_mut().zip(feature) {
                *sum += x;
            }
        }
        if step == LLOYD_STEPS {
            break;
        }
        let share = members.len() as f64 / centres.len() as f64;
        for k in 0..centres.len() {
            if counts[k] > 0 {
                centres[k] = sums[k].map(|sum| sum / counts[k] as f64);
            }
            let wanted = libm::pow((counts[k] as f64 / share).max(0.05), BALANCE);
            // Half-way each time, or parts swap samples for ever.
            handicap[k] = 0.5 * (handicap[k] + handicap[k] * wanted).clamp(0.05, 40.0);
        }
    }
    let mut split = vec![Vec::new(); centres.len()];
    for (&label, &member) in labels.iter().zip(members) {
        split[label].push(member);
    }
    split.retain(|part| !part.is_empty());
    split
}

fn seeds(features: &[Feature], members: &[u32], parts: usize, random: &mut Random) -> Vec<Feature> {
    let pick = |random: &mut Random| {
        members[((random.unit() * members.len() as f64) as usize).min(members.len() - 1)]
    };
    let mut centres = vec![features[pick(random) as usize]];
    let mut apart = vec![f64::INFINITY; members.len()];
    while centres.len() < parts {
        let latest = centres[centres.len() - 1];
        let mut total = 0.0;
        for (apart, &member) in apart.iter_mut().zip(members) {
            *apart = apart.min(squared(&features[member as usize], &latest));
            total += *apart;
        }
        if total <= 0.0 {
            break;
        }
        let mut left = random.unit() * total;
        let chosen = apart.iter().position(|a| {
            left -= a;
            left < 0.0
        });
        centres.push(features[members[chosen.unwrap_or(members.len() - 1)] as usize]);
    }
    centres
}

fn squared(a: &Feature, b: &Feature) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}
