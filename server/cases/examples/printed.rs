//! The method as printed beside the coupled one, in numbers: the benchmark with one degree of freedom, then the hard
//! cases that the paper is about. Names on the command line choose among the cases.

use sulcus_cases::comparison::{Compared, Method, by_hand, compare, compare_changed};
use sulcus_cases::find;
use sulcus_cases::one_dof::Table;
use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;

/// Cases that stand in the table when none is named.
const CASES: [&str; 4] = [
    "pocket-0.4",
    "pocket-0.65",
    "tongue-10-k0.5",
    "tongue-10-k2",
];

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
    println!("{}", Table::run());
    let named: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&str> = if named.is_empty() {
        CASES.to_vec()
    } else {
        named.iter().map(String::as_str).collect()
    };
    println!("{}", Compared::heading());
    for name in names {
        let Some(case) = find(name) else {
            println!("{name}: no such case");
            continue;
        };
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
