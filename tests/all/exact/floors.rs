//! The floors: a file names only modules that stand above it in the list of `lib.rs`.

use std::path::{Path, PathBuf};

const MOST_LINES: usize = 600;

/// Words that only some files may use, by the start of the file's path below `src`.
const ENTRANCES: [(&str, &[&str]); 5] = [
    ("wgpu", &["shade/gpu.rs", "shade/gpu/", "viewer"]),
    ("egui", &["viewer"]),
    ("eframe", &["viewer"]),
    ("rfd", &["viewer"]),
    ("image::", &["film", "scene/texture"]),
];

/// The modules of `lib.rs`, ground first.
fn modules(lib: &str) -> Vec<String> {
    let name = |line: &str| {
        let rest = line.strip_prefix("pub ").unwrap_or(line).strip_prefix("mod ")?;
        rest.strip_suffix(';').map(str::to_owned)
    };
    lib.lines().filter_map(name).collect()
}

/// What is wrong with a file of `src`, named by its path there.
fn faults(modules: &[String], file: &str, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let mut fault = |what: String| faults.push(format!("{file}: {what}"));
    if !text.starts_with("//! ") {
        fault("does not begin with `//! `".into());
    }
    let lines = text.lines().count();
    if lines > MOST_LINES {
        fault(format!("has {lines} lines"));
    }
    let code: String = text.lines().map(|l| format!("{}\n", without_comment(l))).collect();
    if has_word(&code, "unsafe") {
        fault("uses `unsafe`".into());
    }
    for (word, homes) in ENTRANCES {
        if has_word(&code, word) && !homes.iter().any(|home| file.starts_with(home)) {
            fault(format!("uses `{word}`"));
        }
    }
    let own = own_module(file);
    let Some(floor) = modules.iter().position(|m| *m == own) else {
        if !["lib.rs", "main.rs"].contains(&file) {
            fault(format!("its module `{own}` is not in lib.rs"));
        }
        return faults;
    };
    for named in named_modules(&code, depth(file)) {
        match modules.iter().position(|m| *m == named) {
            Some(at) if at > floor => fault(format!("names `{named}`, which stands above it")),
            _ if own == "shade" && named == "geometry" => fault("names `geometry`".into()),
            _ => {}
        }
    }
    faults
}

/// The line up to its comment; quotes that hold `//` are cut too, which hides nothing but text.
fn without_comment(line: &str) -> &str {
    line.split("//").next().unwrap_or_default()
}

fn own_module(file: &str) -> &str {
    file.split('/').next().unwrap_or_default().trim_end_matches(".rs")
}

/// How many modules deep a file is: `color.rs` and `fold/mod.rs` 1, `fold/trie.rs` 2.
fn depth(file: &str) -> usize {
    file.split('/').count() - usize::from(file.ends_with("/mod.rs"))
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether a word stands alone in the text, and not inside of a path.
fn has_word(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| {
        let (before, after) = (&code[..at], &code[at + word.len()..]);
        let ends = word.ends_with("::") || !after.starts_with(is_word);
        ends && !before.ends_with(is_word) && !before.ends_with("::")
    })
}

/// What follows `crate::`, or as many `super::` as lead out of the file's module, in braces too.
fn named_modules(code: &str, depth: usize) -> Vec<String> {
    let mut named = Vec::new();
    let mut nested = 0;
    for (at, line) in line_starts(code) {
        if line.starts_with("mod ") && line.trim_end().ends_with('{') {
            nested = 1;
        } else if line.starts_with('}') {
            nested = 0;
        }
        let root = "super::".repeat(depth + nested);
        for start in ["crate::", root.as_str()] {
            for (offset, _) in line.match_indices(start) {
                let before = &line[..offset];
                if !before.ends_with(is_word) && !before.ends_with("::") {
                    named.extend(first_names(&code[at + offset + start.len()..]));
                }
            }
        }
    }
    named
}

fn line_starts(code: &str) -> impl Iterator<Item = (usize, &str)> {
    code.split_inclusive('\n').scan(0, |at, line| {
        let start = *at;
        *at += line.len();
        Some((start, line))
    })
}

/// The first names of a path, several if it begins with a brace: `{a::b, c::{d, e}}` gives a, c.
fn first_names(path: &str) -> Vec<String> {
    let word = |text: &str| text.chars().take_while(|c| is_word(*c)).collect::<String>();
    let Some(inside) = path.strip_prefix('{') else { return vec![word(path)] };
    let mut names = Vec::new();
    let (mut open, mut part) = (0, String::new());
    for c in inside.chars() {
        match c {
            '{' => open += 1,
            '}' if open == 0 => break,
            '}' => open -= 1,
            ',' if open == 0 => names.push(word(std::mem::take(&mut part).trim())),
            _ => part.push(c),
        }
    }
    names.push(word(part.trim()));
    names.retain(|name| !name.is_empty());
    names
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn every_file_stands_on_its_floor() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let modules = modules(&std::fs::read_to_string(src.join("lib.rs")).unwrap());
    assert!(modules.len() >= 11, "{modules:?}");
    let mut files = Vec::new();
    files_below(&src, &mut files);
    let mut found = Vec::new();
    for path in &files {
        let text = std::fs::read_to_string(path).unwrap();
        let file = path.strip_prefix(&src).unwrap().to_string_lossy().replace('\\', "/");
        found.extend(faults(&modules, &file, &text));
    }
    assert!(files.len() > 50, "{} files", files.len());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

fn of(file: &str, code: &str) -> Vec<String> {
    let list = "//! x\npub mod math;\n// what\npub mod geometry;\npub mod shade;\nmod session;\n";
    faults(&modules(list), file, &format!("//! A file.\n\n{code}"))
}

#[test]
fn names_of_floors_above_are_found() {
    for (file, code) in [
        ("math.rs", "use crate::geometry::Ray;\n"),
        ("geometry/mod.rs", "use crate::{\n    math,\n    session::{Session, trace},\n};\n"),
        ("geometry/mod.rs", "use super::session;\n"),
        ("geometry/ray.rs", "fn f() { super::super::session::run() }\n"),
        ("geometry/ray.rs", "mod tests {\n    use super::super::super::shade;\n}\n"),
        ("math.rs", "pub(crate) use crate::shade::cpu;\n"),
        ("math.rs", "type A = Vec<crate::session::Session>;\n"),
    ] {
        let found = of(file, code);
        assert_eq!(found.len(), 1, "{file}: {code}: {found:?}");
        assert!(found[0].ends_with("which stands above it"), "{found:?}");
    }
    assert_eq!(
        of("shade/cpu.rs", "use crate::geometry::Ray;\n"),
        ["shade/cpu.rs: names `geometry`"]
    );
    assert_eq!(of("other.rs", ""), ["other.rs: its module `other` is not in lib.rs"]);
}

#[test]
fn other_faults_of_a_file_are_found() {
    assert_eq!(of("math.rs", "fn f() { unsafe { g() } }\n"), ["math.rs: uses `unsafe`"]);
    assert_eq!(of("session/gpu.rs", "use wgpu::Device;\n"), ["session/gpu.rs: uses `wgpu`"]);
    assert_eq!(of("shade/mod.rs", "use egui;\n"), ["shade/mod.rs: uses `egui`"]);
    assert_eq!(of("shade/mod.rs", "image::open(p);\n"), ["shade/mod.rs: uses `image::`"]);
    assert_eq!(of("math.rs", &"\n".repeat(600)), ["math.rs: has 602 lines"]);
    let list = modules("mod math;\n");
    assert_eq!(faults(&list, "math.rs", "//!\n"), ["math.rs: does not begin with `//! `"]);
    assert_eq!(faults(&list, "math.rs", "use std;\n"), ["math.rs: does not begin with `//! `"]);
}

#[test]
fn what_is_allowed_is_not_found() {
    for (file, code) in [
        ("session.rs", "use crate::{math::f, geometry::{self, Ray}, shade};\n"),
        ("geometry/ray.rs", "use super::hit;\nuse super::super::math;\nuse crate::geometry::x;\n"),
        ("geometry/mod.rs", "// see crate::session, unsafe\n/// [`crate::shade`]\nstruct A;\n"),
        ("shade/gpu.rs", "use wgpu::Device;\n"),
        ("math.rs", "let unsafely = my_image::x; let (wgpus, prfd) = session;\n"),
        ("main.rs", "use rayforest::cli;\n"),
        ("geometry/ray.rs", "mod tests {\n    use super::super::hit;\n}\n"),
    ] {
        assert_eq!(of(file, code), [""; 0], "{file}: {code}");
    }
}
