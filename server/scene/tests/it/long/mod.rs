//! Proofs of minutes; see the table of long proofs in `sulcus-support`.

mod parametric_parts;
mod real_parts;
