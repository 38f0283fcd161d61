//! Marks of a periodontal probe, by which depths are read.
//!
//! Marks lie at the places that makers and textbooks state. UNC-15 and Williams follow the periodontal literature.
//! The WHO (CPITN) probe follows Ainamo et al. 1982 (Int Dent J 32:281), the type of ISO 21672-1:2012.
//!
//! Real instruments differ by some tenths of a millimetre (Braz J Oral Sci 22, article 8670401). These marks are
//! exact.

use serde::{Deserialize, Serialize};
use sulcus_core::scene::Band;

/// A pattern of marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Marking {
    /// A mark at every millimetre to 15, black at 4 to 5, 9 to 10 and 14 to 15 mm.
    #[default]
    Unc15,
    /// Marks at 1, 2, 3, 5, 7, 8, 9 and 10 mm. The gaps at 4 and 6 make counting unnecessary.
    Williams,
    /// Black at 3.5 to 5.5 and at 8.5 to 11.5 mm, behind a ball.
    Who,
}

impl Marking {
    /// All markings.
    pub const ALL: [Self; 3] = [Self::Unc15, Self::Williams, Self::Who];

    /// Returns the name as written on the instrument.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unc15 => "UNC-15",
            Self::Williams => "Williams",
            Self::Who => "WHO",
        }
    }

    /// Returns the end of each band, mm from the tip, and whether it is black. Each band begins at the end of the one
    /// before, the first at the tip.
    fn ends(self) -> &'static [(f64, bool)] {
        match self {
            Self::Unc15 => &[
                (1.0, false),
                (2.0, false),
                (3.0, false),
                (4.0, false),
                (5.0, true),
                (6.0, false),
                (7.0, false),
                (8.0, false),
                (9.0, false),
                (10.0, true),
                (11.0, false),
                (12.0, false),
                (13.0, false),
                (14.0, false),
                (15.0, true),
            ],
            Self::Williams => &[
                (1.0, false),
                (2.0, false),
                (3.0, false),
                (5.0, false),
                (7.0, false),
                (8.0, false),
                (9.0, false),
                (10.0, false),
            ],
            Self::Who => &[(3.5, false), (5.5, true), (8.5, false), (11.5, true)],
        }
    }

    /// Returns the bands, metres from the tip, without gaps. A mark is at each border and at the end of the last
    /// band.
    pub fn bands(self) -> Vec<Band> {
        let mut from = 0.0;
        let of_end = |&(end, dark): &(f64, bool)| {
            let band = Band {
                from: from * 1e-3,
                to: end * 1e-3,
                dark,
            };
            from = end;
            band
        };
        self.ends().iter().map(of_end).collect()
    }

    /// Returns the black stretches, mm from the tip, ascending.
    ///
    /// The stretches are black bands, and a line of `line` mm at each mark that is not the border of a black band.
    pub(crate) fn black(self, line: f64) -> Vec<[f64; 2]> {
        let ends = self.ends();
        let mut black: Vec<[f64; 2]> = Vec::new();
        for (k, &(end, dark)) in ends.iter().enumerate() {
            let next_is_dark = ends.get(k + 1).is_some_and(|next| next.1);
            if dark {
                let from = if k == 0 { 0.0 } else { ends[k - 1].0 };
                black.push([from, end]);
            } else if !next_is_dark {
                black.push([end - 0.5 * line, end + 0.5 * line]);
            }
        }
        black
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_follow_each_other_from_the_tip_and_are_those_of_the_standard() {
        let mm = |x: f64| (x * 1e4).round() / 10.0;
        let williams = [1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 9.0, 10.0];
        let unc: Vec<f64> = (1..=15).map(f64::from).collect();
        let who = [3.5, 5.5, 8.5, 11.5];
        for (marking, marks, black) in [
            (
                Marking::Unc15,
                &unc[..],
                &[[4.0, 5.0], [9.0, 10.0], [14.0, 15.0]][..],
            ),
            (Marking::Williams, &williams[..], &[][..]),
            (Marking::Who, &who[..], &[[3.5, 5.5], [8.5, 11.5]][..]),
        ] {
            let bands = marking.bands();
            assert_eq!(bands[0].from, 0.0);
            assert!(bands.windows(2).all(|pair| pair[0].to == pair[1].from));
            let found: Vec<f64> = bands.iter().map(|band| mm(band.to)).collect();
            assert_eq!(found, marks, "{}", marking.name());
            let dark = bands.iter().filter(|band| band.dark);
            let dark: Vec<[f64; 2]> = dark.map(|band| [mm(band.from), mm(band.to)]).collect();
            assert_eq!(dark, black, "{}", marking.name());
        }
    }

    #[test]
    fn every_mark_is_a_line_or_the_border_of_a_black_band() {
        for marking in Marking::ALL {
            let black = marking.black(0.2);
            assert!(black.windows(2).all(|pair| pair[0][1] < pair[1][0]));
            for (mark, _) in marking.ends() {
                let seen = |[from, to]: &[f64; 2]| {
                    from == mark || to == mark || (0.5 * (from + to) - mark).abs() < 1e-12
                };
                assert_eq!(black.iter().filter(|b| seen(b)).count(), 1, "{mark}");
            }
        }
        assert_eq!(Marking::Unc15.black(0.2).len(), 12);
        assert_eq!(Marking::Williams.black(0.2).len(), 8);
        assert_eq!(Marking::Who.black(0.2).len(), 2);
    }
}
