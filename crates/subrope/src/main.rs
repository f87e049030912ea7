//! The `subrope` command.

fn main() -> std::process::ExitCode {
    subrope::cli::main()
}
