//! The `rayforest` program: parses the command line, enters a mode, prints what went wrong.

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let arguments = rayforest::cli::Arguments::parse();
    match rayforest::cli::run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            rayforest::cli::report(&failure);
            ExitCode::from(failure.code)
        }
    }
}
