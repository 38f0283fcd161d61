//! Nodes and elements of format 2.2, one on each line. Source: Gmsh reference manual, "MSH file format version 2
//! (Legacy)".

use super::lines::Lines;
use super::sections::{Element, Sections, count, known, place};
use crate::error::FemError;

impl Sections {
    pub(super) fn nodes_22(&mut self, lines: &mut Lines<'_>) -> Result<(), FemError> {
        for _ in 0..count(lines, "number of nodes")? {
            let expected = "tag, x, y, z";
            let line = lines.take(expected)?;
            let mut numbers = line.numbers();
            let tag = numbers.next(expected)?;
            self.nodes
                .push((tag, line.number, place(&line, numbers.all(3, expected)?)?));
        }
        lines.end("$EndNodes")
    }

    pub(super) fn elements_22(&mut self, lines: &mut Lines<'_>) -> Result<(), FemError> {
        for _ in 0..count(lines, "number of elements")? {
            let expected = "tag, kind, number of tags, tags, nodes";
            let line = lines.take(expected)?;
            let mut numbers = line.numbers();
            let _tag: u64 = numbers.next(expected)?;
            let kind = numbers.next(expected)?;
            let (dimension, nodes) = known(&line, kind)?;
            let tags: usize = numbers.next(expected)?;
            // The first tag is the physical group; 0 means none.
            let group = if tags > 0 { numbers.next(expected)? } else { 0 };
            for _ in 1..tags {
                let _: i64 = numbers.next(expected)?;
            }
            let entity = (dimension, i64::saturating_abs(group));
            if entity.1 != 0 {
                self.groups.entry(entity).or_insert_with(|| vec![entity.1]);
            }
            self.elements.push(Element {
                line: line.number,
                kind,
                entity,
                nodes: numbers.all(nodes, expected)?,
            });
        }
        lines.end("$EndElements")
    }
}
