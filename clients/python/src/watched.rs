//! Work that Ctrl-C ends.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Does work on another thread, so that Ctrl-C is answered. The work should end soon after its
/// flag is set; nobody waits for it then. `report` is called ten times a second.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    mut report: impl FnMut() -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (send, receive) = channel();
    let receive = Mutex::new(receive);
    let flag = stop.clone();
    let thread = std::thread::Builder::new().name("palpate-work".into());
    let _detached = thread
        .spawn(move || drop(send.send(work(&flag))))
        .map_err(crate::errors::internal)?;
    loop {
        let waited = py.detach(|| {
            let receive = receive.lock().unwrap_or_else(PoisonError::into_inner);
            receive.recv_timeout(Duration::from_millis(20))
        });
        match waited {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(crate::errors::internal("the work panicked"));
            }
            Err(RecvTimeoutError::Timeout) => {
                if let Err(error) = py.check_signals().and_then(|()| report()) {
                    stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
    }
}
