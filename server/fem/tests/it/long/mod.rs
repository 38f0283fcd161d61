//! Proofs of minutes; see the table of long proofs in `sulcus-support`.

mod condense;
mod nonlinear_reference;
