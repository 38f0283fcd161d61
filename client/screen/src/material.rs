//! Materials: how a part answers to light, apart from the colours of its vertices.

use sulcus_proto::display::{Finish, Kind};

/// Material of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Material {
    /// Mucosa: gingiva, cheek, floor of the mouth.
    Flesh,
    /// Tongue.
    Tongue,
    /// Enamel and root.
    Tooth,
    /// Steel of instruments.
    Metal,
    /// Anything else.
    Plain,
}

impl Material {
    /// All materials, by number.
    pub const ALL: [Self; 5] = [
        Self::Flesh,
        Self::Tongue,
        Self::Tooth,
        Self::Metal,
        Self::Plain,
    ];

    /// Number of the material in the vertices.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// Material of an object.
    pub fn of(kind: Kind) -> Self {
        match kind {
            Kind::Tooth => Self::Tooth,
            Kind::Gingiva | Kind::Mucosa => Self::Flesh,
            Kind::Tongue => Self::Tongue,
            Kind::Other => Self::Plain,
        }
    }

    /// Finish of a vertex without one. Values: Filament's material sheet and residual saliva films of 10 to 70 um;
    /// roughness chosen.
    pub fn finish(self) -> Finish {
        let (roughness, thin) = match self {
            Self::Flesh => (66, 20),
            Self::Tongue => (115, 0),
            Self::Tooth => (28, 0),
            Self::Metal => (71, 0),
            Self::Plain => (128, 0),
        };
        Finish {
            roughness,
            stipple: 0,
            thin,
        }
    }

    /// Reach of diffuse light beyond the terminator, for red, green and blue, dimensionless (Green, "GPU Gems", chapter
    /// 16). Red light goes deep into flesh. Values chosen.
    pub fn wrap(self) -> [f32; 3] {
        match self {
            Self::Flesh => [0.30, 0.12, 0.10],
            Self::Tongue => [0.22, 0.09, 0.07],
            Self::Tooth => [0.25, 0.25, 0.22],
            Self::Metal => [0.0; 3],
            Self::Plain => [0.1; 3],
        }
    }

    /// Share of light reflected at normal incidence: water film 0.02, steel 0.56.
    pub fn reflectance(self) -> f32 {
        match self {
            Self::Metal => 0.56,
            _ => 0.02,
        }
    }
}

/// State of a mirror's glass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Glass {
    /// Clean.
    #[default]
    Clean,
    /// Fogged by breath, as an unwarmed mirror is.
    Fogged,
    /// Scratched by use.
    Scratched,
}

impl Glass {
    /// Fog and scratches, 0 to 1.
    pub fn looks(self) -> (f32, f32) {
        match self {
            Self::Clean => (0.0, 0.0),
            Self::Fogged => (0.7, 0.0),
            Self::Scratched => (0.0, 1.0),
        }
    }
}

impl std::str::FromStr for Glass {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "clean" => Ok(Self::Clean),
            "fogged" => Ok(Self::Fogged),
            "scratched" => Ok(Self::Scratched),
            _ => Err(format!(
                "`{text}` is no glass, expected one of: clean, fogged, scratched"
            )),
        }
    }
}
