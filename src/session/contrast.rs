//! The colours of single samples, where those decide how many samples pixels get.

use crate::color::Rgb;
use crate::film::layout::LANES;
use crate::fold::{Folder, Names};
use crate::forest::signature::Signature;
use crate::forest::tree::TileTrees;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::scene::factor::FactorValues;
use crate::scene::model::Peak;
use crate::scene::refine::Refine;
use crate::shade::terms::{TermProgram, TermValues};

/// What the colours of samples are found with.
pub(super) struct Palette {
    names: Names,
    peaks: Vec<Option<Peak>>,
    factors: FactorValues,
    /// Of a sample of a pixel that has all.
    weight: f32,
}

impl Palette {
    /// That of a scene; `None` if it does not compare colours.
    pub(super) fn of(scene: &Scene, geometry: &Geometry) -> Option<Palette> {
        (scene.trace.refine == Refine::Contrast).then(|| Palette {
            names: Names::new(geometry.materials(), scene.lights.len()),
            peaks: scene.materials.iter().map(|m| Some(Peak::of(m))).collect(),
            factors: FactorValues::new(scene),
            weight: 1.0 / scene.trace.samples as f32,
        })
    }

    /// Folds a block so that every sample has a lane of its own, sixteen samples after another.
    pub(super) fn fold(&self, folder: &mut Folder, grown: &TileTrees, counts: &[u32; LANES]) {
        let mut reader = grown.read(0);
        let mut rest = counts.iter().sum::<u32>() as usize;
        while rest > 0 {
            let here = rest.min(LANES);
            rest -= here;
            let lanes = std::array::from_fn(|lane| u32::from(lane < here));
            folder.block(&mut reader, &lanes, &self.names);
        }
    }

    /// The signatures of blocks with these numbers of samples, which were folded one after another.
    pub(super) fn signatures(
        &self,
        folder: &mut Folder,
        blocks: &[(usize, [u32; LANES])],
    ) -> Vec<[Signature; LANES]> {
        let colors = self.colors(folder);
        let mut colors = colors.chunks(LANES);
        let mut signatures = Vec::with_capacity(blocks.len());
        for (_, counts) in blocks {
            // The samples of a block stand one after another, those of the next begin anew.
            let samples = counts.iter().sum::<u32>() as usize;
            let own: Vec<Rgb> =
                colors.by_ref().take(samples.div_ceil(LANES)).flatten().copied().collect();
            let mut rest = &own[..];
            signatures.push(counts.map(|count| {
                let (own, after) = rest.split_at(count as usize);
                rest = after;
                // A sample of a pixel that has few weighs more.
                let alone: Vec<Rgb> = own.iter().map(|&color| color * count as f32).collect();
                Signature::of_colors(&alone)
            }));
        }
        signatures
    }

    /// What every lane of the folded blocks shows.
    fn colors(&self, folder: &mut Folder) -> Vec<Rgb> {
        let folded = folder.finish_tile(self.weight, &self.peaks);
        let mut terms = TermValues::default();
        terms.evaluate(&TermProgram::new(folded.trie), &self.factors);
        let value = |entry: usize| {
            let [r, g, b, _] = terms.values[folded.tile.terms[entry] as usize];
            Rgb([r, g, b])
        };
        let blocks = folded.tile.starts.len() - 1;
        let mut colors = vec![Rgb::BLACK; blocks * LANES];
        for (block, colors) in colors.chunks_exact_mut(LANES).enumerate() {
            let rows = folded.tile.block(block);
            for (&entry, plane) in rows.entries.iter().zip(rows.planes) {
                let value = value(entry as usize);
                colors.iter_mut().zip(plane.0).for_each(|(color, c)| *color = *color + value * c);
            }
            for single in rows.singles {
                let color = &mut colors[single.lane()];
                *color = *color + value(single.entry()) * single.coefficient;
            }
        }
        colors
    }
}
