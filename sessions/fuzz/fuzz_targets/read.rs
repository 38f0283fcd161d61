//! Fuzz target `read`: any bytes as a recording. Every question gets an answer or an error, and no code panics.
//! The tests of the workspace compile the same questions and ask them, too.
//!
//! The corpus of the tests is a good start. libFuzzer adds files to the folder, so copy the folder first. In
//! `sessions`:
//!
//! ```text
//! cargo fuzz run --features fuzzer read -- -max_len=300000 COPY
//! ```
#![no_main]

#[path = "../../tests/it/common/ask.rs"]
mod ask;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // An error is a valid answer. A fuzzer can make a tick's hash wrong with a right CRC, so the result of a replay is
    // not checked.
    let _ = ask::ask(bytes);
});
