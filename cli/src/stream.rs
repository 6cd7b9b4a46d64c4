//! Lines of JSON in, lines of JSON out, in constant memory.

use crate::failure::{Refusal, Status};
use crate::json::Json;
use std::io::{self, BufRead, BufReader, Write};

/// A line may have so many bytes; no input of ours needs them.
const LONGEST_LINE: usize = 1 << 16;

/// Answers every line of stdin with one line: `answer` says what is wrong with a line that is malformed.
///
/// What is written is kept back only as long as there is more to read without waiting.
pub(crate) fn run(
    out: &mut dyn Write,
    mut answer: impl FnMut(&[u8]) -> Result<Json, Refusal>,
) -> io::Result<Status> {
    let mut input = BufReader::with_capacity(1 << 16, io::stdin().lock());
    let mut line = Vec::new();
    let mut status = Status::Done;
    while let Some(fits) = read_line(&mut input, &mut line, out)? {
        let answer = if fits { answer(&line) } else { Err(too_long()) };
        match answer {
            Ok(json) => writeln!(out, "{json}")?,
            Err(refusal) => {
                status = Status::Wrong;
                writeln!(out, "{}", refusal.answer())?;
            }
        }
    }
    Ok(status)
}

/// The next line without its end, and whether it fits; `None` at the end of the input.
fn read_line<R: io::Read>(
    input: &mut BufReader<R>,
    line: &mut Vec<u8>,
    out: &mut dyn Write,
) -> io::Result<Option<bool>> {
    line.clear();
    let (mut fits, mut begun) = (true, false);
    loop {
        if input.buffer().is_empty() {
            out.flush()?;
        }
        let bytes = match input.fill_buf() {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        if bytes.is_empty() {
            return Ok(begun.then_some(fits));
        }
        begun = true;
        let end = bytes.iter().position(|byte| *byte == b'\n');
        let part = bytes.get(..end.unwrap_or(bytes.len())).unwrap_or_default();
        fits &= line.len() + part.len() <= LONGEST_LINE;
        if fits {
            line.extend_from_slice(part);
        }
        let used = part.len() + usize::from(end.is_some());
        input.consume(used);
        if end.is_some() {
            return Ok(Some(fits));
        }
    }
}

fn too_long() -> Refusal {
    malformed(format!("the line has more than {LONGEST_LINE} bytes"))
}

/// A line that is not what it should be.
pub(crate) fn malformed(message: impl Into<String>) -> Refusal {
    Refusal::new("malformed", message)
}
