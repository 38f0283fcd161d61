//! Entities, nodes and elements of format 4.1. Nodes and elements are in blocks, one for each entity.
//!
//! Source: Gmsh reference manual, "MSH file format".

use super::lines::{Line, Lines};
use super::sections::{Element, Sections, dimension, known, place};
use crate::error::FemError;

impl Sections {
    /// Reads points, curves, surfaces and volumes of format 4.1, and keeps their physical groups.
    pub(super) fn entities(&mut self, lines: &mut Lines<'_>) -> Result<(), FemError> {
        let line = lines.take("numbers of points, curves, surfaces, volumes")?;
        let mut numbers = line.numbers();
        let mut counts = [0_u64; 4];
        for count in &mut counts {
            *count = numbers.next("numbers of points, curves, surfaces, volumes")?;
        }
        for (dimension, count) in (0..).zip(counts) {
            let expected = match dimension {
                0 => "tag, x, y, z, number of groups, groups",
                _ => "tag, box, number of groups, groups",
            };
            for _ in 0..count {
                let line = lines.take(expected)?;
                let mut numbers = line.numbers();
                let tag: i64 = numbers.next(expected)?;
                let extent: Vec<f64> = numbers.all(if dimension == 0 { 3 } else { 6 }, expected)?;
                drop(extent);
                let groups: usize = numbers.next(expected)?;
                // The sign gives the orientation.
                let groups =
                    (0..groups).map(|_| Ok(numbers.next::<i64>(expected)?.saturating_abs()));
                let groups: Result<Vec<i64>, FemError> = groups.collect();
                self.groups.insert((dimension, tag), groups?);
            }
        }
        lines.end("$EndEntities")
    }

    pub(super) fn nodes_41(&mut self, lines: &mut Lines<'_>) -> Result<(), FemError> {
        let (head, blocks, all) = blocks(lines)?;
        let mut tags = Vec::new();
        for _ in 0..blocks {
            let expected = "dimension, entity, 0 or 1, number of nodes";
            let line = lines.take(expected)?;
            let mut numbers = line.numbers();
            let _entity: Vec<i64> = numbers.all(3, expected)?;
            let count: u64 = numbers.next(expected)?;
            tags.clear();
            for _ in 0..count {
                tags.push(
                    lines
                        .take("tag of a node")?
                        .numbers()
                        .next("tag of a node")?,
                );
            }
            for &tag in &tags {
                // The remaining numbers are coordinates on the entity.
                let expected = "x, y, z";
                let line = lines.take(expected)?;
                let at = line.numbers().all(3, expected)?;
                self.nodes.push((tag, line.number, place(&line, at)?));
            }
        }
        in_all(&head, self.nodes.len(), all)?;
        lines.end("$EndNodes")
    }

    pub(super) fn elements_41(&mut self, lines: &mut Lines<'_>) -> Result<(), FemError> {
        let (head, blocks, all) = blocks(lines)?;
        for _ in 0..blocks {
            let expected = "dimension, entity, kind, number of elements";
            let line = lines.take(expected)?;
            let mut numbers = line.numbers();
            let dimension = dimension(&line, numbers.next(expected)?)?;
            let entity = (dimension, numbers.next(expected)?);
            let kind = numbers.next(expected)?;
            let (of_kind, nodes) = known(&line, kind)?;
            if of_kind != dimension {
                let found = format!("kind {kind} in dimension {dimension}");
                return Err(line.wrong(&found, &format!("dimension {of_kind}")));
            }
            let count: u64 = numbers.next(expected)?;
            for _ in 0..count {
                let expected = "tag, nodes";
                let line = lines.take(expected)?;
                let mut numbers = line.numbers();
                let _tag: u64 = numbers.next(expected)?;
                self.elements.push(Element {
                    line: line.number,
                    kind,
                    entity,
                    nodes: numbers.all(nodes, expected)?,
                });
            }
        }
        in_all(&head, self.elements.len(), all)?;
        lines.end("$EndElements")
    }
}

/// Reads the head of a section in blocks: its line, the number of blocks, and the number of items in all blocks.
fn blocks<'a>(lines: &mut Lines<'a>) -> Result<(Line<'a>, u64, u64), FemError> {
    let expected = "number of blocks, number in all, least and greatest tag";
    let line = lines.take(expected)?;
    let mut numbers = line.numbers();
    let counts = (numbers.next(expected)?, numbers.next(expected)?);
    let _range: Vec<u64> = numbers.all(2, expected)?;
    Ok((line, counts.0, counts.1))
}

/// Checks that the blocks have as many items as the head states.
fn in_all(head: &Line<'_>, found: usize, expected: u64) -> Result<(), FemError> {
    if found as u64 == expected {
        return Ok(());
    }
    Err(head.wrong(&format!("{found} in its blocks"), &expected.to_string()))
}
