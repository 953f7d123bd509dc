//! Finding an adapter.

use std::fmt;

use wgpu::{Backends, DeviceType};

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
    /// Its place among all that this machine offers, the best first, counted from 0: it tells two of one name apart.
    pub number: usize,
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
        AdapterSummary { number: 0, name: info.name, kind, backend: info.backend.to_string(), driver }
    }

    /// Whether it is Mesa's lavapipe, whose device is called llvmpipe.
    pub fn is_lavapipe(&self) -> bool {
        self.kind == AdapterKind::Software && self.name.starts_with("llvmpipe")
    }
}

/// Which adapter to take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The best there is, a software one if there is no other.
    Best,
    /// The best real GPU; never a software one.
    Real,
    /// A software adapter: lavapipe if it is there, else the first that is.
    Software,
    /// The adapter of that number if it is one of one or two digits; else the first whose name contains these words, in
    /// whatever case.
    Named(String),
}

impl AdapterChoice {
    /// Those that fit, of all that there are, the one to be taken first.
    pub(super) fn fitting<'a>(&self, all: &'a [AdapterSummary]) -> Vec<&'a AdapterSummary> {
        let those = |fits: &dyn Fn(&AdapterSummary) -> bool| all.iter().filter(|a| fits(a)).collect();
        match self {
            AdapterChoice::Best => those(&|_| true),
            AdapterChoice::Real => those(&|a| a.kind.is_real()),
            AdapterChoice::Software => {
                let mut those: Vec<_> = those(&|a| a.kind == AdapterKind::Software);
                those.sort_by_key(|a| !a.is_lavapipe());
                those
            }
            AdapterChoice::Named(words) => match numbered(words) {
                Some(number) => those(&|a| a.number == number),
                None => those(&|a| a.name.to_lowercase().contains(&words.to_lowercase())),
            },
        }
    }

    pub(super) fn words(&self) -> String {
        match self {
            AdapterChoice::Best => "GPU adapter".to_owned(),
            AdapterChoice::Real => "real GPU".to_owned(),
            AdapterChoice::Software => "software adapter".to_owned(),
            AdapterChoice::Named(number) if numbered(number).is_some() => format!("adapter of the number {number:?}"),
            AdapterChoice::Named(part) => format!("adapter with {part:?} in its name"),
        }
    }
}

/// The number that these words are: longer ones are part of names, as in RTX 3090.
fn numbered(words: &str) -> Option<usize> {
    words.parse().ok().filter(|_| words.len() <= 2)
}

/// All adapters that this machine offers, the best first, and how to open them.
pub(super) fn enumerate() -> Vec<(AdapterSummary, wgpu::Adapter)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: Backends::PRIMARY,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut all: Vec<_> = pollster::block_on(instance.enumerate_adapters(Backends::PRIMARY))
        .into_iter()
        .map(|adapter| (AdapterSummary::new(&adapter), adapter))
        .collect();
    all.sort_by_key(|(summary, _)| summary.kind);
    all.iter_mut().enumerate().for_each(|(number, (summary, _))| summary.number = number);
    all
}

/// All adapters that this machine offers, the best first.
pub fn adapters() -> Vec<AdapterSummary> {
    enumerate().into_iter().map(|(summary, _)| summary).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_are_found_by_number_name_and_kind() {
        let adapter = |number: usize, name: &str, kind| {
            let (name, backend, driver) = (name.to_owned(), "vulkan".to_owned(), String::new());
            AdapterSummary { number, name, kind, backend, driver }
        };
        let all = [
            adapter(0, "GeForce RTX 3090", AdapterKind::Discrete),
            adapter(1, "GeForce RTX 3090", AdapterKind::Discrete),
            adapter(2, "Iris Xe", AdapterKind::Integrated),
            adapter(3, "SwiftShader Device (Subzero)", AdapterKind::Software),
            adapter(4, "llvmpipe (LLVM 15.0.6, 256 bits)", AdapterKind::Software),
        ];
        let named = |words: &str| AdapterChoice::Named(words.to_owned());
        for (choice, numbers) in [
            (AdapterChoice::Best, &[0, 1, 2, 3, 4][..]),
            (AdapterChoice::Real, &[0, 1, 2]),
            (AdapterChoice::Software, &[4, 3]),
            (named("rtx"), &[0, 1]),
            (named("1"), &[1]),
            (named("3"), &[3]),
            // No number in the list.
            (named("3090"), &[0, 1]),
            (named("15.0"), &[4]),
            (named("15"), &[]),
            (named("7"), &[]),
            (named("swiftshader"), &[3]),
        ] {
            let found: Vec<usize> = choice.fitting(&all).iter().map(|a| a.number).collect();
            assert_eq!(found, numbers, "{choice:?}");
        }
        assert_eq!(AdapterChoice::Software.fitting(&all[..4])[0].number, 3);
    }
}
