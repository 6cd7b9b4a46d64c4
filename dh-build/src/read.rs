//! Reading a file that may be anything.

use super::FindError;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// The most bytes that a table may have.
pub const MAX_BYTES: usize = 256 * 1024;

/// The text of a file; `None` where there is none of that name.
pub(crate) fn read(path: &Path, shown: &str) -> Result<Option<String>, FindError> {
    let unreadable =
        |error: &std::io::Error| FindError::Unreadable { name: shown.to_owned(), reason: error.to_string() };
    if path.is_dir() {
        return Ok(None);
    }
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(None);
        }
        Err(error) => return Err(unreadable(&error)),
    };
    // One byte more than allowed tells a file that is too large, however large it is or if it never ends.
    let mut bytes = Vec::new();
    file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    if bytes.len() > MAX_BYTES {
        return Err(FindError::TooLarge { name: shown.to_owned() });
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Some(text)),
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            let before =
                String::from_utf8_lossy(error.as_bytes().get(..valid).unwrap_or_default()).into_owned();
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
            Err(FindError::NotUtf8 { name: shown.to_owned(), line, column })
        }
    }
}
