//! Proofs of minutes: see the table of long proofs in `sulcus-support`.

mod floods;
mod good_hand;
mod grades;
