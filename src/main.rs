//! The command `mmxrt`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
