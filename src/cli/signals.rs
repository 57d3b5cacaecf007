//! What a signal does.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::Ending;

/// A flag that the first SIGINT or SIGTERM sets; the second ends the program at once.
pub fn stop_on_signals() -> Result<Arc<AtomicBool>, Ending> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 1, Arc::clone(&stop))
            .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&stop)))
            .map_err(Ending::failed)?;
    }
    Ok(stop)
}
