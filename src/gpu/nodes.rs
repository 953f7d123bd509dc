//! Whether a real GPU can be here at all. To ask the drivers costs some 25 ms of a core even where there is none, since
//! a software driver is loaded for it. Where all drivers that are installed are known to need a file in `/dev` that is
//! not there, they need not be asked.

use std::env::var_os;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// Of Mesa's drivers, and SwiftShader, parts of the libraries' names, and the files in `/dev` of which they need one:
/// none of those that compute on the CPU.
const KNOWN: [(&str, &[&str]); 14] = [
    ("vulkan_lvp", &[]),
    ("vk_swiftshader", &[]),
    ("vulkan_intel", &["dri"]),
    ("vulkan_radeon", &["dri"]),
    ("amdvlk", &["dri"]),
    ("vulkan_nouveau", &["dri"]),
    ("vulkan_broadcom", &["dri"]),
    ("vulkan_panfrost", &["dri"]),
    ("vulkan_asahi", &["dri"]),
    ("vulkan_powervr", &["dri"]),
    ("vulkan_virtio", &["dri", "udmabuf"]),
    ("vulkan_freedreno", &["dri", "kgsl-3d0"]),
    ("vulkan_dzn", &["dxg"]),
    ("GLX_nvidia", &["dri", "nvidia0", "nvidiactl", "dxg", "nvhost-gpu", "nvgpu"]),
];

/// Variables that say where drivers are, or that one is elsewhere than in this machine: where one of them is set, the
/// drivers are asked.
const SAID: [&str; 6] = [
    "VK_DRIVER_FILES",
    "VK_ICD_FILENAMES",
    "VK_ADD_DRIVER_FILES",
    "VK_LOADER_DRIVERS_SELECT",
    "VN_DEBUG",
    "VTEST_SOCKET_NAME",
];

/// Whether there may be a real GPU; only false if it is sure that there is none.
pub(super) fn may_be_real() -> bool {
    if !cfg!(target_os = "linux") || SAID.iter().any(|name| var_os(name).is_some()) {
        return true;
    }
    may_be_among(&described(&folders(|name| var_os(name))), Path::new("/dev"))
}

/// Where the Vulkan loader looks for descriptions of drivers.
fn folders(variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let home = |inner: &str| variable("HOME").map(|home| PathBuf::from(home).join(inner).into_os_string());
    let or = |name: &str, otherwise: Option<OsString>| variable(name).filter(|v| !v.is_empty()).or(otherwise);
    let lists = [
        or("XDG_CONFIG_HOME", home(".config")),
        or("XDG_CONFIG_DIRS", Some("/etc/xdg".into())),
        Some("/etc:/usr/local/etc".into()),
        or("XDG_DATA_HOME", home(".local/share")),
        or("XDG_DATA_DIRS", Some("/usr/local/share:/usr/share".into())),
        Some("/usr/local/share:/usr/share".into()),
    ];
    let all = lists.iter().flatten().flat_map(std::env::split_paths);
    all.map(|folder| folder.join("vulkan/icd.d")).collect()
}

/// The descriptions in these folders; `None` of one that cannot be read.
fn described(folders: &[PathBuf]) -> Vec<Option<Value>> {
    let files = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten();
    let is_json = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "json");
    let files =
        files.map(|entry| entry.ok().map(|entry| entry.path())).filter(|path| path.as_ref().is_none_or(is_json));
    files.map(|path| serde_json::from_slice(&fs::read(path?).ok()?).ok()).collect()
}

/// Whether one of these drivers may have a GPU with what there is in that folder. Where none is found, they are kept
/// where nobody would look.
fn may_be_among(drivers: &[Option<Value>], devices: &Path) -> bool {
    let needed = |driver: &Option<Value>| {
        let library = driver.as_ref()?["ICD"]["library_path"].as_str()?;
        let name = Path::new(library).file_name()?.to_str()?;
        KNOWN.iter().find(|(part, _)| name.contains(part)).map(|(_, files)| *files)
    };
    let may_be = |driver| needed(driver).is_none_or(|files| files.iter().any(|file| devices.join(file).exists()));
    drivers.is_empty() || drivers.iter().any(may_be)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driver(library: &str) -> Option<Value> {
        Some(serde_json::json!({ "file_format_version": "1.0.0", "ICD": { "library_path": library } }))
    }

    #[test]
    fn only_known_drivers_without_their_device_are_passed_over() {
        let devices = tempfile::tempdir().unwrap();
        let may_be = |drivers: &[Option<Value>]| may_be_among(drivers, devices.path());
        let [lvp, radeon] = ["/usr/lib/libvulkan_lvp.so", "libvulkan_radeon.so"].map(driver);
        let mesa = [lvp.clone(), radeon.clone()];
        assert!(!may_be(&mesa) && !may_be(&[driver("./libvk_swiftshader.so")]));
        assert!(!may_be(&[driver("libGLX_nvidia.so.0")]));
        // Nothing found, nothing known, and what cannot be read: the drivers are asked.
        assert!(may_be(&[]) && may_be(&[lvp.clone(), driver("libnew_gpu.so")]) && may_be(&[lvp.clone(), None]));
        assert!(may_be(&[Some(Value::Null)]));
        fs::create_dir(devices.path().join("dri")).unwrap();
        assert!(may_be(&mesa) && !may_be(&[lvp]));
        assert!(may_be(&[driver("libGLX_nvidia.so.0")]));
    }

    #[test]
    fn drivers_are_looked_for_where_the_loader_does() {
        let none = folders(|_| None);
        let system = |folder: &str| none.contains(&Path::new(folder).join("vulkan/icd.d"));
        assert!(["/etc", "/etc/xdg", "/usr/share", "/usr/local/share"].into_iter().all(system));
        let said = folders(|name| match name {
            "HOME" => Some("/home/me".into()),
            "XDG_DATA_DIRS" => Some("/run/opengl-driver/share:/usr/share".into()),
            _ => None,
        });
        for folder in ["/home/me/.local/share", "/home/me/.config", "/run/opengl-driver/share"] {
            assert!(said.contains(&Path::new(folder).join("vulkan/icd.d")), "{folder}");
        }
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.json"), driver("libvulkan_lvp.so").unwrap().to_string()).unwrap();
        fs::write(folder.path().join("b.json"), "none").unwrap();
        fs::write(folder.path().join("c.txt"), "none").unwrap();
        let mut found = described(&[folder.path().to_owned(), folder.path().join("none")]);
        found.sort_by_key(Option::is_none);
        assert_eq!(found, [driver("libvulkan_lvp.so"), None]);
    }
}
