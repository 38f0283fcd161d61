//! Colours as CIE L*a*b* (D65) and as sRGB.

/// Colour: L 0 to 100, a red against green, b yellow against blue.
pub(crate) type Lab = [f64; 3];

/// White point D65.
const WHITE: [f64; 3] = [0.95047, 1.0, 1.08883];

/// Colour between `a` (share 0) and `b` (share 1).
pub(crate) fn mix(a: Lab, b: Lab, share: f64) -> Lab {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

/// Returns the opaque sRGB colour. Colours beyond sRGB are limited.
pub(crate) fn srgb(lab: Lab) -> [u8; 4] {
    let y = (lab[0] + 16.0) / 116.0;
    let whole = |t: f64| {
        if t > 6.0 / 29.0 {
            t * t * t
        } else {
            3.0 * (6.0 / 29.0) * (6.0 / 29.0) * (t - 4.0 / 29.0)
        }
    };
    let [x, y, z] = [
        WHITE[0] * whole(y + lab[1] / 500.0),
        WHITE[1] * whole(y),
        WHITE[2] * whole(y - lab[2] / 200.0),
    ];
    let linear = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    let [r, g, b] = linear.map(|c| {
        let coded = if c <= 0.003_130_8 {
            12.92 * c
        } else {
            1.055 * libm::pow(c, 1.0 / 2.4) - 0.055
        };
        // The conversion limits to the range of 8 bits.
        (255.0 * coded).round() as u8
    });
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_colours() {
        assert_eq!(srgb([100.0, 0.0, 0.0]), [255, 255, 255, 255]);
        assert_eq!(srgb([0.0, 0.0, 0.0]), [0, 0, 0, 255]);
        // Attached gingiva and alveolar mucosa, by another program.
        for (lab, rgb) in [
            ([56.0, 25.0, 16.0], [183, 117, 108]),
            ([48.0, 31.0, 17.0], [169, 92, 87]),
        ] {
            for (found, wanted) in srgb(lab).iter().zip(rgb) {
                assert!(found.abs_diff(wanted) <= 1, "{lab:?}: {found} {wanted}");
            }
        }
    }
}
