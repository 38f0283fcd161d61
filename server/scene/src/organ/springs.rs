//! File of fitted springs of a skeleton: read, written, put into a skeleton.
//!
//! A file belongs to one tree. It lists the places of the skeleton's nodes, and a skeleton with other nodes is
//! refused.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_core::tissue::skeleton::{Skeleton, SkeletonLevel, Spring, StretchLaw};
use sulcus_core::{SphereTree, Vec3};
use sulcus_program::PathText;

use crate::hand_written::{FileError, from_toml};

/// Largest distance of a node from its place in the file, mm.
const SAME_MM: f64 = 1e-3;

/// Fitted springs of a coarse skeleton. Their stiffness does not depend on the stretch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedSprings {
    /// Description of the fit, for people.
    pub fitted: String,
    /// Young's modulus of the fitted tissue, kPa. The stiffness is proportional to it.
    pub young_kpa: f64,
    /// Poisson's ratio of the fitted tissue.
    pub poisson: f64,
    /// Places of the nodes, mm, in the frame of the mesh.
    pub nodes_mm: Vec<[f64; 3]>,
    /// Nodes that never move.
    pub fixed: Vec<u16>,
    /// The springs.
    pub spring: Vec<FittedSpring>,
}

/// A fitted spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedSpring {
    /// Node at one end.
    pub a: u16,
    /// Node at the other.
    pub b: u16,
    /// Stiffness along x, y, z, and between y and z, z and x, x and y, N/mm.
    pub n_per_mm: [f64; 6],
}

/// Reason why a file of springs cannot be used, in one sentence.
#[derive(Debug, thiserror::Error)]
pub enum SpringsError {
    /// The file cannot be read or written.
    #[error("{}: {source}", file.shown())]
    File {
        /// The file.
        file: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file is no valid file of springs.
    #[error(transparent)]
    Syntax(#[from] FileError),
    /// The springs have no TOML form.
    #[error("{}: {message}", file.shown())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// Fault.
        message: String,
    },
    /// The springs do not fit the skeleton, or a value is invalid.
    #[error("{field} is {found}, expected {expected}")]
    Field {
        /// Field.
        field: &'static str,
        /// Value found.
        found: String,
        /// Value expected.
        expected: String,
    },
}

fn wrong(field: &'static str, found: impl ToString, expected: impl ToString) -> SpringsError {
    SpringsError::Field {
        field,
        found: found.to_string(),
        expected: expected.to_string(),
    }
}

fn places_mm(level: &SkeletonLevel, tree: &SphereTree) -> Vec<[f64; 3]> {
    let place = |&node: &u32| -> Vec3 { tree.nodes()[node as usize].centre * 1e3 };
    level.nodes.iter().map(place).map(Into::into).collect()
}

impl FittedSprings {
    /// Returns the springs of a level, at the modulus of the fit.
    pub fn of(
        level: &SkeletonLevel,
        tree: &SphereTree,
        fitted: String,
        (young_kpa, poisson): (f64, f64),
    ) -> Self {
        let spring = |s: &Spring| {
            let ([x, y, z], [yz, zx, xy]) = (s.stiffness, s.coupling);
            FittedSpring {
                a: s.a,
                b: s.b,
                n_per_mm: [x, y, z, yz, zx, xy].map(|k| 1e-3 * k),
            }
        };
        let fixed = level.fixed.iter().enumerate().filter(|(_, fixed)| **fixed);
        Self {
            fitted,
            young_kpa,
            poisson,
            nodes_mm: places_mm(level, tree),
            fixed: fixed.map(|(k, _)| k as u16).collect(),
            spring: level.springs.iter().map(spring).collect(),
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`SpringsError`] with the file and its fault.
    pub fn read(file: &Path) -> Result<Self, SpringsError> {
        let text = std::fs::read_to_string(file).map_err(|source| SpringsError::File {
            file: file.to_owned(),
            source,
        })?;
        Ok(from_toml(&text, file)?)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// [`SpringsError`] if the file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), SpringsError> {
        let text = toml::to_string(self).map_err(|error| SpringsError::Unwritable {
            file: file.to_owned(),
            message: error.to_string(),
        })?;
        let head = "# Springs of a skeleton, fitted to finite elements by `sulcus-server tissue fit`.\n# n_per_mm: stiffness along x, y, z, and between y and z, z and x, x and y.\n";
        std::fs::write(file, format!("{head}{text}")).map_err(|source| SpringsError::File {
            file: file.to_owned(),
            source,
        })
    }

    /// Puts the springs into a skeleton of the same nodes, for tissue of a modulus (kPa).
    ///
    /// The fine level is removed, because it was not fitted.
    ///
    /// # Errors
    /// [`SpringsError`] if the nodes differ or a value is invalid.
    pub fn put_into(
        &self,
        skeleton: &mut Skeleton,
        tree: &SphereTree,
        young_kpa: f64,
    ) -> Result<(), SpringsError> {
        for (field, kpa) in [
            ("young_kpa of the springs", self.young_kpa),
            ("young_kpa", young_kpa),
        ] {
            if !(0.01..=1e6).contains(&kpa) {
                return Err(wrong(field, kpa, "0.01 to 1e6"));
            }
        }
        let level = &mut skeleton.coarse;
        let places = places_mm(level, tree);
        if places.len() != self.nodes_mm.len() {
            return Err(wrong(
                "number of nodes_mm",
                self.nodes_mm.len(),
                format!("{}, those of this skeleton", places.len()),
            ));
        }
        for (k, (own, given)) in places.iter().zip(&self.nodes_mm).enumerate() {
            let near = own.iter().zip(given).all(|(a, b)| (a - b).abs() <= SAME_MM);
            if !near {
                return Err(wrong(
                    "nodes_mm",
                    format!("{given:?} at {k}"),
                    format!("{own:?}: the springs are of another tree"),
                ));
            }
        }
        let n = places.len();
        if let Some(k) = self.fixed.iter().find(|&&k| usize::from(k) >= n) {
            return Err(wrong("fixed", k, format!("below {n}")));
        }
        level.fixed = (0..n).map(|k| self.fixed.contains(&(k as u16))).collect();
        let factor = 1e3 * young_kpa / self.young_kpa;
        let spring = |s: &FittedSpring| {
            let [x, y, z, yz, zx, xy] = s.n_per_mm.map(|k| k * factor);
            Spring {
                a: s.a,
                b: s.b,
                stiffness: [x, y, z],
                coupling: [yz, zx, xy],
            }
        };
        level.springs = self.spring.iter().map(spring).collect();
        level.params.law = StretchLaw::LINEAR;
        skeleton.fine = None;
        skeleton
            .validate(tree)
            .map_err(|error| wrong(error.field, error.found, error.expected))
    }
}
