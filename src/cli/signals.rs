//! What a signal does.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::Exit;

/// A flag that the first SIGINT or SIGTERM sets; a SIGINT after that ends the program at once.
///
/// SIGTERM may come several times: a cluster's scheduler sends it to a job's script, which hands it on, and to all of the job's
/// processes.
pub fn stop_on_signals() -> Result<Arc<AtomicBool>, Exit> {
    let stop = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register_conditional_shutdown(signal_hook::consts::SIGINT, 1, Arc::clone(&stop))
        .map_err(Exit::failed)?;
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).map_err(Exit::failed)?;
    }
    Ok(stop)
}
