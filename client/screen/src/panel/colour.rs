//! Colours of the panel: the palette of Okabe and Ito (2008), which colour-blind people can tell apart.
//!
//! Colours are sRGB with straight alpha. No state is told by colour alone: a shape and a word go with each colour.

/// Colour, sRGB with straight alpha, 0 to 255.
pub type Rgba = [u8; 4];

/// Text.
pub const WHITE: Rgba = [255, 255, 255, 255];
/// Text on bright ground.
pub const BLACK: Rgba = [0, 0, 0, 255];
/// Less important text.
pub const GREY: Rgba = [200, 200, 200, 255];
/// Ground of the panel over the picture.
pub const GROUND: Rgba = [0, 0, 0, 230];
/// Ground of gauges.
pub const TROUGH: Rgba = [70, 70, 70, 255];
/// Sky blue of the palette: light force.
pub const SKY_BLUE: Rgba = [86, 180, 233, 255];
/// Bluish green of the palette: right force, link.
pub const GREEN: Rgba = [0, 158, 115, 255];
/// Vermillion of the palette: heavy force, recording.
pub const VERMILLION: Rgba = [213, 94, 0, 255];
/// Yellow of the palette: pause.
pub const YELLOW: Rgba = [240, 228, 66, 255];
/// Orange of the palette: warnings.
pub const ORANGE: Rgba = [230, 159, 0, 255];

#[cfg(test)]
mod tests {
    use super::*;

    fn linear([r, g, b, _]: Rgba) -> [f64; 3] {
        [r, g, b].map(|byte| {
            let x = f64::from(byte) / 255.0;
            if x <= 0.04045 {
                x / 12.92
            } else {
                ((x + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    /// Contrast of two colours (WCAG 2), 1 to 21.
    fn contrast(a: Rgba, b: Rgba) -> f64 {
        let luminance = |colour| {
            let [r, g, b] = linear(colour);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        (a / b).max(b / a)
    }

    /// Ground of the panel over a white picture, the brightest that can lie behind.
    fn brightest_ground() -> Rgba {
        let byte = 255 - GROUND[3];
        [byte, byte, byte, 255]
    }

    #[test]
    fn texts_and_signs_stand_out_over_any_picture() {
        for ground in [BLACK, brightest_ground()] {
            for text in [WHITE, GREY] {
                assert!(contrast(text, ground) >= 7.0, "{text:?}");
            }
            for sign in [SKY_BLUE, GREEN, VERMILLION, YELLOW, ORANGE] {
                assert!(
                    contrast(sign, ground) >= 3.0,
                    "{sign:?} {}",
                    contrast(sign, ground)
                );
            }
        }
        for ground in [YELLOW, ORANGE] {
            assert!(contrast(BLACK, ground) >= 7.0, "{ground:?}");
        }
    }

    /// Sight of a person without one kind of cones (Machado et al. 2009, severity 1), in linear RGB.
    const SIGHTS: [[[f64; 3]; 3]; 3] = [
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ],
    ];

    #[test]
    fn ratings_differ_for_every_sight() {
        let ratings = [SKY_BLUE, GREEN, VERMILLION];
        for sight in SIGHTS {
            let seen = |colour| {
                let rgb = linear(colour);
                sight.map(|row| {
                    row.iter()
                        .zip(rgb)
                        .map(|(a, x)| a * x)
                        .sum::<f64>()
                        .clamp(0.0, 1.0)
                })
            };
            for (k, a) in ratings.iter().enumerate() {
                for b in &ratings[k + 1..] {
                    let (seen_a, seen_b) = (seen(*a), seen(*b));
                    let apart = seen_a
                        .iter()
                        .zip(seen_b)
                        .map(|(a, b)| (a - b).powi(2))
                        .sum::<f64>()
                        .sqrt();
                    // Chosen: a tenth of the distance from black to white, rounded down.
                    assert!(apart > 0.17, "{a:?} {b:?} {apart}");
                }
            }
        }
    }
}
