#![doc = include_str!("../README.md")]

mod import;
mod instance;
mod interface;
mod model;
mod networks;
mod package;
mod parameters;
mod simulator;
mod units;
mod variable;
mod xml;

pub use import::{Import, ImportError, ImportedVariable, Slave};
pub use model::{Kind, Model};
pub use networks::{aligned, contact_state};
pub use package::{Library, Platform, pack};
pub use variable::{Causality, Type, Variable};
pub use xml::Version;
