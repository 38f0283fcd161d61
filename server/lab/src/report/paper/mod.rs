//! The paper, figure by figure: everything that it prints beside what this program measures on its own scenes.
//!
//! Every row of [`printed::PRINTED`] is answered once, with a measurement. Where the text at hand has lost the printed value,
//! the measurement stands alone.

mod answers;
mod contact;
mod elements;
mod machine;
mod many_rows;
mod one_dof;
mod pocket;
mod pocket_states;
pub(crate) mod printed;
mod rates;
mod ripple;
mod springs;
mod times;
mod tongue;
mod trees;
mod turning;
mod whole_mouth;

use clap::ValueEnum;
use printed::Printed;
use sulcus_cases::multi_rate::{self, MultiRate};

use crate::tissue::against_fem::{AgainstFem, against_fem};
use answers::Answers;

/// One thing that the paper prints beside what this program measures.
pub(crate) struct Beside {
    /// What the paper prints.
    pub(crate) printed: &'static Printed,
    /// What was measured, with its unit.
    pub(crate) measured: String,
    /// Numbers by name, for other programs.
    pub(crate) values: Vec<(&'static str, f64)>,
    /// Scene, seed, case and conditions.
    pub(crate) how: String,
    /// What it was measured with.
    pub(crate) part: Part,
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

/// What was asked for.
pub(crate) struct Paper {
    /// In the order of the paper.
    pub(crate) rows: Vec<Beside>,
    /// By figure.
    pub(crate) curves: Vec<Curve>,
    /// One loop against two rates; none where that was not asked for.
    pub(crate) multi_rate: Option<MultiRate>,
}

/// What is measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Part {
    /// This machine: section 8
    Machine,
    /// Springs of one degree of freedom: Eq. 9, Fig. 7, Table 1
    OneDof,
    /// Sphere trees and skeleton: sections 2, 3.1, 5.1 and 8.4
    Trees,
    /// A mirror on the tongue: Fig. 4 and 14
    Tongue,
    /// A probe in the pocket: Fig. 16 to 18
    Pocket,
    /// Force error of the spheres: section 8.4
    Ripple,
    /// One loop against two rates: sections 1.2.2 and 9
    Rates,
    /// Tissue against finite elements: Fig. 15
    Elements,
    /// Problems of 500 rows: section 3.2
    ManyRows,
    /// Times of the stages: Table 2
    Times,
    /// Two hands in the whole mouth: Fig. 19 and Table 3
    WholeMouth,
}

impl Part {
    /// All, with their shares of the time (the elements' aside: their comparison is made elsewhere). Times come last.
    pub(crate) const ALL: [(Self, f64); 11] = [
        (Self::Machine, 0.0),
        (Self::OneDof, 0.04),
        (Self::Trees, 0.04),
        (Self::Tongue, 0.07),
        (Self::Pocket, 0.14),
        (Self::Ripple, 0.14),
        (Self::Rates, 0.27),
        (Self::Elements, 0.0),
        (Self::ManyRows, 0.04),
        (Self::Times, 0.07),
        (Self::WholeMouth, 0.19),
    ];

    /// As on the command line.
    pub(crate) fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or(String::new(), |value| value.get_name().to_owned())
    }

    /// What measures it again.
    pub(crate) fn command(self, quick: bool) -> String {
        let quick = if quick { " --quick" } else { "" };
        format!("sulcus-server report --paper={}{quick}", self.name())
    }
}

/// Measures everything; the comparison against finite elements was made already.
pub(crate) fn paper_beside(
    quick: bool,
    elements: &[AgainstFem],
    progress: &dyn Fn(&str, f64),
) -> Paper {
    let paper = of_parts(&Part::ALL, quick, elements, progress);
    for printed in printed::PRINTED {
        let answered = paper.rows.iter().any(|row| row.printed.id == printed.id);
        assert!(answered, "{} has no answer", printed.id);
    }
    paper
}

/// Measures one part.
///
/// # Errors
/// If finite elements find no equilibrium: a fault of this program.
pub(crate) fn paper_part(
    part: Part,
    quick: bool,
    progress: &dyn Fn(&str, f64),
) -> anyhow::Result<Paper> {
    let elements = match part {
        Part::Elements => against_fem(quick, progress)?,
        _ => Vec::new(),
    };
    Ok(of_parts(&[(part, 1.0)], quick, &elements, progress))
}

fn of_parts(
    parts: &[(Part, f64)],
    quick: bool,
    elements: &[AgainstFem],
    progress: &dyn Fn(&str, f64),
) -> Paper {
    let mut answers = Answers::none();
    let (mut multi_rate, mut before) = (None, 0.0);
    for &(part, share) in parts {
        progress(&part.name(), before);
        before += share;
        answers.begin_part(part);
        let answers = &mut answers;
        match part {
            Part::Machine => machine::answer(answers),
            Part::OneDof => one_dof::answer(answers),
            Part::Trees => trees::answer(answers),
            Part::Tongue => tongue::answer(answers),
            Part::Pocket => pocket::answer(answers),
            Part::Ripple => ripple::answer(quick, answers),
            Part::Rates => {
                let found = multi_rate.insert(multi_rate::study(quick));
                rates::answer(found, answers);
            }
            Part::Elements => elements::answer(elements, answers),
            Part::ManyRows => many_rows::answer(quick, answers),
            Part::Times => times::answer(quick, answers),
            Part::WholeMouth => whole_mouth::answer(quick, answers),
        }
    }
    progress("the paper", 1.0);
    let (rows, curves) = answers.in_order();
    Paper {
        rows,
        curves,
        multi_rate,
    }
}

#[cfg(test)]
mod long;
