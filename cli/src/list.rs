//! Lists of numbers on the command line: `-12.08,0,1e-3`.

use std::str::FromStr;

/// Numbers with commas between them. They may be infinite or NaN: what they are for says whether that will do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct List(pub(crate) Vec<f64>);

impl FromStr for List {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| {
            part.trim().parse().map_err(|_| {
                format!("`{}` is not a number; write numbers with commas between them", part.trim())
            })
        };
        text.split(',').map(number).collect::<Result<_, _>>().map(List)
    }
}
