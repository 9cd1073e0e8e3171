//! The drivers against scripted buses: what goes over the wire, and what is made of every answer.

mod absolute;
mod converter;
mod incremental;
mod sampler;
mod script;
