//! Coupling of a tool: the spring between the hand's pose and the graphic tool.
//!
//! A compiled scene holds the couplings for which it was made. A session may run with softer couplings, because a
//! haptic device displays only a limited stiffness ([`super::displayable`]). The session then runs on a copy of the
//! scene ([`Scene::with_couplings`]). The compiled bytes and their hash stay those of the scene.

use serde::{Deserialize, Serialize};

use crate::math::fmin;
use crate::scene::params::within;
use crate::{Scene, SceneError, Tool};

/// Coupling stiffness of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// Stiffness in translation, N/m, range [`Coupling::N_PER_M`].
    pub n_per_m: f64,
    /// Stiffness in rotation, N m/rad, range [`Coupling::NM_PER_RAD`].
    pub nm_per_rad: f64,
}

impl Coupling {
    /// Smallest and largest stiffness in translation, N/m.
    pub const N_PER_M: [f64; 2] = [1.0, 1e5];
    /// Smallest and largest stiffness in rotation, N m/rad.
    pub const NM_PER_RAD: [f64; 2] = [1e-4, 1e3];

    /// Returns the coupling of `tool`.
    pub fn of(tool: &Tool) -> Self {
        Self {
            n_per_m: tool.stiffness_n_per_m,
            nm_per_rad: tool.stiffness_nm_per_rad,
        }
    }

    /// Returns the smaller stiffness of both couplings, in translation and in rotation separately.
    #[must_use]
    pub fn softer(self, other: Self) -> Self {
        Self {
            n_per_m: fmin(self.n_per_m, other.n_per_m),
            nm_per_rad: fmin(self.nm_per_rad, other.nm_per_rad),
        }
    }

    /// Whether this coupling is stiffer than `other`, in translation or in rotation.
    pub fn is_stiffer_than(self, other: Self) -> bool {
        self.n_per_m > other.n_per_m || self.nm_per_rad > other.nm_per_rad
    }

    /// Checks both ranges. `part` is the tool for the error.
    ///
    /// # Errors
    /// A stiffness is outside of its range or not finite.
    pub fn validate(&self, part: &str) -> Result<(), SceneError> {
        let field = |field, found: f64, expected| {
            Err(SceneError::Field {
                part: part.to_owned(),
                field,
                found: found.to_string(),
                expected,
            })
        };
        let [least, most] = Self::N_PER_M;
        if !within(self.n_per_m, least, most) {
            return field("stiffness_n_per_m", self.n_per_m, "1 to 1e5 N/m");
        }
        let [least, most] = Self::NM_PER_RAD;
        if !within(self.nm_per_rad, least, most) {
            return field(
                "stiffness_nm_per_rad",
                self.nm_per_rad,
                "1e-4 to 1e3 N m/rad",
            );
        }
        Ok(())
    }
}

impl Scene {
    /// Returns the couplings of all tools, in the order of the tools.
    pub fn couplings(&self) -> Vec<Coupling> {
        self.tools.iter().map(Coupling::of).collect()
    }

    /// Returns a copy of the scene whose tools have other couplings, in the order of the tools.
    ///
    /// The copy is for simulation. The bytes and the hash of a session's scene remain those of the original.
    ///
    /// # Errors
    /// The number of couplings is not the number of tools, or a stiffness is outside of its range.
    pub fn with_couplings(&self, couplings: &[Coupling]) -> Result<Self, SceneError> {
        if couplings.len() != self.tools.len() {
            return Err(SceneError::Field {
                part: "scene".to_owned(),
                field: "number of couplings",
                found: couplings.len().to_string(),
                expected: "one for each tool",
            });
        }
        for (tool, coupling) in self.tools.iter().zip(couplings) {
            coupling.validate(&format!("tool `{}`", tool.name))?;
        }
        let mut scene = self.clone();
        for (tool, coupling) in scene.tools.iter_mut().zip(couplings) {
            tool.stiffness_n_per_m = coupling.n_per_m;
            tool.stiffness_nm_per_rad = coupling.nm_per_rad;
        }
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::tick::tests::rod_tool;

    fn scene() -> Scene {
        Scene {
            name: "rods".into(),
            source_hash: String::new(),
            params: crate::Params::default(),
            tools: vec![rod_tool(Vec3::zeros()), rod_tool(Vec3::zeros())],
            objects: Vec::new(),
        }
    }

    fn coupling(n_per_m: f64, nm_per_rad: f64) -> Coupling {
        Coupling {
            n_per_m,
            nm_per_rad,
        }
    }

    #[test]
    fn a_copy_has_other_couplings_and_is_otherwise_the_scene() {
        let scene = scene();
        let before = scene.to_bytes().expect("bytes");
        let own = scene.couplings();
        let soft = [coupling(250.0, 0.1), own[1]];
        let copy = scene.with_couplings(&soft).expect("a copy");
        assert_eq!(copy.couplings(), soft);
        assert_eq!(copy.validate(), Ok(()));
        assert_eq!(scene.to_bytes().expect("bytes"), before);
        assert_eq!(copy.with_couplings(&own), Ok(scene));
    }

    #[test]
    fn a_wrong_number_or_a_wrong_stiffness_is_refused_by_field_and_value() {
        let scene = scene();
        let refused = |couplings: &[Coupling]| {
            let error = scene.with_couplings(couplings).expect_err("refused");
            error.to_string()
        };
        let good = coupling(500.0, 0.5);
        assert_eq!(
            refused(&[good]),
            "scene: number of couplings is 1, expected one for each tool"
        );
        for (n_per_m, said) in [(0.99, "0.99"), (1.1e5, "110000"), (f64::NAN, "NaN")] {
            assert!(
                refused(&[good, coupling(n_per_m, 0.5)]).ends_with(&format!(
                    "stiffness_n_per_m is {said}, expected 1 to 1e5 N/m"
                )),
                "{n_per_m}"
            );
        }
        for nm_per_rad in [0.0, 9e-5, 1001.0, f64::INFINITY] {
            let said = refused(&[coupling(500.0, nm_per_rad), good]);
            assert!(said.contains("stiffness_nm_per_rad is"), "{said}");
        }
    }

    #[test]
    fn the_softer_stiffness_is_taken_in_translation_and_rotation_separately() {
        let (a, b) = (coupling(500.0, 0.1), coupling(300.0, 0.5));
        assert_eq!(a.softer(b), coupling(300.0, 0.1));
        assert!(a.is_stiffer_than(b) && b.is_stiffer_than(a));
        assert!(!a.is_stiffer_than(a) && !coupling(300.0, 0.1).is_stiffer_than(a));
    }
}
