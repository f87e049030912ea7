//! The one place that knows whether there are threads.

/// Runs both, on two threads when the feature `parallel` is on.
#[cfg(feature = "parallel")]
pub fn join(a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    rayon::join(a, b);
}

/// Runs both, one after the other.
#[cfg(not(feature = "parallel"))]
pub fn join(a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    a();
    b();
}

/// Runs `work` in a pool of `threads` threads. A pool of one too: outside a pool, joins would go to the global one.
///
/// # Errors
/// [`crate::FemError::Threads`] when the pool cannot be made.
#[cfg(feature = "parallel")]
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, crate::FemError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.max(1))
        .build()
        .map_err(|_| crate::FemError::Threads { threads })?;
    Ok(pool.install(work))
}

/// Runs `work` on the calling thread: the feature `parallel` is off.
///
/// # Errors
/// None.
#[cfg(not(feature = "parallel"))]
pub fn with_threads<T: Send>(_threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, crate::FemError> {
    Ok(work())
}
