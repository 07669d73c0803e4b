//! Whole files made broken ones, the same ones every time.

use crate::exact::random::Random;

/// Numbers that readers trip over.
const EXTREMES: [&str; 24] = [
    "0",
    "-0",
    "-1",
    "1",
    "3",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "-9223372036854775808",
    "18446744073709551615",
    "1e308",
    "-1e308",
    "1e-320",
    "1e400",
    "nan",
    "-inf",
    "inf",
    "0x7f",
    "1_000",
];

/// Numbers in binary files.
const WORDS: [u32; 9] = [0, 1, 2, 0x7f, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_fff0, u32::MAX];

/// What nests, and deep enough for a stack.
const NESTING: [&str; 5] = ["[", "{", "[[", "{\"a\":[", "a.a."];
const DEEP: [usize; 3] = [3, 200, 60_000];

/// No broken file is longer than this many times the longest whole one.
const LONGEST: usize = 8;

/// Whole files of one kind, and the words in them.
pub(super) struct Corpus {
    samples: Vec<Vec<u8>>,
    words: Vec<Vec<u8>>,
}

impl Corpus {
    pub(super) fn new(samples: Vec<Vec<u8>>) -> Corpus {
        assert!(samples.iter().all(|sample| !sample.is_empty()));
        let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"_-.".contains(byte);
        let all = samples.iter().flat_map(|sample| sample.split(|byte| !is_word(byte)));
        let mut words: Vec<Vec<u8>> =
            all.filter(|word| (1..30).contains(&word.len())).map(<[u8]>::to_vec).collect();
        words.sort_unstable();
        words.dedup();
        words.extend(EXTREMES.map(|word| word.as_bytes().to_vec()));
        Corpus { samples, words }
    }

    /// A broken file; every number is another one.
    pub(super) fn broken(&self, number: usize) -> Vec<u8> {
        let mut random = Random(number as u64 ^ 0x5eed_0000);
        let mut bytes = self.samples[random.below(self.samples.len())].clone();
        let most = LONGEST * self.samples.iter().map(Vec::len).max().unwrap_or(0) + 1000;
        for _ in 0..1 + random.below(4) {
            self.alter(&mut bytes, &mut random);
            bytes.truncate(most.max(200_000));
        }
        bytes
    }

    fn alter(&self, bytes: &mut Vec<u8>, random: &mut Random) {
        let at = random.below(bytes.len() + 1);
        match random.below(13) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.bits() as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(block(bytes, at, random))),
            4 => {
                let again = bytes[block(bytes, at, random)].to_vec();
                for _ in 0..1 + random.below(3) {
                    insert(bytes, at, &again);
                }
            }
            5 => {
                // A block from elsewhere, of this file or another one.
                let other = &self.samples[random.below(self.samples.len())];
                let from = random.below(other.len());
                let piece = other[block(other, from, random)].to_vec();
                insert(bytes, at, &piece);
            }
            6 | 7 => {
                let number = EXTREMES[random.below(EXTREMES.len())];
                let is_part = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
                replace_word(bytes, at, is_part, number.as_bytes());
            }
            8 | 9 => {
                let word = &self.words[random.below(self.words.len())];
                let is_part = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
                replace_word(bytes, at, is_part, word);
            }
            10 => {
                let word = self.words[random.below(self.words.len())].clone();
                insert(bytes, at, &word);
            }
            11 => {
                let open = NESTING[random.below(NESTING.len())];
                let deep = DEEP[random.below(DEEP.len())];
                insert(bytes, at, open.repeat(deep).as_bytes());
            }
            _ => {
                let word = WORDS[random.below(WORDS.len())];
                let ends = [word.to_le_bytes(), word.to_be_bytes()];
                // Where binary files have their numbers, and anywhere.
                let at = if random.below(2) == 0 { at & !3 } else { at };
                let new = ends[random.below(2)];
                bytes.iter_mut().skip(at).zip(new).for_each(|(byte, new)| *byte = new);
            }
        }
    }
}

/// A range of bytes that begins somewhere: some bytes, a line, or several lines.
fn block(bytes: &[u8], at: usize, random: &mut Random) -> std::ops::Range<usize> {
    if random.below(2) == 0 {
        return at..(at + 1 + random.below(64)).min(bytes.len()).max(at);
    }
    let from = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |line| line + 1);
    let mut to = at;
    for _ in 0..1 + random.below(3) {
        let rest = &bytes[to..];
        to += rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
    }
    from..to
}

fn insert(bytes: &mut Vec<u8>, at: usize, piece: &[u8]) {
    bytes.splice(at..at, piece.iter().copied());
}

/// Replaces the first run of such bytes from `at` on.
fn replace_word(bytes: &mut Vec<u8>, at: usize, is_part: impl Fn(&u8) -> bool, new: &[u8]) {
    let Some(from) = bytes[at..].iter().position(&is_part).map(|from| at + from) else { return };
    let length = bytes[from..].iter().take_while(|byte| is_part(byte)).count();
    bytes.splice(from..from + length, new.iter().copied());
}

#[test]
fn broken_files_are_many_and_the_same_every_time() {
    let corpus = Corpus::new(vec![b"one = 1\ntwo = [2, 2.5]\n".to_vec(), b"three".to_vec()]);
    let all: std::collections::HashSet<Vec<u8>> = (0..2000).map(|n| corpus.broken(n)).collect();
    assert!(all.len() > 1500, "{}", all.len());
    assert!(all.iter().all(|bytes| bytes.len() <= 200_000));
    assert_eq!(corpus.broken(7), Corpus::new(corpus.samples.clone()).broken(7));
}
