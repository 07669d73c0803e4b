//! Processor time, which other programs on the machine stretch less than they stretch wall time.

/// Processor time that this thread has taken so far, in seconds; wall time where the platform does
/// not tell. Differences mean something, to about a microsecond.
pub fn thread_seconds() -> f64 {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
    }
    #[cfg(not(unix))]
    {
        std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |t| t.as_secs_f64())
    }
}
