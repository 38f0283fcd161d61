//! Meshes of Gmsh: text files `.msh` in format 4.1 or 2.2. Source: Gmsh reference manual, "MSH file format" and
//! "Legacy formats".
//!
//! Tetrahedra of 4 nodes get a node in the middle of each edge. Tetrahedra of 10 nodes keep theirs.
//!
//! Gmsh numbers the middle of edge 23 before the middle of edge 13; this crate numbers it after.

mod format_22;
mod format_41;
mod hold;
mod lines;
mod sections;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use sections::{Element, Sections};

use crate::element::is_upright;
use crate::error::FemError;
use crate::mesh::TetMesh;

/// Kinds of element, by the number in the file.
const TET4: u32 = 4;
const TET10: u32 = 11;

/// Unit of the coordinates of a file. The format does not name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres.
    Millimetre,
    /// Metres.
    Metre,
    /// International inches, 25.4 mm.
    Inch,
}

impl Unit {
    fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Metre => 1.0,
            Self::Inch => 25.4e-3,
        }
    }
}

/// Reads the tetrahedra of the physical volumes named `volume`, or all tetrahedra if `volume` is `None`.
///
/// Nodes are in the order of the file, followed by middles of edges that the file lacks. Nodes of no tetrahedron are
/// left out. A tetrahedron that is listed once for each of its groups counts once.
///
/// Physical groups named `fixed`, of points, curves, surfaces or volumes, name the held nodes. Nodes of their
/// elements are held along all axes, and so are the nodes in the middle of these elements' edges.
///
/// Without such a group nothing is held.
///
/// # Errors
/// [`FemError`] with file, line, value found and value expected.
pub fn read_msh(path: &Path, unit: Unit, volume: Option<&str>) -> Result<TetMesh, FemError> {
    let bytes = std::fs::read(path).map_err(|source| FemError::Open {
        path: path.to_owned(),
        source,
    })?;
    let text = std::str::from_utf8(&bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = before.iter().filter(|&&byte| byte == b'\n').count() as u64 + 1;
        lines::wrong(
            path,
            line,
            "bytes that are not text",
            "a text file, not a binary one",
        )
    })?;
    Reader {
        path,
        file: Sections::read(path, text)?,
    }
    .mesh(unit, volume)
}

struct Reader<'a> {
    path: &'a Path,
    file: Sections,
}

impl Reader<'_> {
    fn mesh(&self, unit: Unit, volume: Option<&str>) -> Result<TetMesh, FemError> {
        let tets = self.tetrahedra(volume)?;
        let index = self.index()?;
        let quadratic = tets[0].kind == TET10;
        let mut ids = Vec::new();
        for tet in &tets {
            ids.push(self.ids(tet, &index)?);
        }
        // Only nodes of tetrahedra are kept, in the order of the file.
        let mut new = vec![u32::MAX; self.file.nodes.len()];
        ids.iter().flatten().for_each(|&id| new[id] = 0);
        let mut nodes = Vec::new();
        for ((_, line, at), new) in self.file.nodes.iter().zip(&mut new) {
            if *new == u32::MAX {
                continue;
            }
            *new = nodes.len() as u32;
            let at = at * unit.metres();
            if !at.iter().all(|x| x.abs() <= 10.0) {
                let found = format!("a node at {}, {}, {} m", at.x, at.y, at.z);
                return Err(self.wrong(*line, &found, "within 10 m"));
            }
            nodes.push(at);
        }
        let mut mesh = if quadratic {
            // Gmsh has the last two in the other order.
            let order = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
            let tets = ids.iter().map(|ids| order.map(|a| new[ids[a]]));
            TetMesh {
                tets: tets.collect(),
                held: vec![[false; 3]; nodes.len()],
                nodes,
            }
        } else {
            let tets = ids.iter().map(|ids| [0, 1, 2, 3].map(|a| new[ids[a]]));
            TetMesh::from_corners(nodes, &tets.collect::<Vec<_>>())
        };
        for (tet, element) in mesh.tets.iter().zip(&tets) {
            if !is_upright(&mesh.corners(tet)) {
                let expected = "node 4 on the side from which nodes 1, 2, 3 go round clockwise, edges not bent over";
                let found = "a tetrahedron flat or inside out";
                return Err(self.wrong(element.line, found, expected));
            }
        }
        self.hold(&mut mesh, &index, &new)?;
        mesh.validate()?;
        Ok(mesh)
    }

    /// Returns the tetrahedra of a volume, each once. There is at least one, and all have the same number of nodes.
    fn tetrahedra(&self, volume: Option<&str>) -> Result<Vec<&Element>, FemError> {
        let groups = volume.map(|name| self.groups(name, 3));
        if groups.as_ref().is_some_and(BTreeSet::is_empty) {
            let names = self
                .file
                .names
                .iter()
                .filter(|((dimension, _), _)| *dimension == 3);
            let names: Vec<String> = names.map(|(_, name)| format!("\"{name}\"")).collect();
            let expected = match names.len() {
                0 => "no name: the file has no named volumes".into(),
                _ => names.join(" or "),
            };
            return Err(self.whole(
                &format!("no volume \"{}\"", volume.unwrap_or("")),
                &expected,
            ));
        }
        let mut seen = BTreeSet::new();
        let mut tets: Vec<&Element> = Vec::new();
        for element in &self.file.elements {
            let wanted = |groups: &BTreeSet<(u8, i64)>| self.is_in(element, groups);
            if element.entity.0 != 3 || !groups.as_ref().is_none_or(wanted) {
                continue;
            }
            if ![TET4, TET10].contains(&element.kind) {
                let found = format!("element of kind {}", element.kind);
                return Err(self.wrong(element.line, &found, "kind 4 or 11, a tetrahedron"));
            }
            if let Some(first) = tets.first()
                && first.kind != element.kind
            {
                let found = format!("a tetrahedron of {} nodes", element.nodes.len());
                let expected = format!("{} nodes, as on line {}", first.nodes.len(), first.line);
                return Err(self.wrong(element.line, &found, &expected));
            }
            let mut corners = [0, 1, 2, 3].map(|a| element.nodes[a]);
            corners.sort_unstable();
            if seen.insert(corners) {
                tets.push(element);
            }
        }
        if tets.is_empty() {
            return Err(self.whole("no tetrahedra", "at least 1 in the volume"));
        }
        Ok(tets)
    }

    /// Returns the index in the file of each tag of a node.
    fn index(&self) -> Result<BTreeMap<u64, usize>, FemError> {
        let mut index = BTreeMap::new();
        for (k, (tag, line, _)) in self.file.nodes.iter().enumerate() {
            if let Some(first) = index.insert(*tag, k) {
                let expected = format!("another tag than on line {}", self.file.nodes[first].1);
                return Err(self.wrong(*line, &format!("node {tag} again"), &expected));
            }
        }
        Ok(index)
    }

    /// Returns the indices in the file of an element's nodes.
    fn ids(&self, element: &Element, index: &BTreeMap<u64, usize>) -> Result<Vec<usize>, FemError> {
        let of = |tag: &u64| {
            let id = index.get(tag).copied();
            id.ok_or_else(|| self.wrong(element.line, &format!("node {tag}"), "a node of the file"))
        };
        element.nodes.iter().map(of).collect()
    }

    /// Returns dimension and tag of the groups with a name, of a dimension of at least `from`.
    fn groups(&self, name: &str, from: u8) -> BTreeSet<(u8, i64)> {
        let named = self.file.names.iter();
        let named = named.filter(|((dimension, _), named)| *dimension >= from && *named == name);
        named.map(|(group, _)| *group).collect()
    }

    fn is_in(&self, element: &Element, groups: &BTreeSet<(u8, i64)>) -> bool {
        let of = self.file.groups.get(&element.entity);
        of.is_some_and(|of| {
            of.iter()
                .any(|tag| groups.contains(&(element.entity.0, *tag)))
        })
    }

    fn wrong(&self, line: u64, found: &str, expected: &str) -> FemError {
        lines::wrong(self.path, line, found, expected)
    }

    fn whole(&self, found: &str, expected: &str) -> FemError {
        FemError::File {
            path: self.path.to_owned(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}
