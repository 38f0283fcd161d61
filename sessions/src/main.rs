//! Thin main over the library.

fn main() -> std::process::ExitCode {
    sulcus_sessions::run(std::env::args_os())
}
