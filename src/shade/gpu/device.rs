//! A graphics card that can shade: its device, what goes wrong with it, and the compiled shader.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use super::parts::Limits;

/// Threads that run together, as the shader has it.
pub(super) const GROUP: u32 = 64;

/// What a card needs to time its work.
const CLOCK: wgpu::Features =
    wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);

/// Why a graphics card does not give the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GpuError {
    /// There is no card, or it cannot do what the shader needs.
    Unfit(String),
    /// It is gone: switched off, reset by its driver, or taken out.
    Lost(String),
    /// It refused something, such as more memory.
    Failed(String),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GpuError::Unfit(cause) => write!(f, "no graphics card that can shade ({cause})"),
            GpuError::Lost(cause) => write!(f, "the graphics card was lost ({cause})"),
            GpuError::Failed(cause) => write!(f, "the graphics card refused its work ({cause})"),
        }
    }
}

/// What went wrong with a device that nobody waited for, told from any thread.
#[derive(Clone, Default)]
pub struct Watch(Arc<Mutex<Option<GpuError>>>);

impl Watch {
    /// Watches a device from now on; `wake` is called when something went wrong. Without a watch, an
    /// error that nobody waits for ends the program.
    pub fn new(device: &wgpu::Device, wake: impl Fn() + Clone + Send + Sync + 'static) -> Watch {
        let watch = Watch::default();
        let (lost, woken) = (watch.clone(), wake.clone());
        device.set_device_lost_callback(move |reason, cause| {
            let cause = match reason {
                wgpu::DeviceLostReason::Destroyed => "it was given up".into(),
                wgpu::DeviceLostReason::Unknown => line(&cause),
            };
            lost.tell(GpuError::Lost(cause));
            woken();
        });
        let failed = watch.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            failed.tell(GpuError::Failed(line(&error.to_string())));
            wake();
        }));
        watch
    }

    /// The first thing that went wrong; but that the device was lost counts more than what followed.
    pub fn fault(&self) -> Option<GpuError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn tell(&self, error: GpuError) {
        let mut fault = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !matches!(*fault, Some(GpuError::Lost(_))) && (fault.is_none() || error.is_lost()) {
            *fault = Some(error);
        }
    }
}

impl GpuError {
    /// Whether the whole device is gone, and not only this use of it.
    pub fn is_lost(&self) -> bool {
        matches!(self, GpuError::Lost(_))
    }
}

/// The first line of a driver's message.
pub(super) fn line(message: &str) -> String {
    message.lines().next().unwrap_or_default().trim().trim_end_matches('.').to_owned()
}

/// A graphics card that can shade: cheap to clone, usable from any thread.
#[derive(Clone)]
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    watch: Watch,
    pub(super) pipelines: Arc<Pipelines>,
}

pub(super) struct Pipelines {
    pub(super) matrix: wgpu::BindGroupLayout,
    pub(super) light: wgpu::BindGroupLayout,
    pub(super) shown: wgpu::BindGroupLayout,
    pub(super) film: wgpu::ComputePipeline,
    pub(super) frame: wgpu::ComputePipeline,
}

impl Gpu {
    /// Makes a device of the window's ready. It is watched by `watch`.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue, watch: Watch) -> Result<Gpu, GpuError> {
        let most = device.limits().max_compute_invocations_per_workgroup;
        if most < GROUP {
            return Err(GpuError::Unfit(format!("{most} threads at a time")));
        }
        let pipelines = caught(&device, || Ok(Pipelines::new(&device)));
        let pipelines = pipelines.map_err(|error| match error {
            GpuError::Failed(cause) => GpuError::Unfit(cause),
            other => other,
        })?;
        Ok(Gpu { device, queue, watch, pipelines: Arc::new(pipelines) })
    }

    /// A card without a window, for tests and measurements.
    pub fn headless() -> Result<Gpu, GpuError> {
        let unfit = |cause: String| GpuError::Unfit(line(&cause));
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
        let adapter = pollster::block_on(adapter).map_err(|e| unfit(e.to_string()))?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("rayforest"),
            required_features: adapter.features() & CLOCK,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let device = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = device.map_err(|e| unfit(e.to_string()))?;
        let watch = Watch::new(&device, || {});
        Gpu::new(device, queue, watch)
    }

    /// What the driver calls it.
    pub fn name(&self) -> String {
        let wgpu::AdapterInfo { name, backend, .. } = self.device.adapter_info();
        format!("{name} ({backend})")
    }

    /// Whether it is the processor that pretends to be a card: the CPU's own product is faster.
    pub fn is_software(&self) -> bool {
        self.device.adapter_info().device_type == wgpu::DeviceType::Cpu
    }

    /// What it takes at most.
    pub fn limits(&self) -> Limits {
        let limits = self.device.limits();
        Limits {
            binding: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
            tiles: limits.max_compute_workgroups_per_dimension,
            texture_side: limits.max_texture_dimension_2d,
        }
    }

    /// Gives the device up, as a driver does that fails.
    pub fn lose(&self) {
        self.device.destroy();
        // The callback is called once nothing runs any more.
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// Bytes that `fill` copies into a buffer.
    pub(super) fn read_back(
        &self,
        bytes: u64,
        fill: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
    ) -> Result<Vec<u8>, GpuError> {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let buffer = self.buffer("read back", bytes, usage);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        fill(&mut encoder, &buffer);
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        self.wait()?;
        let failed = |cause: String| self.fault().unwrap_or(GpuError::Failed(line(&cause)));
        let view = buffer.get_mapped_range(..).map_err(|e| failed(e.to_string()))?;
        Ok(view.to_vec())
    }

    /// Waits until everything is done.
    pub fn wait(&self) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        let failed = |cause: String| self.fault().unwrap_or(GpuError::Failed(line(&cause)));
        waited.map(|_| ()).map_err(|e| failed(e.to_string()))
    }

    /// Whether it can time its work.
    pub(super) fn has_clock(&self) -> bool {
        self.device.features().contains(CLOCK)
    }

    /// A buffer, empty.
    pub(super) fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let label = Some(label);
        let mapped_at_creation = false;
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label,
            size,
            usage,
            mapped_at_creation,
        })
    }

    /// What went wrong that nobody waited for.
    pub fn fault(&self) -> Option<GpuError> {
        self.watch.fault()
    }

    /// A bind group of these resources, from binding 0 on.
    pub(super) fn group<'a>(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let entries = &entries[..];
        let label = Some("rayforest");
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries })
    }
}

/// Does something with a device; what it refuses is an error.
pub(super) fn caught<T>(
    device: &wgpu::Device,
    job: impl FnOnce() -> Result<T, GpuError>,
) -> Result<T, GpuError> {
    use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
    let [outer, middle, inner] =
        [Internal, OutOfMemory, Validation].map(|filter| device.push_error_scope(filter));
    let result = job();
    // Outside of a browser what was caught is known at once.
    let [a, b, c] = [
        pollster::block_on(inner.pop()),
        pollster::block_on(middle.pop()),
        pollster::block_on(outer.pop()),
    ];
    match a.or(b).or(c) {
        Some(error) => Err(GpuError::Failed(line(&error.to_string()))),
        None => result,
    }
}

impl Pipelines {
    fn new(device: &wgpu::Device) -> Pipelines {
        use wgpu::BufferBindingType::{Storage, Uniform};
        let entry = |binding: u32, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let buffer = |ty| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let group = |entries: &[_]| {
            let label = Some("rayforest");
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries })
        };
        let read = |binding| entry(binding, buffer(Storage { read_only: true }));
        let look = entry(0, buffer(Uniform));
        let matrix = group(&[look, read(1), read(2), read(3), read(4), read(5), read(6)]);
        let light = group(&[entry(0, buffer(Storage { read_only: false }))]);
        let texture = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let shown = group(&[entry(0, texture)]);
        let module = device.create_shader_module(wgpu::include_wgsl!("../shade.wgsl"));
        let pipeline = |name, target| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(&matrix), Some(target)],
                immediate_size: 0,
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(name),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        let (film, frame) = (pipeline("film", &light), pipeline("frame", &shown));
        Pipelines { matrix, light, shown, film, frame }
    }
}

/// What pictures hold: sRGB-encoded values, which the window draws as they are.
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
