//! The configuration on the controller: checked as a whole ([`validate`]), kept as a record ([`record`]).

mod bench_b;
pub mod record;
mod validate;

pub use bench_b::BENCH_B;
pub use validate::validate;
