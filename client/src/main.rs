//! `sulcus-client`: a thin main over the library.

fn main() -> std::process::ExitCode {
    sulcus_client::run()
}
