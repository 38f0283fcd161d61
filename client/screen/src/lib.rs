//! The student's screen.
