//! Sections of a file in the layout of the file. Sections that differ between the formats have files of their own.
//!
//! A count in the file decides how many lines are expected, never how much memory is reserved. The length of the file
//! therefore bounds the memory.

use std::collections::BTreeMap;
use std::path::Path;

use sulcus_core::Vec3;

use super::lines::{Line, Lines};
use crate::error::FemError;

/// Content of a file.
#[derive(Default)]
pub struct Sections {
    /// Names of physical groups, by dimension and tag.
    pub names: BTreeMap<(u8, i64), String>,
    /// Physical groups of an entity, by its dimension and tag.
    ///
    /// In format 2.2 an element names its group itself, and each group serves as an entity.
    pub groups: BTreeMap<(u8, i64), Vec<i64>>,
    /// Tag, line and place of each node, in the units of the file.
    pub nodes: Vec<(u64, u64, Vec3)>,
    pub elements: Vec<Element>,
}

/// An element of any kind.
pub struct Element {
    pub line: u64,
    /// Number of its kind in the file.
    pub kind: u32,
    /// Dimension and tag of its entity.
    pub entity: (u8, i64),
    /// Tags of its nodes.
    pub nodes: Vec<u64>,
}

/// Returns dimension and number of nodes of a kind of element up to second order. Source: Gmsh reference manual, "MSH
/// file format".
fn shape(kind: u32) -> Option<(u8, usize)> {
    Some(match kind {
        15 => (0, 1),
        1 => (1, 2),
        8 => (1, 3),
        2 => (2, 3),
        3 => (2, 4),
        9 => (2, 6),
        10 => (2, 9),
        16 => (2, 8),
        4 => (3, 4),
        5 => (3, 8),
        6 => (3, 6),
        7 => (3, 5),
        11 => (3, 10),
        12 => (3, 27),
        13 => (3, 18),
        14 => (3, 14),
        17 => (3, 20),
        18 => (3, 15),
        19 => (3, 13),
        _ => return None,
    })
}

/// The two supported formats.
#[derive(Clone, Copy, PartialEq)]
enum Version {
    V22,
    V41,
}

impl Sections {
    /// Reads all sections.
    pub fn read(path: &Path, text: &str) -> Result<Self, FemError> {
        let mut lines = Lines::new(path, text);
        lines.end("$MeshFormat")?;
        let version = format(&lines.take("version, 0, size of a number")?)?;
        lines.end("$EndMeshFormat")?;
        let mut all = Self::default();
        let mut had = [false; 2];
        while let Some(line) = lines.next() {
            let mut once = |k: usize| {
                if std::mem::replace(&mut had[k], true) {
                    return Err(line.wrong(line.text, "each section once"));
                }
                Ok(())
            };
            match line.text {
                "$PhysicalNames" => all.physical_names(&mut lines)?,
                "$Entities" if version == Version::V41 => all.entities(&mut lines)?,
                "$PartitionedEntities" => {
                    return Err(line.wrong(line.text, "a mesh that is not partitioned"));
                }
                "$Nodes" => {
                    once(0)?;
                    match version {
                        Version::V22 => all.nodes_22(&mut lines)?,
                        Version::V41 => all.nodes_41(&mut lines)?,
                    }
                }
                "$Elements" => {
                    once(1)?;
                    match version {
                        Version::V22 => all.elements_22(&mut lines)?,
                        Version::V41 => all.elements_41(&mut lines)?,
                    }
                }
                other => {
                    let Some(name) = other.strip_prefix('$') else {
                        return Err(line.wrong(other, "a section, as $Nodes"));
                    };
                    let end = format!("$End{name}");
                    while lines.take(&end)?.text != end {}
                }
            }
        }
        for (had, name) in had.into_iter().zip(["$Nodes", "$Elements"]) {
            if !had {
                lines.take(name)?;
            }
        }
        Ok(all)
    }

    fn physical_names(&mut self, lines: &mut Lines<'_>) -> Result<(), FemError> {
        for _ in 0..count(lines, "number of names")? {
            let expected = "dimension, tag and \"name\"";
            let line = lines.take(expected)?;
            let mut numbers = line.numbers();
            let dimension = dimension(&line, numbers.next(expected)?)?;
            let tag: i64 = numbers.next(expected)?;
            let name = line
                .text
                .split_once('"')
                .and_then(|(_, name)| name.strip_suffix('"'));
            let name = name.ok_or_else(|| line.wrong(line.text, expected))?;
            self.names.insert((dimension, tag), name.to_owned());
        }
        lines.end("$EndPhysicalNames")
    }
}

/// Returns the format of a file.
fn format(line: &Line<'_>) -> Result<Version, FemError> {
    let mut numbers = line.numbers();
    let expected = "version 2.2 or 4.1";
    let version: f64 = numbers.next(expected)?;
    let version = match version {
        2.2 => Version::V22,
        4.1 => Version::V41,
        other => return Err(line.wrong(&format!("version {other}"), expected)),
    };
    let binary: u32 = numbers.next("0: text")?;
    match binary {
        0 => Ok(version),
        other => Err(line.wrong(&format!("file type {other}"), "0: text, not binary")),
    }
}

/// Reads a line with a count.
pub(super) fn count(lines: &mut Lines<'_>, expected: &str) -> Result<u64, FemError> {
    lines.take(expected)?.numbers().next(expected)
}

pub(super) fn dimension(line: &Line<'_>, dimension: u8) -> Result<u8, FemError> {
    if dimension <= 3 {
        return Ok(dimension);
    }
    Err(line.wrong(&format!("dimension {dimension}"), "0 to 3"))
}

pub(super) fn known(line: &Line<'_>, kind: u32) -> Result<(u8, usize), FemError> {
    let expected = "a kind of element up to second order";
    shape(kind).ok_or_else(|| line.wrong(&format!("element of kind {kind}"), expected))
}

pub(super) fn place(line: &Line<'_>, at: Vec<f64>) -> Result<Vec3, FemError> {
    let at = Vec3::new(at[0], at[1], at[2]);
    if at.iter().all(|x| x.is_finite()) {
        return Ok(at);
    }
    Err(line.wrong(line.text, "three finite numbers"))
}
