//! The method as printed against the coupled one, on the cases that motivate the design.

use sulcus_cases::comparison::{Compared, Method, compare};
use sulcus_cases::find;

fn all(name: &str) -> [Compared; 3] {
    let case = find(name).expect("in the table");
    Method::ALL.map(|method| {
        let compared = compare(case, method);
        println!("{compared}");
        compared
    })
}

#[test]
fn in_a_pocket() {
    println!("{}", Compared::heading());
    for name in ["pocket-0.4", "pocket-0.65"] {
        let _ = all(name);
    }
}

#[test]
fn on_the_tongue() {
    println!("{}", Compared::heading());
    for name in ["tongue-10-k0.5", "tongue-10-k2"] {
        let _ = all(name);
    }
}
