//! Statistics with a fixed order of summation.

/// Median of sorted numbers. For an even count: the mean of the middle two. None for an empty list.
pub fn median(sorted: &[f64]) -> Option<f64> {
    let n = sorted.len();
    match n {
        0 => None,
        n if n % 2 == 1 => Some(sorted[n / 2]),
        n => Some(0.5 * (sorted[n / 2 - 1] + sorted[n / 2])),
    }
}

/// Mean. None for an empty list.
pub fn mean(all: &[f64]) -> Option<f64> {
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

/// Share of `part` in `of`, percent. None for `of` 0.
pub fn percent(part: usize, of: usize) -> Option<f64> {
    (of > 0).then(|| 100.0 * part as f64 / of as f64)
}

/// Number rounded to some digits after the point, ties away from zero. The result is never -0.
pub fn rounded(x: f64, digits: u32) -> f64 {
    let scale = f64::from(10u32.pow(digits));
    let near = (x * scale).round() / scale;
    if near == 0.0 { 0.0 } else { near }
}

/// Length of the longest increasing subsequence of `of`.
pub fn longest_rising(of: &[usize]) -> usize {
    let mut tails: Vec<usize> = Vec::new();
    for x in of {
        let at = tails.partition_point(|tail| tail < x);
        if at == tails.len() {
            tails.push(*x);
        } else {
            tails[at] = *x;
        }
    }
    tails.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_by_hand() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[1.0, 2.0, 10.0]), Some(2.0));
        assert_eq!(median(&[1.0, 2.0, 4.0, 10.0]), Some(3.0));
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(percent(3, 8), Some(37.5));
        assert_eq!(percent(0, 0), None);
        assert_eq!(rounded(2.345_678, 2), 2.35);
        assert_eq!(rounded(-0.001, 1).to_bits(), 0.0f64.to_bits());
        for (of, longest) in [
            (&[][..], 0),
            (&[0, 1, 2], 3),
            (&[2, 1, 0], 1),
            (&[0, 3, 1, 2, 5, 4], 4),
        ] {
            assert_eq!(longest_rising(of), longest, "{of:?}");
        }
    }
}
