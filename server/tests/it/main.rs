//! The server's own commands on trees and tissues.

mod common;
mod long;
mod tissue;
mod tree;
mod tree_inputs;
