//! SIGINT and SIGTERM: the first asks a search to stop, the second ends the process.

use crate::systems::events::CancelToken;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

/// Exit code of what was interrupted: 128 + SIGINT, as shells have it.
pub(crate) const EXIT_CODE: u8 = 130;

/// From now on the first SIGINT or SIGTERM cancels the token, which is the same for all who ask; a second one ends the process at
/// once. Commands that check no token do without, so that the first one ends them.
pub(crate) fn token() -> CancelToken {
    static TOKEN: OnceLock<CancelToken> = OnceLock::new();
    TOKEN.get_or_init(registered).clone()
}

fn registered() -> CancelToken {
    let flag = Arc::new(AtomicBool::new(false));
    let registered = [SIGINT, SIGTERM].into_iter().try_for_each(|signal| {
        // In this order: the flag is read before the same signal raises it.
        signal_hook::flag::register_conditional_shutdown(signal, i32::from(EXIT_CODE), Arc::clone(&flag))?;
        signal_hook::flag::register(signal, Arc::clone(&flag)).map(drop)
    });
    // Where the system takes no handler a signal ends the process as it always would.
    let _as_always: io::Result<()> = registered;
    CancelToken::of_flag(flag)
}

/// A limit of file sizes that is reached is then an error of the write, not the end of the process.
pub(crate) fn survive_size_limits() {
    #[cfg(unix)]
    let _as_always = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)));
}
