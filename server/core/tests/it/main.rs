//! The tick: judged by Clarabel, coherent with its own caches.

mod coherence;
mod judge;
