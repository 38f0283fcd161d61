//! The same tongue and the same gingiva by the printed method: named in the scene file, refused beyond its limit.

use std::path::Path;

use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;
use sulcus_scene::compile::compile_text;
use sulcus_scene::{BuildOptions, BuiltIn};

/// Builds a text, with the trees of the program.
fn build(text: &str) -> Result<Scene, String> {
    compile_text(
        text,
        Path::new("my.toml"),
        &BuildOptions::default(),
        &|_, _| {},
    )
    .map(|compiled| compiled.scene)
    .map_err(|error| error.to_string())
}

fn tongue(tissue: &str, table: &str) -> Result<Scene, String> {
    let text = BuiltIn::Tongue
        .text()
        .replace("tissue = \"skeleton\"", &format!("tissue = \"{tissue}\""));
    build(&format!("{text}\n{table}\n"))
}

fn pocket(tissue: &str, table: &str) -> Result<Scene, String> {
    let text = BuiltIn::Pocket
        .text()
        .replace("tissue = \"gingiva\"", &format!("tissue = \"{tissue}\""));
    build(&format!("{text}\n{table}\n"))
}

#[test]
fn the_same_tongue_runs_by_either_method() {
    let coupled = tongue("skeleton", "").expect("as shipped");
    let printed = tongue("printed_skeleton", "").expect("stable by default");
    let (a, b) = (&coupled.objects[0], &printed.objects[0]);
    assert_eq!(a.tree, b.tree);
    let (TissueModel::Skeleton(a), TissueModel::PrintedSkeleton(model)) = (&a.tissue, &b.tissue)
    else {
        panic!("{:?} and {:?}", a.tissue, b.tissue);
    };
    assert_eq!(model.springs.len(), a.coarse.springs.len());
    let held = a.coarse.fixed.iter().filter(|fixed| **fixed).count();
    assert_eq!(model.fixed.len(), held);
    let mean = a
        .coarse
        .springs
        .iter()
        .flat_map(|s| s.stiffness)
        .sum::<f64>()
        / (3 * a.coarse.springs.len()) as f64;
    assert!((model.spring_n_per_m / mean - 1.0).abs() < 1e-12);
    assert_eq!((model.mass_kg, model.penalty_n_per_m), (0.02, 5.0));
    let given = "[object.printed_skeleton]\nspring_n_per_mm = 0.05\nmass_g = 25.0\npenalty_n_per_mm = 0.002\ndamping_n_s_per_m = 15.0\ncontact_distance_mm = 0.4";
    let scene = tongue("printed_skeleton", given).expect("stable");
    let TissueModel::PrintedSkeleton(model) = &scene.objects[0].tissue else {
        panic!("printed");
    };
    let found = [
        model.spring_n_per_m,
        model.mass_kg,
        model.penalty_n_per_m,
        model.damping_n_s_per_m,
        model.contact_distance_m,
    ];
    for (found, wanted) in found.iter().zip([50.0, 0.025, 2.0, 15.0, 4e-4]) {
        assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
    }
}

#[test]
fn the_papers_own_numbers_are_refused_and_told_what_would_do() {
    // Section 8.1: 0.5 N/mm and 0.6 N s/mm, with Table 1's 20 g.
    let table = "[object.printed_skeleton]\nspring_n_per_mm = 0.5\ndamping_n_s_per_m = 600.0";
    let said = tongue("printed_skeleton", table).expect_err("20 g per sphere");
    for word in [
        "`tongue`",
        "spring at most",
        "mass at least",
        "time step of at most",
    ] {
        assert!(said.contains(word), "{said}");
    }
    println!("{said}");
    let heavy = format!("{table}\nmass_g = 301.0");
    tongue("printed_skeleton", &heavy).expect("0.3 kg per sphere");
}

#[test]
fn the_same_gingiva_runs_by_either_method() {
    let coupled = pocket("gingiva", "").expect("as shipped");
    let printed = pocket("printed_gingiva", "").expect("as printed");
    let (a, b) = (&coupled.objects[1], &printed.objects[1]);
    assert_eq!(a.tree, b.tree);
    let (TissueModel::Gingiva(a), TissueModel::PrintedGingiva(model)) = (&a.tissue, &b.tissue)
    else {
        panic!("{:?} and {:?}", a.tissue, b.tissue);
    };
    assert_eq!(model.tooth, 0);
    assert_eq!(model.stiffness_n_per_m, a.params.wall_stiffness);
    let ids: Vec<u32> = b.tree.shape_at(model.level).map(|(id, _)| id).collect();
    let mut still = 0;
    for (inward, id) in model.inward.iter().zip(&ids) {
        let place = &a.places[*id as usize];
        if place.height > 0.0 && !place.floor {
            assert_eq!(*inward, place.away);
        } else {
            assert_eq!(inward.norm(), 0.0);
            still += 1;
        }
    }
    assert!(still > 0 && still < ids.len(), "{still} of {}", ids.len());
    let refused = pocket(
        "printed_gingiva",
        "[object.printed_gingiva]\nattenuation_per_mm = 1.5",
    );
    let said = refused.expect_err("no attenuation");
    assert!(
        said.contains("attenuation_per_mm is 1.5") && said.contains("`gingiva 36`"),
        "{said}"
    );
}

#[test]
fn tables_of_the_other_method_are_refused() {
    let said = tongue("skeleton", "[object.printed_skeleton]").expect_err("coupled");
    assert!(
        said.contains("`printed_skeleton` of object `tongue`"),
        "{said}"
    );
    let said = pocket("gingiva", "[object.printed_gingiva]").expect_err("coupled");
    assert!(
        said.contains("`printed_gingiva` of object `gingiva 36`"),
        "{said}"
    );
}
