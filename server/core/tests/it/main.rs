//! Integration tests of the tick: comparison with the solver Clarabel, and comparison with and without caches.

mod coherence;
mod judge;
