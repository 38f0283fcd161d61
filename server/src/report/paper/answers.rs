//! Answers on their way into the order of the paper.

use std::collections::BTreeMap;

use super::printed::PRINTED;
use super::{Beside, Curve};

/// What was found for one printed thing.
struct Answer {
    measured: Option<String>,
    values: Vec<(&'static str, f64)>,
    how: String,
}

/// What was found, by the id of what is printed.
#[derive(Default)]
pub(super) struct Answers {
    found: BTreeMap<&'static str, Answer>,
    curves: Vec<Curve>,
}

impl Answers {
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
            measured: Some(measured.into()),
            values: values.to_vec(),
            how: how.into(),
        };
        self.put(id, answer);
    }

    /// Nothing can be measured, and why.
    pub(super) fn unmeasured(&mut self, id: &'static str, why: impl Into<String>) {
        let answer = Answer {
            measured: None,
            values: Vec::new(),
            how: why.into(),
        };
        self.put(id, answer);
    }

    fn put(&mut self, id: &'static str, answer: Answer) {
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

    /// Everything printed, in order, with its answer.
    ///
    /// # Panics
    /// When something has none: a fault of this report.
    pub(super) fn in_order(mut self) -> (Vec<Beside>, Vec<Curve>) {
        let rows = PRINTED.iter().map(|printed| {
            let answer = self.found.remove(printed.id);
            let answer = answer.unwrap_or_else(|| panic!("{} has no answer", printed.id));
            Beside {
                printed,
                measured: answer.measured,
                values: answer.values,
                how: answer.how,
            }
        });
        (rows.collect(), self.curves)
    }
}
