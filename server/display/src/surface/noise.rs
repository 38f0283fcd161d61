//! Smooth noise in space, a function of the place alone.

use sulcus_core::Vec3;

/// Noise of -1 to 1 that changes over about `size` (the unit of `at`). `seed` chooses one of many fields.
pub(crate) fn noise(at: &Vec3, size: f64, seed: u32) -> f64 {
    let cell = at / size;
    let low = cell.map(|x| x.floor());
    let share = (cell - low).map(|t| t * t * (3.0 - 2.0 * t));
    let low = [low.x as i32, low.y as i32, low.z as i32];
    let mut sum = 0.0;
    for corner in 0..8 {
        let step = [corner & 1, corner >> 1 & 1, corner >> 2 & 1];
        let weight: f64 = (0..3)
            .map(|k| {
                if step[k] == 1 {
                    share[k]
                } else {
                    1.0 - share[k]
                }
            })
            .product();
        let at = std::array::from_fn(|k| low[k].wrapping_add(step[k]));
        sum += weight * value(at, seed);
    }
    sum
}

/// Value of a corner of the grid, -1 to 1.
fn value(at: [i32; 3], seed: u32) -> f64 {
    let mut hash = seed.wrapping_mul(0x9E37_79B9) ^ 0x85EB_CA6B;
    for x in at {
        hash = (hash ^ x as u32).wrapping_mul(0xCC9E_2D51).rotate_left(15);
        hash = hash.wrapping_mul(0x1B87_3593) ^ hash >> 13;
    }
    hash ^= hash >> 16;
    hash = hash.wrapping_mul(0x7FEB_352D);
    hash ^= hash >> 15;
    f64::from(hash) / f64::from(u32::MAX) * 2.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_smooth_and_spreads() {
        let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        let mut before = noise(&Vec3::zeros(), 4.0, 1);
        for k in 1..20_000 {
            let at = Vec3::new(0.01, 0.007, 0.003) * f64::from(k);
            let now = noise(&at, 4.0, 1);
            assert!((now - before).abs() < 0.03, "a jump at {at:?}");
            (low, high, sum) = (now.min(low), now.max(high), sum + now);
            before = now;
        }
        assert!(
            low < -0.4 && high > 0.4 && (sum / 20_000.0).abs() < 0.2,
            "{low} {high} {sum}"
        );
        assert_ne!(noise(&Vec3::zeros(), 4.0, 1), noise(&Vec3::zeros(), 4.0, 2));
    }
}
