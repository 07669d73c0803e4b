//! The matrix product on a graphics card: the matrix is uploaded once, an edit is one small upload and one dispatch.
//!
//! Twin of `cpu.rs`: [`Product::film`] and [`Product::frame`] stand for the functions of these names
//! there, and `shade.wgsl` for what they call. The card may fuse multiplications with additions, so
//! that its light differs from the CPU's in the last bits; what is exported is the CPU's.
//!
//! The thread that shades calls [`Product::frame`], not the window's: it owns the matrix, so that the
//! window needs to know nothing of it, and neither an upload of a whole matrix nor a busy card holds the
//! window up. Uploads are copied to memory of the driver's and a dispatch is queued, without waiting for
//! either; only the dispatch before it must be done, because the window is drawn by the same queue.
//! Cards draw in the order in which they are told to, and a picture that somebody still holds is never
//! drawn into: what the window shows is whole.

mod device;
mod measure;
mod parts;
mod picture;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::{Acquire, Release};
use std::time::{Duration, Instant};

use crate::film::develop::Development;
use crate::film::layout::{LANES, TILE_BLOCKS};
use crate::film::{Film, FilmBlock};
use crate::fold::transport::Transport;
use device::{GROUP, caught};
pub use device::{Gpu, GpuError, Watch};
pub use measure::Timings;
use parts::{Kind, LIGHT, Look, Part, Record};
pub use parts::{Limits, Piece};
pub use picture::Picture;

/// A matrix on the card, and the pictures drawn of it.
pub struct Product {
    gpu: Gpu,
    limits: Limits,
    look: wgpu::Buffer,
    matrix: Option<Matrix>,
    /// All pictures that are shown, were, or may be again.
    pictures: Vec<Arc<Picture>>,
    /// Whether clipped pixels are marked in what is drawn.
    marks: bool,
    /// Whether the card is still at the picture that it was told to draw last.
    is_busy: Arc<AtomicBool>,
}

/// A card that has not drawn a picture after this time never will.
const PATIENCE: Duration = Duration::from_secs(10);
/// How often it is asked whether it has.
const GLANCE: Duration = Duration::from_micros(300);

struct Matrix {
    size: [u32; 2],
    pieces: Vec<Piece>,
    terms: usize,
    values: wgpu::Buffer,
    parts: Vec<MatrixPart>,
}

struct MatrixPart {
    plan: Part,
    arrays: Vec<wgpu::Buffer>,
    group: wgpu::BindGroup,
}

impl Product {
    /// A product without a matrix.
    pub fn new(gpu: Gpu) -> Product {
        let limits = gpu.limits();
        Product::within(gpu, limits)
    }

    /// The same with limits below the card's.
    pub fn within(gpu: Gpu, limits: Limits) -> Product {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let look = gpu.buffer("look", size_of::<Look>() as u64, usage);
        let is_busy = Arc::default();
        Product { gpu, limits, look, matrix: None, pictures: Vec::new(), marks: false, is_busy }
    }

    /// Whether pixels that a screen cannot show are marked from now on, as
    /// [`mark`](crate::film::clipping::mark) does it.
    pub fn mark_clipped(&mut self, on: bool) {
        self.marks = on;
    }

    /// How many bindings the matrix's planes are spread over.
    pub fn parts(&self) -> usize {
        self.matrix.as_ref().map_or(0, |matrix| matrix.parts.len())
    }

    /// Bytes on the card: the matrix and the pictures drawn of it. A card without room for more refuses,
    /// and [`GpuError::Failed`] says so; what the processor keeps is not of it.
    pub fn bytes(&self) -> u64 {
        let arrays = self.matrix.iter().flat_map(|matrix| &matrix.parts).flat_map(|p| &p.arrays);
        let pixels = |picture: &Arc<Picture>| picture.size.map(u64::from).iter().product::<u64>();
        let pictures = self.pictures.iter().map(|picture| 4 * pixels(picture));
        arrays.map(wgpu::Buffer::size).chain(pictures).sum()
    }

    /// The linear picture of all tiles, in the transport's layout; waits for it.
    pub fn film(&mut self, transport: &Transport, values: &[[f32; 4]]) -> Result<Film, GpuError> {
        let device = self.gpu.device.clone();
        caught(&device, || self.film_of(transport, values))
    }

    fn film_of(&mut self, transport: &Transport, values: &[[f32; 4]]) -> Result<Film, GpuError> {
        let gpu = self.gpu.clone();
        let mut film = Film::new(transport.layout);
        let matrix = self.ready(transport, values)?;
        for part in &matrix.parts {
            let bytes = part.plan.tiles.len() as u64 * LIGHT;
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let light = gpu.buffer("light", bytes, usage);
            let group = gpu.group(&gpu.pipelines.light, [light.as_entire_binding()]);
            let read = gpu.read_back(bytes, |encoder, target| {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                part.dispatch(&mut pass, &gpu.pipelines.film, &group);
                drop(pass);
                encoder.copy_buffer_to_buffer(&light, 0, target, 0, bytes);
            })?;
            let tiles = read.chunks_exact(LIGHT as usize);
            for (&tile, bytes) in part.plan.tiles.iter().zip(tiles) {
                let blocks = &mut film.blocks[tile * TILE_BLOCKS..][..TILE_BLOCKS];
                take_light(bytes, blocks);
            }
        }
        Ok(film)
    }

    /// The picture as shown: product, development and sRGB in one pass. Waits for the one before, not for
    /// this: whatever the card is told to do with it afterwards finds it done.
    pub fn frame(
        &mut self,
        transport: &Transport,
        values: &[[f32; 4]],
        development: Development,
    ) -> Result<Arc<Picture>, GpuError> {
        let gpu = self.gpu.clone();
        let size = transport.layout.size;
        self.wait_for_last()?;
        let drawn = caught(&gpu.device, || {
            self.ready(transport, values)?;
            let picture = self.free_picture(size);
            self.write_look(development);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            self.draw(&mut encoder.begin_compute_pass(&Default::default()), &picture);
            gpu.queue.submit([encoder.finish()]);
            self.is_busy.store(true, Release);
            let is_busy = self.is_busy.clone();
            gpu.queue.on_submitted_work_done(move || is_busy.store(false, Release));
            Ok(picture)
        });
        match gpu.fault().filter(GpuError::is_lost) {
            Some(lost) => Err(lost),
            None => drawn,
        }
    }

    /// Returns when the card has drawn the picture before. The driver's own waiting would hold locks
    /// that the window's drawing needs.
    fn wait_for_last(&self) -> Result<(), GpuError> {
        let begun = Instant::now();
        loop {
            // Whoever polls runs the callbacks.
            let polled = self.gpu.device.poll(wgpu::PollType::Poll);
            match self.gpu.fault().filter(GpuError::is_lost) {
                Some(lost) => return Err(lost),
                None if !self.is_busy.load(Acquire) => return Ok(()),
                None if polled.is_err() || begun.elapsed() > PATIENCE => {
                    return Err(GpuError::Failed("it does not answer".into()));
                }
                None => std::thread::sleep(GLANCE),
            }
        }
    }

    fn write_look(&self, Development { gain, tone }: Development) {
        let mut bytes = Vec::new();
        Look { gain, tone: tone as u32, marks: u32::from(self.marks) }.write(&mut bytes);
        self.gpu.queue.write_buffer(&self.look, 0, &bytes);
    }

    fn draw(&self, pass: &mut wgpu::ComputePass<'_>, picture: &Picture) {
        for part in self.matrix.iter().flat_map(|matrix| &matrix.parts) {
            let target = &picture.parts[part.plan.piece].group;
            part.dispatch(pass, &self.gpu.pipelines.frame, target);
        }
    }

    /// A picture that nobody looks at.
    fn free_picture(&mut self, size: [u32; 2]) -> Arc<Picture> {
        self.pictures.retain(|picture| picture.size == size);
        let mut pictures = self.pictures.iter_mut();
        if let Some(free) = pictures.find_map(|p| Arc::get_mut(p).is_some().then(|| p.clone())) {
            return free;
        }
        let pieces = self.matrix.as_ref().map_or(&[][..], |matrix| &matrix.pieces);
        let picture = Arc::new(Picture::new(&self.gpu, size, pieces));
        self.pictures.push(picture.clone());
        picture
    }

    /// Brings matrix and values on the card in step with these.
    fn ready(&mut self, transport: &Transport, values: &[[f32; 4]]) -> Result<&Matrix, GpuError> {
        let kept = self.matrix.take().filter(|matrix| matrix.fits(transport, values));
        let matrix = match kept {
            Some(mut matrix) => {
                matrix.renew(&self.gpu, transport);
                matrix
            }
            None => Matrix::upload(&self.gpu, &self.look, transport, values.len(), self.limits)?,
        };
        self.gpu.queue.write_buffer(&matrix.values, 0, &bytes_of(values));
        Ok(self.matrix.insert(matrix))
    }
}

impl Matrix {
    fn upload(
        gpu: &Gpu,
        look: &wgpu::Buffer,
        transport: &Transport,
        terms: usize,
        limits: Limits,
    ) -> Result<Matrix, GpuError> {
        let too_large = || GpuError::Failed("the scene has too many terms for it".into());
        let size = transport.layout.size;
        let pieces = parts::pieces(size, limits);
        let plans = parts::parts(transport, &pieces, limits).ok_or_else(too_large)?;
        let bytes = terms as u64 * 16;
        if bytes > limits.binding {
            return Err(too_large());
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let values = gpu.buffer("values", bytes, usage);
        let part = |plan: Part| {
            let corners = plan.corners(transport.layout, &pieces[plan.piece]);
            let corners = filled(gpu, corners.len() as u64, |view| view.copy_from_slice(&corners));
            let arrays = Kind::ALL.map(|kind| upload_array(gpu, &plan, kind, transport));
            let fixed = [look, &values, &corners].into_iter();
            let bindings = fixed.chain(&arrays).map(wgpu::Buffer::as_entire_binding);
            let group = gpu.group(&gpu.pipelines.matrix, bindings);
            MatrixPart { plan, arrays: arrays.into(), group }
        };
        let parts = plans.into_iter().map(part).collect();
        Ok(Matrix { size, pieces, terms, values, parts })
    }

    /// Whether another matrix takes the same place, and as many values.
    fn fits(&self, transport: &Transport, values: &[[f32; 4]]) -> bool {
        self.size == transport.layout.size
            && self.terms == values.len()
            && self.parts.iter().all(|part| part.plan.fits(transport))
    }

    /// Uploads the tiles that it does not have yet.
    fn renew(&mut self, gpu: &Gpu, transport: &Transport) {
        let mut bytes = Vec::new();
        for part in &mut self.parts {
            for run in part.plan.renew(transport) {
                for (kind, array) in Kind::ALL.into_iter().zip(&part.arrays) {
                    bytes.clear();
                    part.plan.write(kind, run.clone(), transport, &mut bytes);
                    let place = part.plan.place(kind, &run);
                    gpu.queue.write_buffer(array, place.start, &bytes);
                }
            }
        }
    }
}

impl MatrixPart {
    fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        pipeline: &wgpu::ComputePipeline,
        target: &wgpu::BindGroup,
    ) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_bind_group(1, target, &[]);
        let groups = (TILE_BLOCKS * LANES) as u32 / GROUP;
        pass.dispatch_workgroups(groups, self.plan.tiles.len() as u32, 1);
    }
}

/// A buffer that is filled before anything else is done with it; never an empty one, which no card
/// takes.
fn filled(gpu: &Gpu, size: u64, fill: impl FnOnce(&mut wgpu::BufferViewMut)) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("matrix"),
        size: size.max(64),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: true,
    });
    // Without memory there is nothing to fill, which is an error that the caller catches.
    if size > 0
        && let Ok(mut view) = buffer.get_mapped_range_mut(..size)
    {
        fill(&mut view);
    }
    buffer.unmap();
    buffer
}

/// An array of a part, tile by tile, so that the bytes are never held twice.
fn upload_array(gpu: &Gpu, plan: &Part, kind: Kind, transport: &Transport) -> wgpu::Buffer {
    filled(gpu, plan.bytes(kind), |view| {
        let mut bytes = Vec::new();
        for at in 0..plan.tiles.len() {
            let tile = at..at + 1;
            let place = plan.place(kind, &tile);
            bytes.clear();
            plan.write(kind, tile, transport, &mut bytes);
            view.slice(place.start as usize..place.end as usize).copy_from_slice(&bytes);
        }
    })
}

/// Values of terms as the shader reads them.
fn bytes_of(values: &[[f32; 4]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of_val(values));
    values.iter().flatten().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
    bytes
}

/// Blocks of light from the bytes of the shader's.
fn take_light(bytes: &[u8], blocks: &mut [FilmBlock]) {
    let (floats, _) = bytes.as_chunks::<4>();
    let rows = blocks.iter_mut().flat_map(|block| block.0.iter_mut().flatten());
    for (value, &bytes) in rows.zip(floats) {
        *value = f32::from_le_bytes(bytes);
    }
}
