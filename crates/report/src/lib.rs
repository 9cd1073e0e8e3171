#![doc = include_str!("../README.md")]

pub mod axis;
pub mod figure;
pub mod heat;
pub mod page;
