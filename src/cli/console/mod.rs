//! What commands share with the terminal and the operating system; it depends on no command.
//!
//! `print` writes output and says how a command ended. `interrupt` hears signals, and `loading` reads under them and a time
//! limit. `outputs` checks what is to be written. `watchdog` holds the limit of memory, `processor_time` measures a thread.

pub(crate) mod interrupt;
pub(crate) mod loading;
pub(crate) mod outputs;
pub(crate) mod print;
pub(crate) mod processor_time;
pub(crate) mod watchdog;
