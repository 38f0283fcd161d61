//! The table of long proofs, and the selection of a run.
//!
//! `SULCUS_LONG=all` selects every proof. `SULCUS_LONG=slice:N` selects the proofs of slice `N` modulo the number of
//! [`slices`]. A list of names with commas selects these proofs, and an unset variable none.
//!
//! `.ci/run` runs one slice each time: `cargo test --workspace -- long::`, with the number of commits as `N`. Every
//! proof is a test in a module `long`, so that this filter finds all of them.

/// Environment variable with the selection.
const SELECT: &str = "SULCUS_LONG";

/// Longest slice, minutes on two cores.
pub const SLICE_MINUTES: f64 = 6.0;

/// A proof that takes minutes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Long {
    /// Name, for `SULCUS_LONG`.
    pub name: &'static str,
    /// Claim of the proof, one sentence.
    pub proves: &'static str,
    /// Duration on two cores, minutes.
    pub minutes: f64,
}

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

/// Names of the proofs of every slice. A slice holds as many successive proofs of the table as fit into
/// [`SLICE_MINUTES`].
pub fn slices() -> Vec<Vec<&'static str>> {
    let mut slices: Vec<Vec<&'static str>> = Vec::new();
    let mut room = 0.0;
    for long in LONG {
        if long.minutes > room || slices.is_empty() {
            slices.push(Vec::new());
            room = SLICE_MINUTES;
        }
        room -= long.minutes;
        if let Some(slice) = slices.last_mut() {
            slice.push(long.name);
        }
    }
    slices
}

/// Names of the proofs of a selection; the error is a message with the accepted forms.
fn chosen(selection: &str) -> Result<Vec<&'static str>, String> {
    if selection == "all" {
        return Ok(LONG.iter().map(|long| long.name).collect());
    }
    if let Some(number) = selection.strip_prefix("slice:") {
        let number: usize = number
            .trim()
            .parse()
            .map_err(|_| format!("{SELECT} is `{selection}`, expected a number behind `slice:`"))?;
        let mut slices = slices();
        let index = number % slices.len();
        return Ok(slices.swap_remove(index));
    }
    let names = selection.split(',').map(str::trim);
    let names = names.filter(|name| !name.is_empty());
    let known = |name: &str| {
        let found = LONG.iter().find(|long| long.name == name);
        found.map(|long| long.name).ok_or_else(|| {
            let all: Vec<_> = LONG.iter().map(|long| long.name).collect();
            format!(
                "{SELECT} names `{name}`, expected `all`, `slice:N` or some of: {}",
                all.join(", ")
            )
        })
    };
    names.map(known).collect()
}

#[cfg(test)]
mod tests;
