//! Counted work of a tick, and its bound.
//!
//! The work is a weighted sum of counts ([`Counts`]): contacts, evaluations of blended surfaces, rows, products of the
//! solver, responses of tissue. An *operation* is the unit of the sum, about a nanosecond of the reference machine. The
//! counts depend on scene, state and input alone: not on the machine, and not on the caches of a workspace. A bound on
//! the work therefore keeps every replay bit-identical.
//!
//! Contact prediction is counted as its contacts and passes, although caches do most of its work: a count of the
//! cached work would differ after a restart from a snapshot.

/// Counts of one tick, the same on every machine and for every workspace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Ticks: 1.
    pub ticks: u64,
    /// Passes of contact prediction, for each tool.
    pub passes: u64,
    /// Spheres of the tools in passes before which the tool moved farther than its cached neighbours reach.
    pub moved: u64,
    /// Contacts listed, with those of lists that were full and searched again.
    pub contacts: u64,
    /// Pairs weighed for blended surfaces.
    pub weighed: u64,
    /// Compatibilities evaluated for blended surfaces.
    pub shared: u64,
    /// Contact rows written.
    pub rows: u64,
    /// Entries of the solver's factor that were computed, changed or used.
    pub entries: u64,
    /// Rows whose slack or gap the solver computed.
    pub slacks: u64,
    /// Products of the solver with the compliance of tissue.
    pub products: u64,
    /// Operations of tissue for its steps, compliances and loads, as declared by its model.
    pub tissue: u64,
    /// Contacts whose true gap was computed.
    pub gaps: u64,
}

/// Weights of the counts, in eighths of an operation, in the order of [`Counts::all`].
///
/// Source: least squares without negative weights of the CPU time of 220,000 ticks of the hard cases, each the fastest
/// of three, by `cargo run --release -p sulcus-cases --example work -- --ticks FILE`. Of ticks above 0.1 ms the sum
/// predicts the time within a tenth, and within a third where caches of contact prediction expire.
const WEIGHTS: [u64; 12] = [12_000, 16_000, 120, 140, 130, 40, 1_100, 9, 8, 6, 2, 104];
/// Work of a pass for each contact up to its rows, operations: contact, pair, and a share of the evaluations. A contact
/// list is so short that a first pass takes at most half of [`crate::Params::max_work`] for it.
const PER_CONTACT: u32 = 80;

/// Returns the largest number of contacts of all tools in a pass, for a bound on the work of `max_work` operations; 0
/// for no bound.
pub(crate) fn most_contacts(max_work: u32) -> usize {
    match max_work {
        0 => usize::MAX,
        _ => (max_work / (2 * PER_CONTACT)) as usize,
    }
}

impl Counts {
    /// Returns all counts, in the order of the fields.
    pub fn all(&self) -> [u64; 12] {
        [
            self.ticks,
            self.passes,
            self.moved,
            self.contacts,
            self.weighed,
            self.shared,
            self.rows,
            self.entries,
            self.slacks,
            self.products,
            self.tissue,
            self.gaps,
        ]
    }

    /// Adds evaluations of blended surfaces.
    pub(crate) fn add_blending(&mut self, effort: crate::blend::Effort) {
        self.weighed += effort.weighed;
        self.shared += effort.shared;
    }

    /// Adds a solve of `rows` rows.
    pub(crate) fn add_solve(&mut self, rows: usize, effort: crate::optimise::active_set::Effort) {
        self.rows += rows as u64;
        self.entries += effort.entries;
        self.slacks += effort.slacks;
        self.products += effort.products;
    }

    /// Returns the weighted sum, operations.
    pub fn work(&self) -> u64 {
        let weighted = self.all().into_iter().zip(WEIGHTS);
        weighted.map(|(count, weight)| count * weight).sum::<u64>() / 8
    }
}

/// Returns an estimate of the work of a solve and step, operations.
///
/// Measured over the hard cases: with tissue the solver and the compliances take two to three operations for each pair
/// of rows, without tissue 40 for each row.
pub(crate) fn solve_estimate(contacts: usize, rows: usize, tissue: bool) -> u64 {
    let (contacts, rows) = (contacts as u64, rows as u64);
    let pairs = if tissue { 2 * rows * rows } else { 40 * rows };
    13 * contacts + 138 * rows + pairs
}
