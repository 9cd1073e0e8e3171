//! Text of an inspection of logs.

pub(crate) mod text;
