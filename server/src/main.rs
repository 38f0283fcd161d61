//! Thin main over the library.

fn main() -> std::process::ExitCode {
    sulcus_server::cli::run(std::env::args_os())
}
