//! The log file: what the program and its libraries say while a window is open, and how it ended.

use std::fs::File;
use std::io::Write;
use std::panic::PanicHookInfo;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use log::{Level, LevelFilter, Log, Metadata, Record};

use crate::clock::utc;

/// At this length the file becomes `NAME.1`, in place of the one before it, and a new one begins.
const MOST_BYTES: u64 = 1 << 20;
/// Longest line: libraries may print whole shaders.
const MOST_LINE: usize = 4000;

/// The log file in a folder.
pub(super) fn file_in(folder: &Path) -> PathBuf {
    folder.join("rayforest.log")
}

/// Where the file goes when it is long.
fn older(file: &Path) -> PathBuf {
    file.with_extension("log.1")
}

/// Writes the log from now on, also of panics. Only the first call of a process does anything. A file
/// that cannot be written is done without: nobody's work depends on it.
pub(super) fn start(folder: &Path) {
    let journal = Arc::new(Journal::new(folder));
    if log::set_boxed_logger(Box::new(Shared(journal.clone()))).is_err() {
        return;
    }
    log::set_max_level(LevelFilter::Info);
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        journal.line("PANIC", &told(panic));
        before(panic);
    }));
}

/// A panic with its thread and place.
fn told(panic: &PanicHookInfo<'_>) -> String {
    let thread = std::thread::current();
    let thread = thread.name().unwrap_or("without a name");
    let place = panic.location().map_or("an unknown place".to_owned(), ToString::to_string);
    let cause = panic.payload_as_str().unwrap_or("an unknown cause");
    format!("thread {thread} at {place}: {cause}")
}

/// The last lines of a log file, oldest first.
pub(super) fn last_lines(file: &Path, count: usize) -> Vec<String> {
    let mut text = std::fs::read(older(file)).unwrap_or_default();
    text.extend(std::fs::read(file).unwrap_or_default());
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(count)..].iter().map(|line| (*line).to_owned()).collect()
}

/// A log file of limited length. Any thread writes to it.
struct Journal {
    path: PathBuf,
    out: Mutex<Option<Out>>,
}

struct Out {
    file: File,
    length: u64,
}

impl Out {
    fn open(path: &Path) -> Option<Out> {
        std::fs::create_dir_all(path.parent()?).ok()?;
        let file = File::options().create(true).append(true).open(path).ok()?;
        let length = file.metadata().ok()?.len();
        Some(Out { file, length })
    }
}

impl Journal {
    fn new(folder: &Path) -> Journal {
        let path = file_in(folder);
        let out = Mutex::new(Out::open(&path));
        Journal { path, out }
    }

    /// Writes a line; breaks in the text begin lines that are set in.
    fn line(&self, level: &str, text: &str) {
        let text: String = text.chars().take(MOST_LINE).collect();
        let text = text.trim_end().replace('\n', "\n    ");
        let line = format!("{} {level:5} {text}\n", utc(SystemTime::now()));
        // Whoever panicked while writing left at most half a line.
        let mut out = self.out.lock().unwrap_or_else(PoisonError::into_inner);
        if out.as_ref().is_some_and(|out| out.length + line.len() as u64 > MOST_BYTES) {
            *out = None;
            // What cannot be moved is cut, so that the limit holds.
            if std::fs::rename(&self.path, older(&self.path)).is_err() {
                let _ = std::fs::remove_file(&self.path);
            }
            *out = Out::open(&self.path);
        }
        if let Some(out) = &mut *out
            && out.file.write_all(line.as_bytes()).is_ok()
        {
            out.length += line.len() as u64;
        }
    }
}

/// The journal as the libraries know it.
struct Shared(Arc<Journal>);

impl Log for Shared {
    /// The program's own words, and warnings of its libraries.
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        let own = metadata.target().starts_with("rayforest");
        metadata.level() <= if own { Level::Info } else { Level::Warn }
    }

    fn log(&self, record: &Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let own = record.target().starts_with("rayforest");
        let text = match own {
            true => record.args().to_string(),
            false => format!("{}: {}", record.target(), record.args()),
        };
        self.0.line(record.level().as_str(), &text);
    }

    /// Lines are written at once.
    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_limited_and_the_last_lines_are_found_in_both() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("new");
        let journal = Journal::new(&inner);
        let file = file_in(&inner);
        let long = "x".repeat(MOST_LINE);
        for number in 0..600 {
            journal.line("INFO", &format!("{number} {long}"));
        }
        journal.line("WARN", "first\nsecond\n");
        let lengths = [&file, &older(&file)].map(|f| std::fs::metadata(f).unwrap().len());
        assert!(lengths.iter().all(|length| *length <= MOST_BYTES), "{lengths:?}");
        assert!(lengths.iter().sum::<u64>() > MOST_BYTES, "one of them was full: {lengths:?}");
        let lines = last_lines(&file, 300);
        assert_eq!(lines.len(), 300);
        assert!(lines[298].ends_with(" WARN  first") && lines[299] == "    second");
        assert!(lines[297].contains(" INFO  599 xxx"), "{}", &lines[297][..60]);
        assert!(lines[0].contains(" UTC INFO  302 xxx"), "{}", &lines[0][..60]);
        // The next run goes on in the same file.
        drop(journal);
        Journal::new(&inner).line("INFO", "again");
        assert!(
            last_lines(&file, 2)[0] == "    second"
                && std::fs::read_dir(inner).unwrap().count() == 2
        );
    }

    #[test]
    fn libraries_are_heard_when_they_warn() {
        let folder = tempfile::tempdir().unwrap();
        let journal = Shared(Arc::new(Journal::new(folder.path())));
        for (target, level) in [
            ("rayforest::viewer", Level::Info),
            ("rayforest", Level::Debug),
            ("wgpu_core", Level::Info),
            ("wgpu_core", Level::Warn),
        ] {
            let mut record = Record::builder();
            journal.log(&record.target(target).level(level).args(format_args!("hello")).build());
        }
        let lines = last_lines(&file_in(folder.path()), 9);
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(
            lines[0].ends_with(" INFO  hello") && lines[1].ends_with(" WARN  wgpu_core: hello")
        );
    }

    /// Names the folder of the log in the process that panics.
    const FOLDER: &str = "RAYFOREST_TEST_LOG";

    #[test]
    #[ignore = "panics: another test runs it in a process of its own"]
    fn a_process_that_panics() {
        let folder = std::env::var_os(FOLDER).expect("a folder");
        start(Path::new(&folder));
        start(Path::new("/nowhere"));
        log::info!("it begins");
        panic!("on purpose");
    }

    #[test]
    fn a_panic_is_written_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let mut process = std::process::Command::new(std::env::current_exe().unwrap());
        process.args(["--ignored", "--exact", "viewer::journal::tests::a_process_that_panics"]);
        let output = process.env(FOLDER, folder.path()).output().unwrap();
        assert!(!output.status.success());
        let told = String::from_utf8_lossy(&output.stderr).into_owned()
            + &String::from_utf8_lossy(&output.stdout);
        assert!(told.contains("on purpose"), "it is still told where it was told before: {told}");
        let lines = last_lines(&file_in(folder.path()), 9);
        assert!(lines[0].ends_with(" INFO  it begins"), "{lines:?}");
        let panic = &lines[1];
        assert!(panic.contains("PANIC thread viewer::journal::tests::a_process"), "{panic}");
        assert!(panic.contains("journal.rs:") && panic.ends_with(": on purpose"), "{panic}");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_done_without() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        Journal::new(&file).line("INFO", "lost");
        assert!(last_lines(&file_in(&file), 9).is_empty());
    }
}
