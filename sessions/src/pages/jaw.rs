//! Places of teeth on a chart. The patient's right side is on the left of the page.

use sulcus_core::tissue::gingiva::Site;

/// Numbering of teeth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Numbering {
    /// Two digits, quadrant and place (ISO 3950).
    #[default]
    Fdi,
    /// 1 to 32, as in the United States: 36 is 19.
    Universal,
}

impl Numbering {
    /// Number of the tooth with this FDI number.
    pub fn of(self, fdi: u8) -> String {
        let (quadrant, place) = (fdi / 10, fdi % 10);
        let universal = match (self, quadrant) {
            (Self::Fdi, _) => return fdi.to_string(),
            (_, 1) => 9 - place,
            (_, 2) => 8 + place,
            (_, 3) => 25 - place,
            (_, 4) => 24 + place,
            // No permanent tooth: the FDI number.
            _ => return fdi.to_string(),
        };
        universal.to_string()
    }

    /// Name on pages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fdi => "FDI numbers",
            Self::Universal => "Universal numbers (United States)",
        }
    }
}

/// Upper or lower jaw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jaw {
    /// Quadrants 1 and 2.
    Upper,
    /// Quadrants 4 and 3.
    Lower,
}

impl Jaw {
    /// The jaw of a tooth.
    pub fn of(fdi: u8) -> Self {
        if fdi < 30 { Self::Upper } else { Self::Lower }
    }

    /// The sixteen teeth from the left of the page to the right.
    pub fn teeth(self) -> [u8; 16] {
        let (right, left) = match self {
            Self::Upper => (10, 20),
            Self::Lower => (40, 30),
        };
        std::array::from_fn(|k| match k as u8 {
            k if k < 8 => right + 8 - k,
            k => left + k - 7,
        })
    }

    /// The two rows from the top of the page down: whether the row is the cheek's side, and its name.
    pub fn rows(self) -> [(bool, &'static str); 2] {
        match self {
            Self::Upper => [(true, "buccal"), (false, "palatal")],
            Self::Lower => [(false, "lingual"), (true, "buccal")],
        }
    }

    /// Name on pages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Upper => "upper jaw",
            Self::Lower => "lower jaw",
        }
    }
}

/// The three sites of one side of a tooth, from the left of the page to the right.
pub fn across(fdi: u8, buccal: bool) -> [Site; 3] {
    let mut sites = if buccal {
        [Site::DistoBuccal, Site::Buccal, Site::MesioBuccal]
    } else {
        [Site::DistoLingual, Site::Lingual, Site::MesioLingual]
    };
    // On the patient's left, mesial is nearer to the left of the page.
    if matches!(fdi / 10, 2 | 3) {
        sites.reverse();
    }
    sites
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn universal_numbers_go_round_from_the_upper_right() {
        let universal = |fdi| Numbering::Universal.of(fdi);
        for (fdi, is) in [
            (18, "1"),
            (11, "8"),
            (21, "9"),
            (28, "16"),
            (38, "17"),
            (36, "19"),
            (31, "24"),
            (41, "25"),
            (48, "32"),
        ] {
            assert_eq!(universal(fdi), is, "{fdi}");
        }
        assert_eq!(Numbering::Fdi.of(36), "36");
    }

    #[test]
    fn the_patients_right_is_on_the_left_of_the_page() {
        assert_eq!(Jaw::Lower.teeth()[0], 48);
        assert_eq!(Jaw::Lower.teeth()[7..9], [41, 31]);
        assert_eq!(Jaw::Lower.teeth()[15], 38);
        assert_eq!(Jaw::Upper.teeth()[0], 18);
        assert_eq!(across(46, true)[0], Site::DistoBuccal);
        assert_eq!(across(36, true)[0], Site::MesioBuccal);
        assert_eq!(across(36, false)[2], Site::DistoLingual);
    }
}
