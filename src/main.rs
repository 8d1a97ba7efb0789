//! The command-line program: `foliate help` lists its commands.
#![forbid(unsafe_code)]

mod cli;

/// A search asks for many small pieces of memory. Hosts bring an allocator of their own.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    cli::command_line::main()
}
