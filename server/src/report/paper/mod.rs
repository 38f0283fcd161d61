//! The paper, figure by figure: everything that it prints beside what this program measures on its own scenes.
//!
//! Every row of [`printed::PRINTED`] is answered once: with a measurement, or with the reason why there is none. Where the
//! text at hand has lost the printed value, what is measured stands alone.

mod answers;
mod contact;
mod elements;
mod many_rows;
mod one_dof;
mod pocket;
mod pocket_states;
#[cfg_attr(test, allow(dead_code, reason = "what the page alone shows"))]
pub(crate) mod printed;
mod rates;
mod ripple;
mod springs;
mod times;
mod tongue;
mod trees;
mod turning;
mod unmeasured;
mod whole_mouth;

use printed::Printed;
use sulcus_cases::multi_rate::{self, MultiRate};

use crate::tissue::against_fem::AgainstFem;
use answers::Answers;

/// One thing that the paper prints beside what this program measures.
pub(crate) struct Beside {
    /// What the paper prints.
    pub(crate) printed: &'static Printed,
    /// What was measured, with its unit; none where nothing can be measured here, with the reason in `how`.
    pub(crate) measured: Option<String>,
    /// Numbers by name, for other programs.
    pub(crate) values: Vec<(&'static str, f64)>,
    /// Scene, seed, case and conditions; or the reason.
    pub(crate) how: String,
}

/// Curves in one diagram.
pub(crate) struct Curve {
    /// Which figure of the paper, or "multi-rate".
    pub(crate) place: &'static str,
    /// What it shows.
    pub(crate) title: String,
    /// What runs along x, with its unit.
    pub(crate) x: &'static str,
    /// What runs along y, with its unit.
    pub(crate) y: &'static str,
    /// Name and points of each.
    pub(crate) series: Vec<(String, Vec<(f64, f64)>)>,
    /// Scene, hand, seed.
    pub(crate) note: String,
}

/// All of it.
pub(crate) struct Paper {
    /// In the order of the paper.
    pub(crate) rows: Vec<Beside>,
    /// By figure.
    pub(crate) curves: Vec<Curve>,
    /// One loop against two rates.
    pub(crate) multi_rate: MultiRate,
}

/// Measures everything; the comparison against finite elements was made already.
pub(crate) fn paper_beside(
    quick: bool,
    elements: &[AgainstFem],
    progress: &dyn Fn(&str, f64),
) -> Paper {
    let measured = untimed(quick, &|what, share| progress(what, UNTIMED * share));
    finished(quick, measured, elements, progress)
}

/// Share of the whole that is not timed.
const UNTIMED: f64 = 0.7;

/// All that is not a time.
fn untimed(quick: bool, progress: &dyn Fn(&str, f64)) -> (Answers, MultiRate) {
    let mut answers = Answers::default();
    unmeasured::answer(&mut answers);
    progress("one degree of freedom", 0.0);
    one_dof::answer(&mut answers);
    progress("sphere trees", 0.05);
    trees::answer(&mut answers);
    progress("a mirror on the tongue", 0.1);
    tongue::answer(&mut answers);
    progress("a probe in the pocket", 0.2);
    pocket::answer(&mut answers);
    progress("ripple", 0.4);
    ripple::answer(quick, &mut answers);
    progress("one loop against two rates", 0.6);
    let multi_rate = multi_rate::study(quick);
    rates::answer(&multi_rate, &mut answers);
    (answers, multi_rate)
}

/// The times, on a machine that does nothing else of this report meanwhile; and all of it in order.
fn finished(
    quick: bool,
    (mut answers, multi_rate): (Answers, MultiRate),
    elements: &[AgainstFem],
    progress: &dyn Fn(&str, f64),
) -> Paper {
    elements::answer(elements, &mut answers);
    progress("problems of 500 rows", UNTIMED);
    many_rows::answer(quick, &mut answers);
    progress("times of the stages", 0.75);
    times::answer(quick, &mut answers);
    progress("the whole mouth", 0.85);
    whole_mouth::answer(quick, &mut answers);
    progress("the paper", 1.0);
    let (rows, curves) = answers.in_order();
    Paper {
        rows,
        curves,
        multi_rate,
    }
}

#[cfg(test)]
mod tests;
