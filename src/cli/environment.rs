//! What the process's surroundings need before anything else starts.

/// Keeps Mesa's Vulkan layer that sorts devices by window system from complaining on stderr where there is none.
///
/// Adapters are chosen by what they are here, so the layer has nothing to add. Must be called before any thread starts.
#[allow(unsafe_code)] // the environment can be changed in no other way
pub(crate) fn quieten_vulkan() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread runs yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Has a file that would grow beyond the limit of its size (`ulimit -f`) fail to be written, as on a full disk. By
/// default the process would be killed with its files half written.
#[cfg(unix)]
#[allow(unsafe_code)] // signals are ignored in no other way
pub(crate) fn outlive_size_limits() {
    // SAFETY: no code runs when an ignored signal comes.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Elsewhere there is no such signal.
#[cfg(not(unix))]
pub(crate) fn outlive_size_limits() {}
