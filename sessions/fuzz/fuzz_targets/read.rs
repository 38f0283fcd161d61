//! Any bytes as a recording: a clear error or an answer, no panic, whatever is asked of them (what is, the tests of the workspace
//! compile and ask, too). Start from real ones:
//!
//! ```text
//! cargo fuzz run --features fuzzer read -- -max_len=300000 tests/corpus   (in `sessions`; copy the folder first, libFuzzer adds to it)
//! ```
#![no_main]

#[path = "../../tests/it/common/ask.rs"]
mod ask;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // An error is an answer. (A fuzzer can make a tick's hash wrong with a right CRC: whether it replays is not asked.)
    let _ = ask::ask(bytes);
});
