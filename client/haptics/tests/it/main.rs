//! Judgement of the door of a hand, by rules of the tests' own.

mod dice;
mod faults;
mod in_step;
mod judge;
mod long;
mod named;
mod sequences;
mod threads;
mod world;
