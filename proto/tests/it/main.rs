//! Tests of the wire format: control messages and datagrams.

mod control;
mod datagrams;
mod display;
mod live;
