//! Comparison with the reference solutions of a tongue in the data folder beside the project, which were checked
//! against CalculiX.

use std::path::PathBuf;

use crate::common::{TONGUE, load, off, reference};
use proptest::prelude::*;
use sulcus_fem::Factored;
use sulcus_fem::files::read_mesh;

#[test]
fn linear_cases_are_those_of_the_reference_at_every_vertex() {
    let Some(folder) = reference() else { return };
    let mesh = read_mesh(&folder).expect("a mesh");
    let n = mesh.nodes.len();
    let factored = Factored::new(&mesh, &TONGUE).expect("held");
    let cases = [
        ("tip_vertical", "1.5"),
        ("lateral", "2.5"),
        ("top_distributed", "6"),
    ];
    let loads = cases.map(|(name, newtons)| load(&folder, name, newtons, n));
    let answers = factored.solve(&loads).expect("finite");
    for ((name, newtons), moved) in cases.iter().zip(&answers) {
        let off = off(&folder, &format!("{name}_lin_{newtons}N.csv"), moved);
        assert!(off <= 5e-3, "{name}: {off:e}");
    }
}

#[test]
fn a_broken_table_is_refused_with_its_line() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fem");
    std::fs::create_dir_all(&folder).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file");
    write(
        "nodes.csv",
        "id,x,y,z,kind\n0,0,0,0,a\n1,10,0,0,a\n2,0,10,0,a\n3,0,0,10,a\n",
    );
    write("fixed_all_nodes.csv", "id\n0\n");
    let head = "id,n0,n1,n2,n3,m01,m12,m02,m03,m13,m23\n";
    write("tets10.csv", &format!("{head}0,0,1,2,3,0,1,2,3,0,9\n"));
    let said = || read_mesh(&folder).expect_err("broken").to_string();
    assert!(
        said().contains("tets10.csv, line 2: node 9, expected below 4"),
        "{}",
        said()
    );
    write("tets10.csv", &format!("{head}0,0,1,2\n"));
    assert!(said().contains("tets10.csv, line 2"), "{}", said());
    write("tets10.csv", &format!("{head}1,0,1,2,3,0,1,2,3,0,1\n"));
    assert!(said().contains("id 1, expected id 0"), "{}", said());
    write("nodes.csv", "id,x,y,z,kind\n0,0,zero,0,a\n");
    assert!(
        said().contains("nodes.csv, line 2") && said().contains("field 2"),
        "{}",
        said()
    );
    std::fs::remove_file(folder.join("nodes.csv")).expect("removed");
    assert!(said().contains("nodes.csv"), "{}", said());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// A good folder with one damaged table. The reader returns an error or a mesh, and never panics. A mesh can be
    /// checked, and is factored or refused.
    #[test]
    fn damaged_tables_never_panic(which in 0..3_usize, at in any::<prop::sample::Index>(), put in prop::collection::vec(any::<u8>(), 0..6)) {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fem-damaged");
        std::fs::create_dir_all(&folder).expect("a folder");
        let mut tables = [
            ("nodes.csv", "id,x,y,z\n0,0,0,0\n1,9,0,0\n2,0,9,0\n3,0,0,9\n4,4.5,0,0\n5,4.5,4.5,0\n6,0,4.5,0\n7,0,0,4.5\n8,4.5,0,4.5\n9,0,4.5,4.5\n"),
            ("tets10.csv", "id,n0,n1,n2,n3,m01,m12,m02,m03,m13,m23\n0,0,1,2,3,4,5,6,7,8,9\n"),
            ("fixed_all_nodes.csv", "id\n0\n1\n2\n"),
        ].map(|(name, text)| (name, text.as_bytes().to_vec()));
        let bytes = &mut tables[which].1;
        let at = at.index(bytes.len());
        let end = (at + put.len()).min(bytes.len());
        bytes.splice(at..end, put.iter().copied());
        for (name, bytes) in &tables {
            std::fs::write(folder.join(name), bytes).expect("a file");
        }
        if let Ok(mesh) = read_mesh(&folder) {
            let _ = Factored::new(&mesh, &TONGUE);
        }
    }
}
