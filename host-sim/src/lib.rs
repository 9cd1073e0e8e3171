#![doc = include_str!("../README.md")]

#[macro_use]
#[path = "cli/say.rs"]
mod say;

pub mod accuracy;
pub mod cli;
pub mod commands;
mod compare;
pub mod controller;
pub mod device;
mod diagnose;
mod evaluate;
pub mod flash;
mod fmu;
mod impact_text;
mod inspect;
pub mod journal;
mod life;
mod live;
mod logs;
pub mod program;
pub mod replay;
pub mod reproduction;
pub mod run;
pub mod serve;
pub mod shard;
pub mod sweep;
mod validation;
pub mod watch;
