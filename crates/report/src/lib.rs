#![doc = include_str!("../README.md")]

pub mod axis;
mod chart;
pub mod figure;
pub mod heat;
pub mod page;
mod plot;
mod scheme;
pub mod script_page;
mod text_table;

pub use text_table::text_table;
