//! The server's own commands: tokens, certificate and plans; trees and tissues.

mod administration;
mod cases;
mod common;
mod long;
mod tissue;
mod tree;
mod tree_inputs;
