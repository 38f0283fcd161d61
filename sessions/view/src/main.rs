//! Thin main over the library.

fn main() -> std::process::ExitCode {
    sulcus_view::run(std::env::args_os())
}
