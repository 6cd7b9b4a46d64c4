//! The attribute on structs of all kinds, with tables beside the source.

mod names;
mod structs;
