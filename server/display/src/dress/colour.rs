//! Colours by lightness and hue.

use sulcus_core::math::fclamp;

/// CIE L*a*b* colour under D65: lightness 0 to 100, red against green, yellow against blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lab(pub [f64; 3]);

/// White of D65 in XYZ (CIE 15).
const WHITE: [f64; 3] = [0.95047, 1.0, 1.08883];
/// Linear sRGB from XYZ (IEC 61966-2-1).
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.2406, -1.5372, -0.4986],
    [-0.9689, 1.8758, 0.0415],
    [0.0557, -0.2040, 1.0570],
];

impl Lab {
    /// Returns the mixture with a share of another colour, 0 to 1.
    pub fn mix(self, other: Self, share: f64) -> Self {
        let share = fclamp(share, 0.0, 1.0);
        Self(std::array::from_fn(|k| {
            self.0[k] + (other.0[k] - self.0[k]) * share
        }))
    }

    /// Returns the colour moved by differences of the three numbers.
    pub fn moved(self, by: [f64; 3]) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + by[k]))
    }

    /// Returns the opaque sRGB colour. Colours outside the gamut are limited channel by channel.
    pub fn to_srgb(self) -> [u8; 4] {
        let [l, a, b] = self.0;
        let y = (l + 16.0) / 116.0;
        let cubed = |t: f64| {
            if t > 6.0 / 29.0 {
                t * t * t
            } else {
                3.0 * (6.0 / 29.0) * (6.0 / 29.0) * (t - 4.0 / 29.0)
            }
        };
        let xyz = [
            WHITE[0] * cubed(y + a / 500.0),
            WHITE[1] * cubed(y),
            WHITE[2] * cubed(y - b / 200.0),
        ];
        let channel = |row: &[f64; 3]| {
            let linear = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
            let shown = if linear > 0.003_130_8 {
                1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
            } else {
                12.92 * linear
            };
            libm::round(255.0 * fclamp(shown, 0.0, 1.0)) as u8
        };
        let [r, g, b] = [
            channel(&FROM_XYZ[0]),
            channel(&FROM_XYZ[1]),
            channel(&FROM_XYZ[2]),
        ];
        [r, g, b, 255]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_colours_come_out_as_known() {
        // Pairs of the notes on tooth colours, and the two ends of the greys.
        for (lab, srgb) in [
            ([77.0, 0.0, 15.0], [201, 189, 163]),
            ([73.0, 2.0, 20.0], [197, 177, 143]),
            ([68.0, 4.0, 24.0], [188, 162, 123]),
            ([100.0, 0.0, 0.0], [255, 255, 255]),
            ([0.0, 0.0, 0.0], [0, 0, 0]),
        ] {
            let found = Lab(lab).to_srgb();
            for (found, wanted) in found.iter().zip(srgb) {
                assert!(found.abs_diff(wanted) <= 1, "{lab:?} {found:?}");
            }
        }
    }
}
