//! Colours that people who see fewer of them can tell apart as well.

/// Colour of what is not looked at.
pub(crate) const GREY: [u8; 3] = [203, 205, 208];

/// From -1 to 1 in even steps: orange, light grey, blue (after ColorBrewer's PuOr and RdBu).
const STOPS: [[u8; 3]; 9] = [
    [127, 59, 8],
    [199, 97, 7],
    [243, 146, 48],
    [254, 208, 150],
    [244, 244, 244],
    [166, 210, 238],
    [75, 150, 205],
    [28, 94, 168],
    [5, 41, 97],
];

/// Orange (-1) over light grey (0) to blue (1); what is beyond has the colour of the end.
pub(crate) fn diverging(x: f64) -> [u8; 3] {
    let last = STOPS.len() - 1;
    let at = (x.clamp(-1.0, 1.0) + 1.0) * 0.5 * last as f64;
    let from = (at as usize).min(last - 1);
    let part = at - from as f64;
    std::array::from_fn(|k| {
        let (a, b) = (f64::from(STOPS[from][k]), f64::from(STOPS[from + 1][k]));
        (a + (b - a) * part).round() as u8
    })
}

/// Shades of ivory that tell neighbouring balls apart.
pub(crate) fn ivory(number: u32) -> [u8; 3] {
    let shade = number.wrapping_mul(0x9E37_79B9) >> 24;
    let dim = 0.80 + 0.20 * f64::from(shade) / 255.0;
    [250.0, 236.0, 208.0].map(|c| (c * dim).round() as u8)
}

/// As `#rrggbb`.
pub(crate) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_hues_meet_in_grey_and_get_darker_outwards() {
        assert_eq!(diverging(0.0), [244; 3]);
        assert_eq!(diverging(-7.0), STOPS[0]);
        assert_eq!(diverging(7.0), STOPS[8]);
        assert_eq!(hex(diverging(1.0)), "#052961");
        let light = |x: f64| {
            let [r, g, b] = diverging(x).map(f64::from);
            0.21 * r + 0.72 * g + 0.07 * b
        };
        for k in 0..40 {
            let x = f64::from(k) / 40.0;
            for sign in [-1.0, 1.0] {
                assert!(light(sign * x) > light(sign * (x + 0.025)), "{x}");
            }
            let (gap, bulge) = (diverging(x + 0.025), diverging(-x - 0.025));
            assert!(gap[2] > gap[0] && bulge[0] > bulge[2]);
        }
    }
}
