//! Entry point of `sulcus-review`; the library has the program.

fn main() -> std::process::ExitCode {
    sulcus_view::run(std::env::args_os())
}
