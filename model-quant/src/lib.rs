#![doc = include_str!("../README.md")]

pub mod cli;
pub mod data;
pub mod evaluate;
pub mod exchange;
pub mod network;
pub mod quantise;
pub mod report;
pub mod train;
