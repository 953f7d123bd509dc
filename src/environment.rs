//! What a measurement depends on besides the program: without it, numbers cannot be compared.

use std::process::{Command, Stdio};

use crate::gpu::AdapterSummary;

/// Where something was measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Environment {
    /// The GPU, if there was one.
    pub adapter: Option<AdapterSummary>,
    /// The processor, as [`processor`] knows it.
    pub processor: String,
    /// The operating system and the kind of processor, `linux x86_64` say.
    pub os: String,
    /// How many threads engines on threads used.
    pub threads: usize,
    /// The version of this crate.
    pub version: &'static str,
    /// The commit that it was built from, with `-changed` if the files were not those of the commit; `unknown` where
    /// there was no repository.
    pub commit: &'static str,
}

impl Environment {
    /// This machine's, with the adapter that was opened.
    pub fn here(adapter: Option<AdapterSummary>) -> Self {
        Environment {
            adapter,
            processor: processor(),
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            threads: rayon::current_num_threads(),
            version: env!("CARGO_PKG_VERSION"),
            commit: env!("TAUTLINE_COMMIT"),
        }
    }
}

/// The processor's name, from `/proc/cpuinfo` or `sysctl`; `unknown` where there is neither.
pub fn processor() -> String {
    let proc = || named_in(&std::fs::read_to_string("/proc/cpuinfo").ok()?);
    let sysctl = || {
        let mut command = Command::new("sysctl");
        let output = command.args(["-n", "machdep.cpu.brand_string"]).stderr(Stdio::null()).output().ok()?;
        let name = String::from_utf8(output.stdout).ok()?.trim().to_owned();
        (output.status.success() && !name.is_empty()).then_some(name)
    };
    proc().or_else(sysctl).unwrap_or_else(|| "unknown".to_owned())
}

/// The name that the text of `/proc/cpuinfo` gives: on most kinds of processors in the line `model name`.
fn named_in(cpuinfo: &str) -> Option<String> {
    let value = |wanted: &str| {
        let fields = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        fields.map(|(key, value)| (key.trim(), value.trim())).find(|(key, value)| *key == wanted && !value.is_empty())
    };
    ["model name", "Model", "cpu model"].into_iter().find_map(value).map(|(_, name)| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processors_name_themselves_in_different_lines() {
        assert_eq!(named_in("processor\t: 0\nmodel name\t: A 9\n"), Some("A 9".to_owned()));
        assert_eq!(named_in("processor : 0\nModel : Pi\n"), Some("Pi".to_owned()));
        assert_eq!(named_in("model name :\n"), None);
    }
}
