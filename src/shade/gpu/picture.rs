//! Pictures on the graphics card, as shown.

use super::device::{FORMAT, Gpu, GpuError};
use super::parts::Piece;
use crate::film::Frame;

/// Bytes to which the rows of a texture are padded when it is read.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// A picture on the card, as shown. Who holds it is sure that it stays what it is.
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    pub(super) parts: Vec<PicturePart>,
}

pub(super) struct PicturePart {
    piece: Piece,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    pub(super) group: wgpu::BindGroup,
}

impl Picture {
    pub(super) fn new(gpu: &Gpu, size: [u32; 2], pieces: &[Piece]) -> Picture {
        let part = |&piece: &Piece| {
            let [width, height] = piece.size;
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            let resource = wgpu::BindingResource::TextureView(&view);
            let group = gpu.group(&gpu.pipelines.shown, [resource]);
            PicturePart { piece, texture, view, group }
        };
        Picture { size, parts: pieces.iter().map(part).collect() }
    }

    /// Its textures, and the rectangle of the picture that each is.
    pub fn textures(&self) -> impl Iterator<Item = (&wgpu::TextureView, Piece)> {
        self.parts.iter().map(|part| (&part.view, part.piece))
    }

    /// Reads it back, and waits for it.
    pub fn read(&self, gpu: &Gpu) -> Result<Frame, GpuError> {
        let mut frame = Frame::new(self.size);
        let width = self.size[0] as usize;
        for part in &self.parts {
            let Piece { corner: [left, top], size: [wide, tall] } = part.piece;
            let row = (wide * 4).next_multiple_of(ROW);
            let bytes = gpu.read_back(u64::from(row) * u64::from(tall), |encoder, target| {
                let layout = wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                };
                let target = wgpu::TexelCopyBufferInfo { buffer: target, layout };
                let source = part.texture.as_image_copy();
                encoder.copy_texture_to_buffer(source, target, part.texture.size());
            })?;
            for (y, row) in bytes.chunks_exact(row as usize).enumerate() {
                let at = ((top as usize + y) * width + left as usize) * 4;
                let own = wide as usize * 4;
                frame.bytes[at..at + own].copy_from_slice(&row[..own]);
            }
        }
        Ok(frame)
    }
}
