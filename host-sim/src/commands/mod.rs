//! The commands, one file each: arguments, a call into the library, output.

pub mod accuracy;
pub mod check;
pub mod claims;
pub mod compare;
pub mod completions;
pub mod describe;
pub mod diagnose;
pub mod evaluate;
pub mod export_fmu;
pub mod figures;
pub mod flash;
pub mod laws;
pub mod life;
pub mod link;
pub mod log;
pub mod manual;
pub mod record;
pub mod replay;
pub mod run;
pub mod schema;
pub mod sweep;
pub mod update;
pub mod validate;
