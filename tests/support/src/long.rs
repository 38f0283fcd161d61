//! The table of long proofs, and the selection of a run.
//!
//! `SULCUS_LONG=all` selects every proof, and `SULCUS_LONG=changed` the proofs whose sources differ from those of their
//! last pass: [`passed`]. A list of names with commas selects these proofs, and an unset variable none.
//!
//! Every proof is a test in a module `long`, so that `cargo test --workspace -- long::` finds all of them. `.ci/run`
//! runs none.

/// Environment variable with the selection.
const SELECT: &str = "SULCUS_LONG";

/// A proof that takes minutes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Long {
    /// Name, for `SULCUS_LONG`.
    pub name: &'static str,
    /// Package of the test.
    pub package: &'static str,
    /// Claim of the proof, one sentence.
    pub proves: &'static str,
    /// Duration on two cores, minutes.
    pub minutes: f64,
}

pub mod passed;
mod table;
pub use table::LONG;

/// Whether this run performs the proof `name`.
///
/// # Panics
/// The table has no such proof, or `SULCUS_LONG` has another form.
pub fn selected(name: &str) -> bool {
    assert!(
        LONG.iter().any(|long| long.name == name),
        "no long proof `{name}` in the table"
    );
    let selection = std::env::var(SELECT).unwrap_or_default();
    let chosen = chosen(&selection).unwrap_or_else(|message| panic!("{message}"));
    chosen.contains(&name)
}

/// Names of the proofs of a selection; the error is a message with the accepted forms.
fn chosen(selection: &str) -> Result<Vec<&'static str>, String> {
    if selection == "all" {
        return Ok(LONG.iter().map(|long| long.name).collect());
    }
    if selection == "changed" {
        let behind = passed::behind().map_err(|error| format!("{SELECT}=changed: {error}"))?;
        return Ok(behind.into_iter().map(|row| row.long.name).collect());
    }
    let names = selection.split(',').map(str::trim);
    let names = names.filter(|name| !name.is_empty());
    let known = |name: &str| {
        let found = LONG.iter().find(|long| long.name == name);
        found.map(|long| long.name).ok_or_else(|| {
            let all: Vec<_> = LONG.iter().map(|long| long.name).collect();
            format!(
                "{SELECT} names `{name}`, expected `all`, `changed` or some of: {}",
                all.join(", ")
            )
        })
    };
    names.map(known).collect()
}

#[cfg(test)]
mod tests;
