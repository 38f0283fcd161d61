//! Everything that names rerun; nothing else does.
//!
//! Here will be: the live view of a session that is running, the review of a recorded one, and the
//! blueprint that arranges both. All of it reads what `sulcus-sessions` gives and sends it to
//! Rerun, behind a feature of the binaries, so that nobody else compiles Rerun.
