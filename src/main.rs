//! The command line of voidwalk; see the library for what it does.

fn main() -> std::process::ExitCode {
    voidwalk::cli::main()
}
