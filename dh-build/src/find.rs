//! Where a table's name leads: macro, build scripts and command line.

use super::read::read;
use super::{FindError, Source};
use std::path::{Path, PathBuf};

/// A file has this ending; a name without it is a shipped table's.
const ENDING: &str = "toml";

/// Shipped names at least this similar (of 1) are proposed, the nearest few.
const SIMILAR: f64 = 0.6;
const PROPOSED: usize = 3;

impl Source {
    /// A table named in `#[dh_robot("...")]`: with `.toml` a file beside the source file, else in the crate's root,
    /// else in its `robots/` folder; without, a shipped table.
    ///
    /// # Errors
    /// The places tried and the nearest shipped names, or why the file found there cannot be used.
    pub fn for_macro(
        name: &str,
        source_file: Option<&Path>,
        crate_root: Option<&Path>,
    ) -> Result<Source, FindError> {
        let beside = source_file.and_then(Path::parent).map(Path::to_path_buf);
        let folders = [beside, crate_root.map(Path::to_path_buf), crate_root.map(|root| root.join("robots"))];
        in_folders(name, folders.into_iter().flatten(), crate_root)
    }

    /// A table named in a build script: with `.toml` a file in the crate's root, else in its `robots/` folder;
    /// without, a shipped table.
    ///
    /// # Errors
    /// As [`Source::for_macro`].
    pub fn for_build_script(name: &str, crate_root: &Path) -> Result<Source, FindError> {
        in_folders(name, [crate_root.to_path_buf(), crate_root.join("robots")].into_iter(), Some(crate_root))
    }

    /// A table named on the command line: a file (whatever its ending), else a shipped table.
    ///
    /// # Errors
    /// As [`Source::for_macro`].
    pub fn for_command_line(name: &str) -> Result<Source, FindError> {
        let path = Path::new(name);
        if let Some(text) = read(path, name)? {
            return Ok(Source { name_shown: name.to_owned(), path: Some(absolute(path)), text });
        }
        let mut source = shipped(name);
        if let Err(FindError::NotFound { tried, .. }) = &mut source {
            tried.push(name.to_owned());
        }
        source
    }
}

/// A file in the first folder that has it, or a shipped table.
fn in_folders(
    name: &str,
    folders: impl Iterator<Item = PathBuf>,
    crate_root: Option<&Path>,
) -> Result<Source, FindError> {
    if !is_file_name(name) {
        return shipped(name);
    }
    let mut tried = Vec::new();
    let mut seen = Vec::new();
    for folder in folders {
        let path = absolute(&folder.join(name));
        if seen.contains(&path) {
            continue;
        }
        let shown = shown(&path, name, crate_root);
        if let Some(text) = read(&path, &shown)? {
            return Ok(Source { name_shown: shown, path: Some(path), text });
        }
        if !tried.contains(&shown) {
            tried.push(shown);
        }
        seen.push(path);
    }
    let nearest = nearest(name);
    Err(FindError::NotFound { name: name.to_owned(), tried, shipped: false, nearest })
}

fn is_file_name(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending.eq_ignore_ascii_case(ENDING))
}

/// A shipped table.
fn shipped(name: &str) -> Result<Source, FindError> {
    match dh_robots::table(name) {
        Some(text) => Ok(Source { name_shown: name.to_owned(), path: None, text: text.to_owned() }),
        None => Err(FindError::NotFound {
            name: name.to_owned(),
            tried: Vec::new(),
            shipped: true,
            nearest: nearest(name),
        }),
    }
}

/// Shipped names similar to this one, nearest first.
fn nearest(name: &str) -> Vec<String> {
    let stem =
        Path::new(name).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().to_lowercase());
    let similarity = |shipped: &str| strsim::jaro_winkler(&stem, shipped);
    let mut similar: Vec<(f64, &str)> = dh_robots::names()
        .map(|shipped| (similarity(shipped), shipped))
        .filter(|(similarity, _)| *similarity >= SIMILAR)
        .collect();
    similar.sort_by(|(left, _), (right, _)| right.total_cmp(left));
    similar.into_iter().take(PROPOSED).map(|(_, shipped)| shipped.to_owned()).collect()
}

/// A path in the crate from its root, so that messages are the same on every machine; else what the user wrote.
fn shown(path: &Path, name: &str, crate_root: Option<&Path>) -> String {
    let inside = crate_root.and_then(|root| path.strip_prefix(absolute(root)).ok());
    match inside {
        Some(inside) if !Path::new(name).is_absolute() => inside.to_string_lossy().replace('\\', "/"),
        _ => name.to_owned(),
    }
}

/// The path from the root of the file system, where the working directory is known.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}
