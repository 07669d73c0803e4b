//! How long the graphics card works, by its own clock.

use std::time::Instant;

use super::device::{GpuError, caught};
use super::{Matrix, Product, bytes_of};
use crate::film::develop::Development;
use crate::fold::transport::Transport;

/// Milliseconds of one upload of a matrix and of one edit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timings {
    /// From the matrix in memory to the matrix on the card, by the processor's clock: nothing of it is
    /// a command of its own.
    pub matrix: f64,
    /// The values of the terms, from memory that the card reads to its own; by the card's clock, if it
    /// has one.
    pub values: Option<f64>,
    /// The product, exposure and sRGB included; by the card's clock, if it has one.
    pub dispatch: Option<f64>,
}

impl Product {
    /// Uploads the whole matrix, then draws it once, and waits for both.
    pub fn measure(
        &mut self,
        transport: &Transport,
        values: &[[f32; 4]],
        development: Development,
    ) -> Result<Timings, GpuError> {
        self.matrix = None;
        let begun = Instant::now();
        caught(&self.gpu.clone().device, || {
            self.ready(transport, values)?;
            // Nothing is uploaded before something is submitted.
            self.gpu.queue.submit([]);
            self.gpu.wait()
        })?;
        let matrix = begun.elapsed().as_secs_f64() * 1e3;
        let [values, dispatch] = match self.gpu.has_clock() {
            true => {
                let device = self.gpu.device.clone();
                caught(&device, || self.timed(transport, values, development))?.map(Some)
            }
            false => [None; 2],
        };
        Ok(Timings { matrix, values, dispatch })
    }

    /// Milliseconds of copying the values and of the product.
    fn timed(
        &mut self,
        transport: &Transport,
        values: &[[f32; 4]],
        development: Development,
    ) -> Result<[f64; 2], GpuError> {
        let picture = self.free_picture(transport.layout.size);
        self.write_look(development);
        let gpu = self.gpu.clone();
        let Some(Matrix { values: target, .. }) = &self.matrix else { return Ok([0.0; 2]) };
        let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let source = gpu.buffer("values to be copied", target.size(), usage);
        gpu.queue.write_buffer(&source, 0, &bytes_of(values));
        let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("clock"),
            ty: wgpu::QueryType::Timestamp,
            count: 4,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("times", 32, usage);
        let read = gpu.read_back(32, |encoder, times| {
            encoder.write_timestamp(&set, 0);
            encoder.copy_buffer_to_buffer(&source, 0, target, 0, target.size());
            encoder.write_timestamp(&set, 1);
            let clock = wgpu::ComputePassTimestampWrites {
                query_set: &set,
                beginning_of_pass_write_index: Some(2),
                end_of_pass_write_index: Some(3),
            };
            self.draw(
                &mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("frame"),
                    timestamp_writes: Some(clock),
                }),
                &picture,
            );
            encoder.resolve_query_set(&set, 0..4, &resolved, 0);
            encoder.copy_buffer_to_buffer(&resolved, 0, times, 0, 32);
        })?;
        let (ticks, _) = read.as_chunks::<8>();
        let ticks: Vec<u64> = ticks.iter().map(|&bytes| u64::from_le_bytes(bytes)).collect();
        let period = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let between = |from: usize| ticks[from + 1].saturating_sub(ticks[from]) as f64 * period;
        Ok([between(0), between(2)])
    }
}
