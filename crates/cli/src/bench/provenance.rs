//! Where and when the numbers come from.

use std::fs;
use std::process::Command;
use std::time::SystemTime;

use core_affinity::CoreId;

/// What a reader needs to know to repeat a measurement.
#[derive(Clone, Debug)]
pub(super) struct Provenance {
    /// Names and values.
    pub(super) facts: Vec<(&'static str, String)>,
    /// All cores that this process may use.
    pub(super) cores: Vec<CoreId>,
}

impl Provenance {
    /// Also binds this thread to one core, the last one, where the system allows it.
    pub(super) fn of_this_run() -> Self {
        let cores = core_affinity::get_core_ids().unwrap_or_default();
        let pinned = cores.last().is_some_and(|core| core_affinity::set_for_current(*core));
        let thread = if pinned { "one, pinned; batches on more" } else { "one, not pinned" };
        let facts = vec![
            ("date", humantime::format_rfc3339_seconds(SystemTime::now()).to_string()),
            ("command", command()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("commit", commit().unwrap_or_else(|| "unknown".into())),
            ("build", build()),
            ("processor", processor().unwrap_or_else(|| "unknown".into())),
            ("cores", cores.len().to_string()),
            ("threads", thread.to_owned()),
            ("system", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
            ("load before", load().unwrap_or_else(|| "unknown".into())),
        ];
        Self { facts, cores }
    }
}

fn command() -> String {
    let mut words = std::env::args();
    let program = words.next().unwrap_or_default();
    let name = program.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    std::iter::once(name).chain(words).collect::<Vec<_>>().join(" ")
}

fn build() -> String {
    if cfg!(debug_assertions) { "with debug assertions".into() } else { "release".into() }
}

/// Of the working folder, if that is a checkout; marked where it has changes.
fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let hash = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed = !git(&["status", "--porcelain", "--untracked-files=no"])?.is_empty();
    Some(if changed { format!("{hash} with changes") } else { hash })
}

fn processor() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Processes ready to run, over 1, 5 and 15 minutes.
fn load() -> Option<String> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    Some(text.split(' ').take(3).collect::<Vec<_>>().join(", "))
}
