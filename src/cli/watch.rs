//! Shows on the terminal how far a long job has come.

use std::io::{IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use crate::progress::Progress;

/// Runs `job`; while it lasts longer than a moment, and standard error is a terminal, a line there
/// tells how many of its steps are done.
pub(crate) fn watched<T>(what: &str, job: impl FnOnce(&Progress) -> T) -> T {
    let progress = Progress::default();
    if !std::io::stderr().is_terminal() {
        return job(&progress);
    }
    std::thread::scope(|scope| {
        let (done, wait) = channel::<()>();
        let (progress, shown) = (&progress, what.to_owned());
        scope.spawn(move || {
            let mut any = false;
            while wait.recv_timeout(Duration::from_millis(250)) == Err(RecvTimeoutError::Timeout) {
                let (steps, total) = progress.steps();
                draw(&format!("\r{shown}: {:.0} %  ", 100.0 * steps as f64 / total.max(1) as f64));
                any = true;
            }
            if any {
                draw("\r\x1b[K");
            }
        });
        let result = job(progress);
        drop(done);
        result
    })
}

fn draw(text: &str) {
    let mut terminal = std::io::stderr();
    // A terminal that went away needs no progress.
    let _ = terminal.write_all(text.as_bytes()).and_then(|()| terminal.flush());
}
