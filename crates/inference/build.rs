//! Decides whether the target has the DSP instructions, which stable Rust does not expose.
//!
//! `thumbv7em` always has them. `thumbv8m.main` has them on every Cortex-M33, M35P, M55 and M85
//! built with the option; there the feature `dsp` enables them.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(pintle_dsp)");
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_default();
    let asked = std::env::var_os("CARGO_FEATURE_DSP").is_some() && target.starts_with("thumbv8m.main");
    if target.starts_with("thumbv7em") || asked {
        println!("cargo::rustc-cfg=pintle_dsp");
    }
}
