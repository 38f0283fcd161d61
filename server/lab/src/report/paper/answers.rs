//! Answers on their way into the order of the paper.

use std::collections::BTreeMap;

use super::printed::PRINTED;
use super::{Beside, Curve, Part};

/// What was found for one printed thing.
struct Answer {
    measured: String,
    values: Vec<(&'static str, f64)>,
    how: String,
    part: Part,
}

/// What was found, by the id of what is printed.
pub(super) struct Answers {
    found: BTreeMap<&'static str, Answer>,
    curves: Vec<Curve>,
    /// What answers now.
    part: Part,
}

impl Answers {
    /// None yet.
    pub(super) fn none() -> Self {
        Self {
            found: BTreeMap::new(),
            curves: Vec::new(),
            part: Part::Machine,
        }
    }

    /// From now on `part` answers.
    pub(super) fn begin_part(&mut self, part: Part) {
        self.part = part;
    }

    /// Something was measured.
    ///
    /// # Panics
    /// When nothing of that id is printed, or it was answered already: a fault of this report.
    pub(super) fn measured(
        &mut self,
        id: &'static str,
        measured: impl Into<String>,
        values: &[(&'static str, f64)],
        how: impl Into<String>,
    ) {
        let answer = Answer {
            measured: measured.into(),
            values: values.to_vec(),
            how: how.into(),
            part: self.part,
        };
        assert!(
            PRINTED.iter().any(|printed| printed.id == id),
            "nothing printed is called {id}"
        );
        assert!(
            self.found.insert(id, answer).is_none(),
            "{id} is answered twice"
        );
    }

    /// One more diagram.
    pub(super) fn curve(&mut self, curve: Curve) {
        self.curves.push(curve);
    }

    /// Everything printed that was answered, in order, with its answer.
    pub(super) fn in_order(mut self) -> (Vec<Beside>, Vec<Curve>) {
        let rows = PRINTED.iter().filter_map(|printed| {
            let answer = self.found.remove(printed.id)?;
            Some(Beside {
                printed,
                measured: answer.measured,
                values: answer.values,
                how: answer.how,
                part: answer.part,
            })
        });
        (rows.collect(), self.curves)
    }
}
