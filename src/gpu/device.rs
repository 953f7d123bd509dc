//! An opened adapter.

use std::sync::{Arc, Mutex, OnceLock};

use super::adapter::{AdapterChoice, AdapterSummary, enumerate};
use super::arithmetic::Arithmetic;
use super::buffers::{PAGE_BYTES, PATIENCE};
use super::{GpuError, Tuning, drivers, nodes};

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
    /// Others that fit as well what was asked for.
    passed_over: Vec<AdapterSummary>,
    tuning: Tuning,
    /// How many bytes of it an engine takes at most.
    memory: usize,
    /// The first thing that the device or its driver complained of since it was last asked.
    complaint: Arc<Mutex<Option<Complaint>>>,
    /// What it makes of f32, once it was asked.
    pub(super) arithmetic: Arc<OnceLock<Arithmetic>>,
}

impl Device {
    /// Opens the first adapter that fits `choice`.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] with a list of what there is, or the reason why the adapter cannot be used. Where it is
    /// to be a real GPU and none can be there, [`GpuError::NoDeviceFile`], without a look at what there is.
    pub fn open(choice: &AdapterChoice) -> Result<Device, GpuError> {
        if *choice == AdapterChoice::Real && !nodes::may_be_real() {
            return Err(GpuError::NoDeviceFile);
        }
        let all = enumerate();
        let found: Vec<AdapterSummary> = all.iter().map(|(summary, _)| summary.clone()).collect();
        let fitting = choice.fitting(&found);
        let Some((first, others)) = fitting.split_first() else {
            return Err(GpuError::NoAdapter { wanted: choice.words(), found, advice: drivers::advice() });
        };
        let mut device = Device::of(first, &all[first.number].1)?;
        device.passed_over = others.iter().map(|&other| other.clone()).collect();
        Ok(device)
    }

    fn of(summary: &AdapterSummary, adapter: &wgpu::Adapter) -> Result<Device, GpuError> {
        let unfit = |why: String| GpuError::Unfit { adapter: summary.name.clone(), why };
        let limits = adapter.limits();
        if limits.max_uniform_buffer_binding_size < PAGE_BYTES {
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
        Ok(Device {
            device,
            queue,
            summary: summary.clone(),
            passed_over: Vec::new(),
            tuning,
            memory: Tuning::memory(summary.kind),
            complaint,
            arithmetic: Arc::default(),
        })
    }

    /// The adapter in words.
    pub fn summary(&self) -> &AdapterSummary {
        &self.summary
    }

    /// Other adapters that fit as well what was asked for.
    pub fn passed_over(&self) -> &[AdapterSummary] {
        &self.passed_over
    }

    /// What suits the adapter.
    pub fn tuning(&self) -> Tuning {
        self.tuning
    }

    /// How many bytes of the device's memory an engine takes at most, about: what a batch of traces needs there is
    /// brought in parts. Some memory is always taken, a few MiB.
    pub fn memory(&self) -> usize {
        self.memory
    }

    /// The same device, of whose memory an engine takes at most so many bytes.
    #[must_use]
    pub fn with_memory(self, bytes: usize) -> Self {
        Device { memory: bytes, ..self }
    }

    /// How many bytes a buffer of the device has at most, if shaders are to read it.
    pub fn largest_buffer(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
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

    /// Waits until a submission is done: an error if the device does not answer, or has complained.
    pub(super) fn wait(&self, submission: &wgpu::SubmissionIndex) -> Result<(), GpuError> {
        let wait = wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(PATIENCE) };
        match self.device.poll(wait) {
            Ok(_) => self.check(),
            Err(wgpu::PollError::Timeout) => {
                Err(GpuError::Timeout { adapter: self.summary.name.clone(), seconds: PATIENCE.as_secs() })
            }
            Err(other) => Err(self.failed(other)),
        }
    }

    pub(super) fn unfit(&self, why: String) -> GpuError {
        GpuError::Unfit { adapter: self.summary.name.clone(), why }
    }

    pub(crate) fn failed(&self, why: impl ToString) -> GpuError {
        GpuError::Failed { adapter: self.summary.name.clone(), why: why.to_string() }
    }
}

/// All adapters that this machine offers, the best first, opened.
pub fn open_all() -> Vec<(AdapterSummary, Result<Device, GpuError>)> {
    let opened = |(summary, adapter): (AdapterSummary, wgpu::Adapter)| {
        let device = Device::of(&summary, &adapter);
        (summary, device)
    };
    enumerate().into_iter().map(opened).collect()
}

fn hear(complaint: &Mutex<Option<Complaint>>, words: String, lost: bool) {
    if let Ok(mut complaint) = complaint.lock()
        && complaint.as_ref().is_none_or(|c| lost && !c.lost)
    {
        *complaint = Some(Complaint { words, lost });
    }
}
