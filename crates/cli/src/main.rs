//! The `tangency` command; everything is in the library beside it.

use std::process::ExitCode;

fn main() -> ExitCode {
    tangency_cli::main()
}
