//! Motion of a stage: vertices that follow handles, and blood.

use std::ops::Range;

use nalgebra::Vector3;
use sulcus_proto::display::Moved;

use crate::blood;
use crate::moment::Moment;
use crate::plan;
use crate::stage::{MM, Stage};

impl Stage {
    /// Moves tissue to an instant. Returns the ranges of vertices that changed.
    pub fn follow(&mut self, moment: &Moment) -> Vec<Range<usize>> {
        let mut changed: Vec<usize> = Vec::new();
        let listed = moment.moved.iter().map(|moved| moved.object);
        let before = std::mem::replace(&mut self.displaced, listed.collect());
        for object in before {
            let still = moment.moved.iter().all(|moved| moved.object != object);
            if let Some(k) = self.number(object).filter(|_| still) {
                self.settle(k);
                changed.push(k);
            }
        }
        for moved in &moment.moved {
            if let Some(k) = self.number(moved.object) {
                self.displace(k, moved);
                changed.push(k);
            }
        }
        changed.sort_unstable();
        for k in 0..self.chunks.len() {
            if changed.binary_search(&self.chunks[k].part).is_ok() {
                self.chunks[k].ball = plan::around(self, &self.chunks[k].corners);
            }
        }
        let touched = self
            .normals
            .update(&changed, &self.parts, &self.corners, &mut self.moving);
        let mut ranges: Vec<Range<usize>> = touched
            .iter()
            .map(|k| self.parts[*k].vertices.clone())
            .collect();
        let spots = moment.spots.iter();
        let bled: Vec<_> = spots
            .map(|(spot, age)| (*spot, age.min(blood::WHOLE_S)))
            .collect();
        // Blood that has spread whole changes no more.
        if bled != self.bled {
            ranges.extend(blood::spread(self, &bled));
            self.bled = bled;
        }
        ranges
    }

    fn number(&self, object: u16) -> Option<usize> {
        let owner = crate::stage::Owner::Object(object);
        self.parts.iter().position(|part| part.owner == owner)
    }

    /// Puts the vertices of a part to rest.
    fn settle(&mut self, part: usize) {
        for v in self.parts[part].vertices.clone() {
            self.moving[v].at = self.still[v].rest;
        }
    }

    /// Displaces the vertices of an object by `sum_i w_vi u_i`.
    fn displace(&mut self, part: usize, moved: &Moved) {
        let Some(Some((skin, kept))) = self.skins.get(usize::from(moved.object)) else {
            return;
        };
        let mut by = vec![Vector3::zeros(); skin.handles.len()];
        for handle in &moved.handles {
            if let Some(by) = by.get_mut(usize::from(handle.handle)) {
                *by = Vector3::from(handle.by_m()) * MM;
            }
        }
        for (v, own) in self.parts[part].vertices.clone().zip(kept) {
            let carriers = skin.carriers(*own as usize);
            let sum: Vector3<f32> = carriers
                .map(|(k, weight)| by[usize::from(k)] * weight)
                .sum();
            self.moving[v].at = (Vector3::from(self.still[v].rest) + sum).into();
        }
    }
}
