//! Magnitudes of a discrete Fourier transform: radix 2, in place, twiddle factors by libm.
//!
//! The bits are the same on every machine. A library that selects its code by the processor gives other last bits.

use std::f64::consts::PI;

/// Transforms in place. Both slices have the same length, a power of two; other slices stay unchanged.
fn transform(re: &mut [f64], im: &mut [f64]) {
    let n = re.len();
    if !n.is_power_of_two() || im.len() != n || n < 2 {
        return;
    }
    let bits = n.trailing_zeros();
    for k in 0..n {
        let other = k.reverse_bits() >> (usize::BITS - bits);
        if k < other {
            re.swap(k, other);
            im.swap(k, other);
        }
    }
    let mut half = 1;
    while half < n {
        let twiddles: Vec<(f64, f64)> = (0..half)
            .map(|k| {
                let angle = -PI * k as f64 / half as f64;
                (libm::cos(angle), libm::sin(angle))
            })
            .collect();
        for from in (0..n).step_by(2 * half) {
            for (k, (cos, sin)) in twiddles.iter().enumerate() {
                let (a, b) = (from + k, from + k + half);
                let (x, y) = (re[b] * cos - im[b] * sin, re[b] * sin + im[b] * cos);
                (re[b], im[b]) = (re[a] - x, im[a] - y);
                (re[a], im[a]) = (re[a] + x, im[a] + y);
            }
        }
        half *= 2;
    }
}

/// Magnitudes of the transform of a real signal, padded with zeros to `n`, a power of two. The result has `n` values.
pub fn magnitudes(signal: &[f64], n: usize) -> Vec<f64> {
    let mut re = vec![0.0; n];
    let mut im = vec![0.0; n];
    let used = signal.len().min(n);
    re[..used].copy_from_slice(&signal[..used]);
    transform(&mut re, &mut im);
    let both = re.iter().zip(&im);
    both.map(|(x, y)| (x * x + y * y).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_sum_by_definition() {
        let signal: Vec<f64> = (0..13).map(|k| f64::from(k * k % 7) - 2.5).collect();
        let n = 32;
        for (k, found) in magnitudes(&signal, n).into_iter().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (t, x) in signal.iter().enumerate() {
                let angle = -2.0 * PI * (k * t) as f64 / n as f64;
                re += x * libm::cos(angle);
                im += x * libm::sin(angle);
            }
            let exact = (re * re + im * im).sqrt();
            assert!((found - exact).abs() < 1e-12, "{k}: {found} {exact}");
        }
    }

    #[test]
    fn one_wave_is_one_line() {
        // A wave of amplitude 1 over 64 samples has lines of 32 at its frequency and at the mirror frequency.
        let wave: Vec<f64> = (0..64)
            .map(|t| libm::cos(2.0 * PI * 5.0 * f64::from(t) / 64.0))
            .collect();
        let lines = magnitudes(&wave, 64);
        for (k, line) in lines.iter().enumerate() {
            let exact = if k == 5 || k == 59 { 32.0 } else { 0.0 };
            assert!((line - exact).abs() < 1e-12, "{k}: {line}");
        }
    }
}
