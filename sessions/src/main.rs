//! Entry point of `sulcus-sessions`; the library has the program.

fn main() -> std::process::ExitCode {
    sulcus_sessions::run(std::env::args_os())
}
