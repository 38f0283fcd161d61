//! Stress of the neo-Hookean solid to second order.

use crate::math::Mat3;

/// Returns the part of the first Piola-Kirchhoff stress that is quadratic in the displacement gradient `g`, divided by
/// Young's modulus. `poisson` is Poisson's ratio. Neither result nor `g` has a unit.
///
/// The energy density is `mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2` (Bonet and Wood 2008, chapter 6). With `t = tr g` and
/// `j = (t^2 - tr g^2) / 2`, the second order of the volume's change, the part is
///
/// `mu (A2 - 2/3 t A1) + K ((j + t^2) 1 - t g')`, `A1 = g + g' - 2/3 t 1`, `A2 = 2/3 t g' - g'g' - |g|^2/3 1`.
pub fn quadratic_stress(g: &Mat3, poisson: f64) -> Mat3 {
    let (mu, bulk) = (0.5 / (1.0 + poisson), 1.0 / (3.0 * (1.0 - 2.0 * poisson)));
    let (one, turned, t) = (Mat3::identity(), g.transpose(), g.trace());
    let square = turned * turned;
    let j = 0.5 * (t * t - square.trace());
    let first = g + turned - one * (2.0 / 3.0 * t);
    let second = turned * (2.0 / 3.0 * t) - square - one * (g.dot(g) / 3.0);
    (second - first * (2.0 / 3.0 * t)) * mu + (one * (j + t * t) - turned * t) * bulk
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fmax;

    /// Returns the whole stress for the deformation gradient `f`, over Young's modulus.
    fn stress(f: &Mat3, poisson: f64) -> Mat3 {
        let (mu, bulk) = (0.5 / (1.0 + poisson), 1.0 / (3.0 * (1.0 - 2.0 * poisson)));
        let j = f.determinant();
        let back = f.try_inverse().expect("regular").transpose();
        (f - back * (f.dot(f) / 3.0)) * (mu / libm::cbrt(j * j)) + back * (bulk * (j - 1.0) * j)
    }

    #[test]
    fn is_the_second_derivative_of_the_stress() {
        for k in 0..20 {
            let g = Mat3::from_fn(|i, j| libm::sin(f64::from(k) * 1.7 + 3.0 * i as f64 + j as f64));
            let (h, poisson) = (1e-4, 0.02 * f64::from(k));
            let at = |h: f64| stress(&(Mat3::identity() + g * h), poisson);
            // Even part of the stress along a line; the odd part cancels.
            let found = (at(h) + at(-h)) * (0.5 / (h * h));
            let exact = quadratic_stress(&g, poisson);
            let (off, size) = ((found - exact).norm(), exact.norm());
            assert!(off <= 1e-5 * fmax(size, 1.0), "{k}: {off:e} of {size}");
        }
    }

    #[test]
    fn is_the_gradient_of_a_cubic_energy() {
        // The slope of a gradient is symmetric: `P2(g).h` changes along `d` as `P2(g).d` along `h`.
        let mats: Vec<Mat3> = (0..3)
            .map(|k| {
                Mat3::from_fn(|i, j| libm::cos(f64::from(k) + 2.1 * i as f64 + 0.9 * j as f64))
            })
            .collect();
        let slope = |g: &Mat3, d: &Mat3| {
            (quadratic_stress(&(g + d), 0.49) - quadratic_stress(&(g - d), 0.49)) * 0.5
        };
        let (g, d, h) = (&mats[0], &mats[1], &mats[2]);
        let (a, b) = (slope(g, d).dot(h), slope(g, h).dot(d));
        assert!((a - b).abs() < 1e-12 * a.abs(), "{a} {b}");
    }
}
