//! Finding and opening an adapter.

use std::fmt;
use std::sync::{Arc, Mutex, OnceLock};

use wgpu::{Backends, DeviceType};

use super::arithmetic::{Arithmetic, PROBE_WGSL};
use super::{GpuError, Tuning};

/// How to get a software adapter.
pub const SOFTWARE_HINT: &str = "For a software adapter (Mesa's lavapipe) on Debian or Ubuntu: \
    apt-get install mesa-vulkan-drivers libvulkan1; on Fedora: dnf install mesa-vulkan-drivers vulkan-loader; \
    on Arch: pacman -S vulkan-swrast vulkan-icd-loader";

/// What sort of device an adapter is; the order is that of preference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// A graphics card.
    Discrete,
    /// A GPU that shares the processor's memory.
    Integrated,
    /// A GPU of a virtual machine's host.
    Virtual,
    /// A device that does not say what it is.
    Other,
    /// The CPU, through a driver such as lavapipe.
    Software,
}

impl AdapterKind {
    /// Whether computing there is real GPU work.
    pub fn is_real(self) -> bool {
        self < AdapterKind::Other
    }
}

impl fmt::Display for AdapterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            AdapterKind::Discrete => "discrete",
            AdapterKind::Integrated => "integrated",
            AdapterKind::Virtual => "virtual",
            AdapterKind::Other => "other",
            AdapterKind::Software => "software",
        })
    }
}

/// An adapter in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterSummary {
    /// The device's name.
    pub name: String,
    /// What sort of device it is.
    pub kind: AdapterKind,
    /// Through which programming interface: `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// The driver's name and version.
    pub driver: String,
}

impl fmt::Display for AdapterSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {}, {})", self.name, self.kind, self.backend, self.driver)
    }
}

impl AdapterSummary {
    fn new(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let kind = match info.device_type {
            DeviceType::DiscreteGpu => AdapterKind::Discrete,
            DeviceType::IntegratedGpu => AdapterKind::Integrated,
            DeviceType::VirtualGpu => AdapterKind::Virtual,
            DeviceType::Cpu => AdapterKind::Software,
            DeviceType::Other => AdapterKind::Other,
        };
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        AdapterSummary { name: info.name, kind, backend: info.backend.to_string(), driver }
    }
}

/// Which adapter to take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The best there is, a software one if there is no other.
    Best,
    /// The best real GPU; never a software one.
    Real,
    /// A software adapter.
    Software,
    /// The first whose name contains these words, in whatever case.
    Named(String),
}

impl AdapterChoice {
    fn fits(&self, adapter: &AdapterSummary) -> bool {
        match self {
            AdapterChoice::Best => true,
            AdapterChoice::Real => adapter.kind.is_real(),
            AdapterChoice::Software => adapter.kind == AdapterKind::Software,
            AdapterChoice::Named(part) => adapter.name.to_lowercase().contains(&part.to_lowercase()),
        }
    }

    fn words(&self) -> String {
        match self {
            AdapterChoice::Best => "GPU adapter".to_owned(),
            AdapterChoice::Real => "real GPU".to_owned(),
            AdapterChoice::Software => "software adapter".to_owned(),
            AdapterChoice::Named(part) => format!("adapter with {part:?} in its name"),
        }
    }
}

fn enumerate() -> Vec<(AdapterSummary, wgpu::Adapter)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: Backends::PRIMARY,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut all: Vec<_> = pollster::block_on(instance.enumerate_adapters(Backends::PRIMARY))
        .into_iter()
        .map(|adapter| (AdapterSummary::new(&adapter), adapter))
        .collect();
    all.sort_by_key(|(summary, _)| summary.kind);
    all
}

/// All adapters that this machine offers, the best first, opened.
pub fn open_all() -> Vec<(AdapterSummary, Result<Device, GpuError>)> {
    let opened = |(summary, adapter): (AdapterSummary, wgpu::Adapter)| {
        let device = Device::of(&summary, &adapter);
        (summary, device)
    };
    enumerate().into_iter().map(opened).collect()
}

/// All adapters that this machine offers, the best first.
pub fn adapters() -> Vec<AdapterSummary> {
    enumerate().into_iter().map(|(summary, _)| summary).collect()
}

struct Complaint {
    words: String,
    /// Whether the device is gone for good.
    lost: bool,
}

/// An opened adapter. Clones share it.
#[derive(Clone)]
pub struct Device {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    summary: AdapterSummary,
    tuning: Tuning,
    /// The first thing that the device or its driver complained of since it was last asked.
    complaint: Arc<Mutex<Option<Complaint>>>,
    /// What it makes of f32, once it was asked.
    arithmetic: Arc<OnceLock<Arithmetic>>,
}

impl Device {
    /// Opens the first adapter that fits `choice`.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] with a list of what there is, or the reason why the adapter cannot be used.
    pub fn open(choice: &AdapterChoice) -> Result<Device, GpuError> {
        let all = enumerate();
        let Some((summary, adapter)) = all.iter().find(|(summary, _)| choice.fits(summary)) else {
            let found = all.into_iter().map(|(summary, _)| summary).collect();
            return Err(GpuError::NoAdapter { wanted: choice.words(), found });
        };
        Device::of(summary, adapter)
    }

    fn of(summary: &AdapterSummary, adapter: &wgpu::Adapter) -> Result<Device, GpuError> {
        let unfit = |why: String| GpuError::Unfit { adapter: summary.name.clone(), why };
        let limits = adapter.limits();
        if limits.max_uniform_buffer_binding_size < super::pages::PAGE_BYTES {
            return Err(unfit("its uniform buffers hold less than 64 KiB".to_owned()));
        }
        let request = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&request)).map_err(|cause| unfit(cause.to_string()))?;
        let complaint = Arc::new(Mutex::new(None));
        let heard = Arc::clone(&complaint);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| hear(&heard, error.to_string(), false)));
        let heard = Arc::clone(&complaint);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                hear(&heard, format!("the device was lost: {message}"), true);
            }
        });
        let tuning = Tuning::of(summary.kind, adapter.get_info().subgroup_max_size);
        let arithmetic = Arc::default();
        Ok(Device { device, queue, summary: summary.clone(), tuning, complaint, arithmetic })
    }

    /// The same device, judged by what the kernel with source `wgsl` finds instead of `probe.wgsl`.
    ///
    /// # Errors
    ///
    /// As [`arithmetic`](Self::arithmetic).
    pub fn probed(mut self, wgsl: &str) -> Result<Device, GpuError> {
        self.arithmetic = Arc::new(OnceLock::from(Arithmetic::of(&self, wgsl)?));
        Ok(self)
    }

    /// What the device makes of f32. It is asked once, in some milliseconds.
    ///
    /// # Errors
    ///
    /// What the device complains of, or that it does not answer.
    pub fn arithmetic(&self) -> Result<&Arithmetic, GpuError> {
        if let Some(known) = self.arithmetic.get() {
            return Ok(known);
        }
        let found = Arithmetic::of(self, PROBE_WGSL)?;
        Ok(self.arithmetic.get_or_init(|| found))
    }

    /// An error if exact ropes cannot rely on the device's f32.
    pub(crate) fn certify(&self) -> Result<(), GpuError> {
        match &self.arithmetic()?.fault {
            None => Ok(()),
            Some(fault) => Err(self.unfit(format!("{fault}. Take another adapter, the engine cpu, or precision fast"))),
        }
    }

    /// The adapter in words.
    pub fn summary(&self) -> &AdapterSummary {
        &self.summary
    }

    /// What suits the adapter.
    pub fn tuning(&self) -> Tuning {
        self.tuning
    }

    /// An error if the device has complained since it was last asked, or is lost.
    pub(super) fn check(&self) -> Result<(), GpuError> {
        let Ok(mut complaint) = self.complaint.lock() else { return Err(self.failed("its error handler broke")) };
        match &*complaint {
            None => Ok(()),
            Some(Complaint { words, lost: true }) => Err(self.failed(words)),
            Some(_) => Err(self.failed(complaint.take().map_or(String::new(), |c| c.words))),
        }
    }

    pub(super) fn unfit(&self, why: String) -> GpuError {
        GpuError::Unfit { adapter: self.summary.name.clone(), why }
    }

    pub(crate) fn failed(&self, why: impl ToString) -> GpuError {
        GpuError::Failed { adapter: self.summary.name.clone(), why: why.to_string() }
    }
}

fn hear(complaint: &Mutex<Option<Complaint>>, words: String, lost: bool) {
    if let Ok(mut complaint) = complaint.lock()
        && complaint.as_ref().is_none_or(|c| lost && !c.lost)
    {
        *complaint = Some(Complaint { words, lost });
    }
}
