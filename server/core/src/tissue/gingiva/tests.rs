//! The kernel, its books, its way in time, its zones.
