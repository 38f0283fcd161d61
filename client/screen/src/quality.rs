//! Levels of quality, and the governor that steps down when frames take too long.

/// Level of quality, from the best to the cheapest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// Light for each pixel, stippling, four samples, shadows of 1024 texels. For a graphics processor.
    Full,
    /// Light for each pixel, shadows of 512 texels.
    Plain,
    /// Light for each vertex of thinned meshes, no shadows. For a processor without graphics.
    Low,
    /// The same with meshes thinned more, and reflections of half the resolution.
    Lowest,
}

/// Looks of a level. Bands, mirror, bleeding and bared roots are part of every level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Looks {
    /// Whether light is computed for each pixel, not for each vertex.
    pub per_pixel: bool,
    /// Samples of a pixel.
    pub samples: u32,
    /// Edge of the shadow map, texels; 0 for no shadows.
    pub shadow: u32,
    /// Whether the relief of stippling and undulation is drawn.
    pub relief: bool,
    /// Distance by which thinned meshes of soft tissue and teeth may differ from the scene's, micrometres; 0 for whole
    /// meshes.
    pub thinned_um: u32,
    /// Pixels of the picture along an edge of a texel of a reflection.
    pub texel: u32,
    /// Least roughness of a vertex, 0 to 1: no vertex carries a highlight smaller than its triangles.
    pub roughness: f32,
}

impl Quality {
    /// All levels, best first.
    pub const ALL: [Self; 4] = [Self::Full, Self::Plain, Self::Low, Self::Lowest];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Plain => "plain",
            Self::Low => "low",
            Self::Lowest => "lowest",
        }
    }

    /// Looks of the level.
    pub fn looks(self) -> Looks {
        let (per_pixel, samples, shadow, relief, thinned_um, texel, roughness) = match self {
            Self::Full => (true, 4, 1024, true, 0, 1, 0.0),
            Self::Plain => (true, 1, 512, false, 0, 1, 0.0),
            Self::Low => (false, 1, 0, false, 30, 1, 0.30),
            Self::Lowest => (false, 1, 0, false, 110, 2, 0.40),
        };
        Looks {
            per_pixel,
            samples,
            shadow,
            relief,
            thinned_um,
            texel,
            roughness,
        }
    }

    /// Next cheaper level; `None` for the cheapest.
    pub fn lower(self) -> Option<Self> {
        let next = Self::ALL.iter().position(|level| *level == self)? + 1;
        Self::ALL.get(next).copied()
    }
}

impl std::str::FromStr for Quality {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|level| level.name() == text);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("`{text}` is no quality, expected one of: {names}")
        })
    }
}

/// Number of frames over the budget in a row after which the quality is lowered.
pub const PATIENCE: u32 = 30;

/// Governor of a window: lowers the quality, never raises it.
#[derive(Clone, Copy, Debug)]
pub struct Governor {
    level: Quality,
    /// Whether a level of the command line is kept.
    fixed: bool,
    /// Frames over the budget in a row.
    over: u32,
}

impl Governor {
    /// Governor that starts at `Full` on a graphics processor and at `Low` on a software adapter. A `wanted` level is
    /// kept.
    pub fn new(is_software: bool, wanted: Option<Quality>) -> Self {
        let start = if is_software {
            Quality::Low
        } else {
            Quality::Full
        };
        Self {
            level: wanted.unwrap_or(start),
            fixed: wanted.is_some(),
            over: 0,
        }
    }

    /// Present level.
    pub fn level(&self) -> Quality {
        self.level
    }

    /// Takes the duration of a frame and its budget, both in any one unit. Returns the new level after a change.
    pub fn frame(&mut self, took: f64, budget: f64) -> Option<Quality> {
        self.over = if took > budget { self.over + 1 } else { 0 };
        if self.fixed || self.over < PATIENCE {
            return None;
        }
        self.over = 0;
        self.level = self.level.lower()?;
        Some(self.level)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_slow_frames_in_a_row_lower_the_quality_down_to_the_lowest() {
        let mut governor = Governor::new(false, None);
        assert_eq!(governor.level(), Quality::Full);
        for k in 0..200 {
            // A fast frame in between starts the count anew.
            assert_eq!(
                governor.frame(if k % 30 == 29 { 10.0 } else { 20.0 }, 16.0),
                None
            );
        }
        let changes: Vec<Quality> = (0..200)
            .filter_map(|_| governor.frame(20.0, 16.0))
            .collect();
        assert_eq!(changes, [Quality::Plain, Quality::Low, Quality::Lowest]);
        assert_eq!(governor.frame(1.0, 16.0), None);
        assert_eq!(governor.level(), Quality::Lowest);
    }

    #[test]
    fn a_wanted_level_is_kept_and_a_software_adapter_starts_low() {
        let mut fixed = Governor::new(true, Some(Quality::Full));
        assert!((0..100).all(|_| fixed.frame(99.0, 16.0).is_none()));
        assert_eq!(fixed.level(), Quality::Full);
        assert_eq!(Governor::new(true, None).level(), Quality::Low);
    }

    #[test]
    fn names_are_read_back() {
        for level in Quality::ALL {
            assert_eq!(level.name().parse(), Ok(level));
        }
        let told = "best".parse::<Quality>().expect_err("no level");
        assert!(told.contains("`best`") && told.contains("lowest"), "{told}");
    }
}
