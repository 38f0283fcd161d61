//! The wire: control messages and datagrams.

mod control;
mod datagrams;
