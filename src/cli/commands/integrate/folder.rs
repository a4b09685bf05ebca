//! The folder in which a program looks for the user's extensions.

use super::host::Host;
use crate::cli::failure::Failure;
use etcetera::BaseStrategy;
use std::path::{Path, PathBuf};

/// Name of the folder of vtex. GIMP requires the name of the plug-in's file.
pub(crate) const OWN: &str = "vtex";

/// The folder of vtex among the user's extensions. It need not exist.
///
/// # Errors
/// If the user has no home folder.
pub(crate) fn usual_folder(host: Host) -> Result<PathBuf, Failure> {
    let extensions = match host {
        Host::Inkscape => inkscape_profile()?.join("extensions"),
        Host::Gimp => gimp_profile()?.join("plug-ins"),
    };
    Ok(extensions.join(OWN))
}

fn inkscape_profile() -> Result<PathBuf, Failure> {
    if let Some(folder) = named_by("INKSCAPE_PROFILE_DIR") {
        return Ok(folder);
    }
    let on_macos = "org.inkscape.Inkscape/config/inkscape";
    Ok(settings()?.join(if cfg!(target_os = "macos") { on_macos } else { "inkscape" }))
}

fn gimp_profile() -> Result<PathBuf, Failure> {
    if let Some(folder) = named_by("GIMP3_DIRECTORY") {
        return Ok(folder);
    }
    let all = settings()?.join("GIMP");
    let newest = newest_minor(&all).unwrap_or(0);
    Ok(all.join(format!("3.{newest}")))
}

/// The newest GIMP 3 that has a folder of settings: 2 of GIMP 3.2.
fn newest_minor(all: &Path) -> Option<u32> {
    let entries = std::fs::read_dir(all).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.strip_prefix("3.")?.parse::<u32>().ok()).max()
}

fn named_by(variable: &str) -> Option<PathBuf> {
    std::env::var_os(variable).filter(|folder| !folder.is_empty()).map(PathBuf::from)
}

/// The folder of all programs' settings.
fn settings() -> Result<PathBuf, Failure> {
    let strategy = etcetera::choose_base_strategy().map_err(|_| {
        Failure::failed("there is no folder for the user's settings").hint("name a folder with --folder")
    })?;
    let on_macos = strategy.home_dir().join("Library").join("Application Support");
    Ok(if cfg!(target_os = "macos") { on_macos } else { strategy.config_dir() })
}
