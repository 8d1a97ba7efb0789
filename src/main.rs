//! The command-line program: `foliate help` lists its commands.
#![forbid(unsafe_code)]

/// A search asks for many small pieces of memory. Hosts bring an allocator of their own.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    foliate::cli::run_program(std::env::args_os()).into()
}
