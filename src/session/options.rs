//! What a session may use of the machine.

/// What a session may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Threads, ≥ 1.
    pub threads: usize,
    /// Bytes that trees, matrix and highlight lists may take together. Not counted: the geometry,
    /// the list of terms, each thread's scratch (a few tiles), and, while a scene is traced again,
    /// the matrix before it, which is held so that a cancel costs nothing, and that of a preview;
    /// while pixels are grown again, what they replace, and, where sampling is adaptive, a quarter as
    /// much for the samples by which is decided.
    pub memory: u64,
}

impl Default for Options {
    /// All cores and half of the machine's memory, or of the container's.
    fn default() -> Options {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let machine = sysinfo::System::new().map_or(0, |mut system| {
            system.refresh_memory();
            let container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.total_memory);
            system.total_memory().min(container)
        });
        Options { threads, memory: (machine / 2).max(1 << 28) }
    }
}
