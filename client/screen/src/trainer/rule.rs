//! Rounding of a length below the margin to the whole millimetre that is charted.

/// Rule of rounding, by which an answer is right. Textbooks differ, so that the rule is data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// Nearest whole millimetre; exactly half a millimetre goes to the larger number. The usual convention.
    #[default]
    NearestHalfUp,
    /// Next whole millimetre that is not smaller: "rounded up", as Boyd teaches.
    Up,
    /// Last mark that is entirely below the margin: whole millimetres that are completed.
    Down,
}

impl Rule {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::NearestHalfUp, Self::Up, Self::Down];

    /// Name in rubrics and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NearestHalfUp => "nearest_half_up",
            Self::Up => "up",
            Self::Down => "down",
        }
    }

    /// Rule with the name `name`; `None` for another word.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rule| rule.name() == name)
    }

    /// Whole millimetres of a length in tenths of a millimetre; at most 255.
    pub fn whole_mm(self, tenths: u16) -> u8 {
        let mm = match self {
            Self::NearestHalfUp => tenths.saturating_add(5) / 10,
            Self::Up => tenths.div_ceil(10),
            Self::Down => tenths / 10,
        };
        u8::try_from(mm).unwrap_or(u8::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_differ_between_marks_and_agree_on_them() {
        let all = |tenths| Rule::ALL.map(|rule| rule.whole_mm(tenths));
        assert_eq!(all(30), [3, 3, 3]);
        assert_eq!(all(34), [3, 4, 3]);
        assert_eq!(all(35), [4, 4, 3]);
        assert_eq!(all(39), [4, 4, 3]);
        assert_eq!(all(5), [1, 1, 0]);
        assert_eq!(all(0), [0, 0, 0]);
        assert_eq!(all(u16::MAX), [255; 3]);
    }

    #[test]
    fn names_come_back() {
        for rule in Rule::ALL {
            assert_eq!(Rule::from_name(rule.name()), Some(rule));
        }
        assert_eq!(Rule::default().name(), "nearest_half_up");
        assert_eq!(Rule::from_name("half_even"), None);
    }
}
