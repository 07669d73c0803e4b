//! The pictures of the presets in `assets` are what the program renders of them.
//!
//! A change that is meant: `RAYFOREST_UPDATE_GOLDENS=1 cargo test presets`, then look at the sheet.

use std::path::{Path, PathBuf};

use rayforest::document::presets::{COLUMNS, SHEET, SIDE, all, pictures, stage};

use super::language::{is_update, render};

fn sheet() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/materials.png")
}

/// Where the picture with this index begins, in pixels.
fn corner(index: usize) -> [usize; 2] {
    let [column, row] = [index % COLUMNS as usize, index / COLUMNS as usize];
    [column, row].map(|n| n * SIDE as usize)
}

/// Writes the pictures of all presets into one file.
fn write(shown: &[Vec<u8>]) {
    let side = SIDE as usize;
    let [width, rows] = [COLUMNS as usize * side, shown.len().div_ceil(COLUMNS as usize)];
    let mut bytes = vec![0; width * rows * side * 3];
    for (i, picture) in shown.iter().enumerate() {
        let [left, top] = corner(i);
        for (y, row) in picture.chunks(side * 3).enumerate() {
            let at = ((top + y) * width + left) * 3;
            bytes[at..at + row.len()].copy_from_slice(row);
        }
    }
    let file = std::io::BufWriter::new(std::fs::File::create(sheet()).unwrap());
    let mut encoder = png::Encoder::new(file, width as u32, (rows * side) as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
}

#[test]
fn every_preset_renders_to_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let presets = all();
    let shown: Vec<Vec<u8>> = presets.iter().map(|p| render(stage(p), &file)).collect();
    if is_update() {
        return write(&shown);
    }
    let committed = pictures();
    let expected = (presets.len().div_ceil(COLUMNS as usize)) as u32 * SIDE;
    assert_eq!(committed.size, [COLUMNS * SIDE, expected]);
    for (i, (preset, picture)) in presets.iter().zip(&shown).enumerate() {
        let [left, top] = corner(i);
        for (n, pixel) in picture.chunks(3).enumerate() {
            let at = [left + n % SIDE as usize, top + n / SIDE as usize].map(|n| n as u32);
            let kept = &committed.pixel(at)[..3];
            assert_eq!(pixel, kept, "{} at {at:?}: see the first lines of this file", preset.name);
        }
        let others = shown.iter().enumerate().filter(|(other, _)| *other != i);
        let same = others.filter(|(_, other)| *other == picture).count();
        assert_eq!(same, 0, "{} looks like another", preset.name);
    }
    assert!(SHEET.len() < 400_000, "{} bytes", SHEET.len());
}
