//! The method as printed beside the coupled one, in numbers: the benchmark with one degree of freedom, then the hard
//! cases that the paper is about.

use clap::Parser;
use sulcus_cases::comparison::{Compared, Method, by_hand, compare, compare_changed};
use sulcus_cases::one_dof::Table;
use sulcus_cases::{Case, find};
use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;

/// Compare the method as printed with the coupled one
#[derive(Parser)]
struct Arguments {
    /// Names of hard cases
    #[arg(
        value_name = "CASE",
        value_parser = known,
        default_values = ["pocket-0.4", "pocket-0.65", "tongue-10-k0.5", "tongue-10-k2"]
    )]
    cases: Vec<&'static Case>,
}

/// Returns the hard case of that name.
fn known(name: &str) -> Result<&'static Case, String> {
    find(name).ok_or_else(|| format!("no hard case is called `{name}`"))
}

/// The penalty of every printed tissue multiplied.
fn penalty(scene: &mut Scene, by: f64) {
    for object in &mut scene.objects {
        match &mut object.tissue {
            TissueModel::PrintedSkeleton(model) => model.penalty_n_per_m *= by,
            TissueModel::PrintedGingiva(model) => model.penalty_n_per_m *= by,
            _ => {}
        }
    }
}

fn main() {
    let Arguments { cases } = Arguments::parse();
    println!("{}", Table::run());
    println!("{}", Compared::heading());
    for case in cases {
        for method in Method::ALL {
            println!("{}", compare(case, method));
        }
        let by = 4.0;
        let printed = compare_changed(case, Method::PrintedUnlimited, |scene| penalty(scene, by));
        println!("{printed} (K_p times {by})");
        let held = by_hand(case);
        for method in Method::ALL {
            println!("{} (by a hand that feels)", compare(&held, method));
        }
    }
}
