//! Division of surface samples into at most eight parts. Each part is a piece of surface that one ball can follow.
//!
//! The method is k-means++ seeds and balanced Lloyd steps in six dimensions: place and inscribed-ball centre.

use sulcus_core::tree::MAX_CHILDREN;

use crate::random::Random;

/// Place and ball centre of a sample, weighted.
pub(crate) type Feature = [f64; 6];

const LLOYD_STEPS: usize = 14;
/// Strength of the balance: a part larger than its share appears farther away.
const BALANCE: f64 = 0.35;

/// Divides `0..features.len()` into at most `parts` of about the same weight; none is empty.
pub(crate) fn split(
    features: &[Feature],
    weights: &[f64],
    parts: usize,
    random: &mut Random,
) -> Vec<Vec<u32>> {
    let parts = parts.min(MAX_CHILDREN).min(features.len());
    let mut centres = seeds(features, weights, parts, random);
    let mut labels = vec![0_usize; features.len()];
    let mut handicap = vec![1.0; centres.len()];
    let total: f64 = weights.iter().sum();
    for step in 0..=LLOYD_STEPS {
        let mut sums = vec![[0.0; 6]; centres.len()];
        let mut held = vec![0.0; centres.len()];
        for ((label, feature), weight) in labels.iter_mut().zip(features).zip(weights) {
            let mut best = (f64::INFINITY, 0);
            for (k, centre) in centres.iter().enumerate() {
                let apart = squared(feature, centre) * handicap[k];
                if apart < best.0 {
                    best = (apart, k);
                }
            }
            *label = best.1;
            held[best.1] += weight;
            for (sum, x) in sums[best.1].iter_mut().zip(feature) {
                *sum += weight * x;
            }
        }
        if step == LLOYD_STEPS {
            break;
        }
        let share = total / centres.len() as f64;
        for k in 0..centres.len() {
            if held[k] > 0.0 {
                centres[k] = sums[k].map(|sum| sum / held[k]);
            }
            let wanted = libm::pow((held[k] / share).max(0.05), BALANCE);
            // Half of the correction each time; otherwise parts exchange samples forever.
            handicap[k] = 0.5 * (handicap[k] + handicap[k] * wanted).clamp(0.05, 40.0);
        }
    }
    let mut split = vec![Vec::new(); centres.len()];
    for (sample, &label) in labels.iter().enumerate() {
        split[label].push(sample as u32);
    }
    split.retain(|part| !part.is_empty());
    split
}

fn seeds(features: &[Feature], weights: &[f64], parts: usize, random: &mut Random) -> Vec<Feature> {
    let first = ((random.unit() * features.len() as f64) as usize).min(features.len() - 1);
    let mut centres = vec![features[first]];
    let mut apart = vec![f64::INFINITY; features.len()];
    while centres.len() < parts {
        let latest = centres[centres.len() - 1];
        let mut total = 0.0;
        for ((apart, feature), weight) in apart.iter_mut().zip(features).zip(weights) {
            *apart = apart.min(weight * squared(feature, &latest));
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
        centres.push(features[chosen.unwrap_or(features.len() - 1)]);
    }
    centres
}

fn squared(a: &Feature, b: &Feature) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}
