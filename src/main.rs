//! Command line of voidwalk, a call of the library.

fn main() -> std::process::ExitCode {
    voidwalk::cli::main()
}
