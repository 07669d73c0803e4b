//! Broken files of every kind: nothing panics, hangs or takes much memory, and every error helps.
//!
//! Each reader is tried in a process of its own, whose address space is limited. It writes every file
//! before it reads it; the file that it ended with is kept and named.

mod mutate;
mod readers;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use mutate::Corpus;
use readers::{BAD, READERS, Reader};

/// Address space of a process that reads files of some kilobytes, in KiB. The program itself, its
/// threads and the samples take a part of it.
const MOST_KIB: u64 = 1 << 20;
/// A file that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(20);
/// In a long run, this many times the files of a short one.
const LONG: usize = 60;

/// Names the reader that a process is to try, the number of files, and the folder for them.
const TASK: [&str; 3] = ["RAYFOREST_BROKEN", "RAYFOREST_BROKEN_CASES", "RAYFOREST_BROKEN_FOLDER"];

/// A promise that was not kept.
struct Broken {
    /// Which one, by which reader, with which file.
    text: String,
    /// What the process left.
    folder: PathBuf,
}

/// Tries a reader in a process of its own.
fn tried(reader: &Reader, cases: usize, patience: Duration) -> Result<(), Broken> {
    let folder = tempfile::tempdir().unwrap();
    let own = std::env::current_exe().unwrap();
    let own = own.to_str().unwrap();
    let log = std::fs::File::create(folder.path().join("log")).unwrap();
    let mut child = Command::new("sh")
        .args(["-c", "ulimit -v \"$1\" && shift && exec \"$@\"", "sh"])
        .args([&MOST_KIB.to_string(), own])
        .args(["--exact", "broken::a_process_that_reads_broken_files", "--ignored", "--nocapture"])
        .env(TASK[0], reader.name)
        .env(TASK[1], cases.to_string())
        .env(TASK[2], folder.path())
        // Each thread would reserve a heap.
        .env("MALLOC_ARENA_MAX", "1")
        .stdout(log.try_clone().unwrap())
        .stderr(log)
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    let counter = folder.path().join("case");
    let number = || std::fs::read_to_string(&counter).unwrap_or_default();
    let (mut last, mut since) = (number(), Instant::now());
    let ended = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.success();
        }
        std::thread::sleep(Duration::from_millis(10));
        let now = number();
        if now != last {
            (last, since) = (now, Instant::now());
        } else if since.elapsed() > patience {
            child.kill().unwrap();
            child.wait().unwrap();
            break false;
        }
    };
    if ended {
        return Ok(());
    }
    let log = std::fs::read_to_string(folder.path().join("log")).unwrap_or_default();
    let folder = folder.keep();
    let head: Vec<&str> = log.lines().filter(|line| !line.is_empty()).take(12).collect();
    let (name, file) = (reader.name, folder.join("files").join(reader.file));
    let text = format!("{name}, case {}, see {}:\n{}", number(), file.display(), head.join("\n"));
    Err(Broken { text, folder })
}

#[test]
#[ignore = "a process that the other tests of this file start"]
fn a_process_that_reads_broken_files() {
    let [Ok(name), Ok(cases), Ok(folder)] = TASK.map(std::env::var) else { return };
    let mut all = READERS.iter().chain(BAD);
    let reader = all.find(|reader| reader.name == name).expect("a reader of this name");
    read_all(reader, cases.parse().unwrap(), Path::new(&folder));
}

/// Reads broken files one after the other. Some are read, and some refused, or they prove nothing.
fn read_all(reader: &Reader, cases: usize, folder: &Path) {
    let files = folder.join("files");
    std::fs::create_dir(&files).unwrap();
    for (name, bytes) in reader.beside {
        std::fs::write(files.join(name), bytes).unwrap();
    }
    let (broken, opened): (PathBuf, PathBuf) = (files.join(reader.file), files.join(reader.opened));
    let samples = (reader.samples)();
    for sample in &samples {
        std::fs::write(&broken, sample).unwrap();
        assert!((reader.read)(&opened), "{}: a whole file is refused", reader.name);
    }
    let corpus = Corpus::new(samples);
    let mut read = 0;
    for number in 0..cases {
        let mut bytes = corpus.broken(number);
        (reader.seal)(&mut bytes);
        std::fs::write(&broken, bytes).unwrap();
        std::fs::write(folder.join("case"), number.to_string()).unwrap();
        read += usize::from((reader.read)(&opened));
    }
    println!("{}: {read} of {cases} broken files are read", reader.name);
    assert!(
        (read > 0 || !reader.reads_some) && read < cases,
        "{}: {read} of {cases} are read",
        reader.name
    );
}

/// Tries every other reader, from `first` on.
fn hold(first: usize) {
    let times = if std::env::var_os("RAYFOREST_LONG").is_some() { LONG } else { 1 };
    let mine = READERS.iter().skip(first).step_by(2);
    let broken = mine.filter_map(|reader| tried(reader, times * reader.cases, PATIENCE).err());
    let broken: Vec<String> = broken.map(|broken| broken.text).collect();
    assert!(broken.is_empty(), "{}", broken.join("\n\n"));
}

#[test]
fn broken_files_of_every_kind_are_read_or_refused() {
    hold(0);
}

#[test]
fn broken_files_of_every_other_kind_are_read_or_refused() {
    hold(1);
}

#[test]
fn a_reader_that_breaks_a_promise_is_found() {
    for (reader, words) in BAD.iter().zip([
        "on purpose",
        "no file is named",
        "hangs, case",
        "memory allocation of 2000",
        "30 of 30 are read",
    ]) {
        let Err(Broken { text, folder }) = tried(reader, reader.cases, Duration::from_secs(3))
        else {
            panic!("{words}: nothing was found");
        };
        assert!(text.contains(words), "{words}: {text}");
        std::fs::remove_dir_all(folder).unwrap();
    }
}
