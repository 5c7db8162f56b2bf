//! Files that are nearly right, from seeds: what reads files must refuse them with a message, or
//! take them.

use std::ops::Range;

use crate::problems::Random;

/// What people and programs write where a number is expected, and what ends or begins a part.
const TOKENS: [&str; 28] = [
    "0",
    "-0",
    "1",
    "-1",
    "nan",
    "inf",
    "-inf",
    "1e999",
    "1e308",
    "-1e308",
    "1e50",
    "1e-50",
    "1e30",
    "1e-30",
    "1e-320",
    "1e-9",
    "1e9",
    "4294967296",
    "\"\"",
    "\"world\"",
    "[]",
    "{}",
    "[",
    "]",
    "{",
    "}",
    ",",
    "\u{feff}",
];

/// A copy of `text` with one or two changes, most of them to its numbers.
#[must_use]
pub fn mutated(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut text = text.to_vec();
    for _ in 0..=random.index(2) {
        mutate(&mut text, random);
    }
    text
}

fn mutate(text: &mut Vec<u8>, random: &mut Random) {
    if text.is_empty() {
        return;
    }
    let (at, token) = (random.index(text.len()), random.pick(&TOKENS).bytes());
    let length = 1 + random.index(40);
    let end = text.len().min(at + length);
    match random.index(16) {
        0 => text[at] = u8::try_from(random.index(256)).expect("a byte"),
        1 => text.truncate(at),
        2 => drop(text.drain(at..end)),
        3 => {
            let copy = text[at..end].to_vec();
            text.splice(at..at, copy);
        }
        4 => drop(text.splice(at..at, token)),
        5 => swap_lines(text, random),
        6..=9 => drop(text.splice(number_near(text, at), token)),
        _ => {
            let number = random.between(-2.0, 2.0).to_string();
            text.splice(number_near(text, at), number.bytes());
        }
    }
}

/// The first number behind `at` that is a value, or nothing there.
fn number_near(text: &[u8], at: usize) -> Range<usize> {
    let belongs = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+');
    let begins = |pair: &[u8]| matches!(pair[0], b' ' | b'[' | b'=' | b':') && belongs(&pair[1]);
    let Some(before) = text[at..].windows(2).position(begins) else { return at..at };
    let start = at + before + 1;
    let length = text[start..].iter().position(|byte| !belongs(byte));
    start..length.map_or(text.len(), |length| start + length)
}

fn swap_lines(text: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<&[u8]> = text.split(|byte| *byte == b'\n').collect();
    let (one, two) = (random.index(lines.len()), random.index(lines.len()));
    lines.swap(one, two);
    *text = lines.join(&b'\n');
}
