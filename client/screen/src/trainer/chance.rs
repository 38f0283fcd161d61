//! Random numbers of a lesson, the same on every machine.

/// Generator SplitMix64 (Steele, Lea and Flood 2014). Lessons need no more than an even spread.
pub struct Chance(u64);

impl Chance {
    /// Generator in the state `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Number from 0 to `limit` - 1; 0 for a limit of 0. The spread is uneven by less than 2^-48.
    pub fn below(&mut self, limit: u16) -> u16 {
        // The upper half of a product is below the limit.
        let product = u128::from(self.next()) * u128::from(limit);
        (product >> 64) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First numbers of the seed 1234567, published with the reference code.
    #[test]
    fn the_generator_is_the_published_one() {
        let mut chance = Chance::new(1_234_567);
        assert_eq!(chance.next(), 6_457_827_717_110_365_317);
        assert_eq!(chance.next(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn numbers_stay_below_the_limit_and_reach_all_of_it() {
        let mut chance = Chance::new(7);
        let mut seen = [0u32; 6];
        for _ in 0..6000 {
            seen[usize::from(chance.below(6))] += 1;
        }
        assert!(
            seen.iter().all(|times| (850..1150).contains(times)),
            "{seen:?}"
        );
        assert_eq!((chance.below(1), chance.below(0)), (0, 0));
    }
}
