//! The server's own commands on trees and tissues.

mod common;
mod tissue;
mod tree;
mod tree_inputs;
