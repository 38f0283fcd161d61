//! Reading of a probe's bands at the gingival margin, as an eye reads them.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::scene::Band;
use sulcus_core::{Pose, Tool, Vec3};

use crate::pocket_path::PocketPath;

/// Length of the working end that is looked at, metres.
const LENGTH: f64 = 20e-3;
/// Step along the working end, metres.
const STEP: f64 = 0.1e-3;
/// Number of parts of a wide space between two marks that an eye distinguishes.
const PARTS: f64 = 4.0;
/// Largest space between two marks without interpolation, metres.
const CLOSE: f64 = 1.01e-3;

/// Length of the drawn working end below the gingival margin, metres, 0 to 0.02; 0 with the tip above the margin.
///
/// The length is measured from the tip along the tip's axis to the margin at the angle of each point.
pub fn below_margin(path: &PocketPath, tool: &Tool, graphic: &Pose) -> f64 {
    let tip = graphic.transform(&tool.tip);
    let up: Vec3 = graphic.orientation * -tool.tip_axis;
    let depth = |s: f64| path.seen(&(tip + up * s)).1;
    let mut before = depth(0.0);
    if before <= 0.0 {
        return 0.0;
    }
    let mut s = 0.0;
    while s < LENGTH {
        let next = depth(s + STEP);
        if next <= 0.0 {
            return s + STEP * before / (before - next);
        }
        (s, before) = (s + STEP, next);
    }
    LENGTH
}

/// Depth that a person reads off `bands`, whole millimetres, for a `length` below the margin, metres.
///
/// Marks are the ends of the bands and the tip. Between marks a millimetre apart or less, the nearest mark is read. In
/// a wider space quarters are judged. The result is the nearest whole millimetre, halves up as taught. Beyond the last
/// mark, the last mark is read.
pub fn read(bands: &[Band], length: f64) -> u8 {
    let marks = marks(bands);
    let above = marks.iter().position(|mark| *mark >= length);
    let at = match above {
        None => marks[marks.len() - 1],
        Some(0) => marks[0],
        Some(k) => {
            let (low, high) = (marks[k - 1], marks[k]);
            let share = (length - low) / (high - low);
            let parts = if high - low <= CLOSE { 1.0 } else { PARTS };
            low + (high - low) * (share * parts).round() / parts
        }
    };
    (at * 1e3).round() as u8
}

/// Distances of the tip and of all ends of bands from the tip, metres, ascending.
fn marks(bands: &[Band]) -> Vec<f64> {
    let mut marks: Vec<f64> = bands.iter().flat_map(|band| [band.from, band.to]).collect();
    marks.push(0.0);
    marks.sort_by(f64::total_cmp);
    marks.dedup_by(|a, b| *a - *b < 1e-6);
    marks
}

/// Reading errors of an operator who confuses marks.
#[derive(Clone, Debug)]
pub struct Blur {
    chance: ChaCha8Rng,
    /// Number of calls so far.
    calls: u32,
    /// Kinds of error that are left of the three in five calls.
    mistakes: Vec<u8>,
}

impl Blur {
    /// Reading errors in an order that `seed` decides.
    pub fn new(seed: u64) -> Self {
        Self {
            chance: ChaCha8Rng::seed_from_u64(seed ^ 0x6d61_726b),
            calls: 0,
            mistakes: Vec::new(),
        }
    }

    /// Depth that is called for the correct depth `right`, whole millimetres.
    ///
    /// Of five calls two are correct, two are wrong by a millimetre, and one confuses a dark band with the next dark
    /// band.
    pub fn call(&mut self, bands: &[Band], right: u8) -> u8 {
        let mut dark = bands.iter().filter(|band| band.dark).map(|band| band.to);
        let apart = match (dark.next(), dark.next()) {
            (Some(first), Some(second)) => ((second - first) * 1e3).round() as u8,
            _ => 2,
        };
        // The second and the fourth of five calls are correct. Of three calls two are therefore wrong.
        let of_five = self.calls % 5;
        self.calls += 1;
        if of_five % 2 == 1 {
            return right;
        }
        if self.mistakes.is_empty() {
            self.mistakes.extend(0..3);
        }
        let drawn = self.chance.next_u64() % self.mistakes.len() as u64;
        match self.mistakes.swap_remove(drawn as usize) {
            0 => right + 1,
            1 if right > 0 => right - 1,
            1 => right + 1,
            _ if right > apart => right - apart,
            _ => right + apart,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bands(marks: &[(f64, f64, bool)]) -> Vec<Band> {
        let band = |&(from, to, dark): &(f64, f64, bool)| Band {
            from: from * 1e-3,
            to: to * 1e-3,
            dark,
        };
        marks.iter().map(band).collect()
    }

    #[test]
    fn a_unc_15_is_read_to_the_nearest_mark() {
        let each: Vec<_> = (0..15)
            .map(|k| (f64::from(k), f64::from(k + 1), k % 5 == 4))
            .collect();
        let unc = bands(&each);
        let read = [0.0, 0.4, 0.6, 3.4, 3.6, 9.9, 14.6, 18.0].map(|mm| read(&unc, mm * 1e-3));
        assert_eq!(read, [0, 0, 1, 3, 4, 10, 15, 15]);
    }

    #[test]
    fn sparse_marks_are_judged_in_quarters() {
        // Williams: 1 2 3 5 7 8 9 10.
        let ends = [0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 9.0, 10.0];
        let williams: Vec<_> = ends.windows(2).map(|w| (w[0], w[1], false)).collect();
        let read_w = [3.2, 3.6, 4.1, 4.4, 4.8].map(|mm| read(&bands(&williams), mm * 1e-3));
        assert_eq!(read_w, [3, 4, 4, 5, 5]);
        let who = bands(&[(0.0, 0.5, true), (3.5, 5.5, true), (8.5, 11.5, true)]);
        let read_who = [0.2, 2.0, 3.4, 4.4, 5.4, 7.0, 12.0].map(|mm| read(&who, mm * 1e-3));
        assert_eq!(read_who, [0, 2, 4, 5, 6, 7, 12]);
    }

    #[test]
    fn a_blurred_eye_is_wrong_as_often_as_said_and_the_seed_decides() {
        let each: Vec<_> = (0..15)
            .map(|k| (f64::from(k), f64::from(k + 1), k % 5 == 4))
            .collect();
        let unc = bands(&each);
        let calls = |seed| {
            let mut eye = Blur::new(seed);
            (0..500).map(|_| eye.call(&unc, 4)).collect::<Vec<u8>>()
        };
        let first = |seed, right| Blur::new(seed).call(&unc, right);
        assert_eq!(calls(3), calls(3));
        assert_ne!(calls(3), calls(4));
        let count = |mm: u8| calls(3).iter().filter(|call| **call == mm).count();
        for (mm, of_500) in [(4, 200), (3, 100), (5, 100), (9, 100)] {
            assert_eq!(count(mm), of_500, "{mm}");
        }
        // The first call is always wrong.
        for right in 0..=10 {
            assert!((0..100).all(|seed| first(seed, right) != right));
        }
    }
}
