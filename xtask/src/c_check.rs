//! Programs in C against the package of `model-quant generate c`: the same bits as Rust, on this
//! machine and on the emulated Cortex-M4.

use crate::c_library;
use crate::cores::COUNTED;
use crate::run::{ChoreError, output_of, root, run, succeeds, target_folder, write_atomically};
use crate::setup::{C_TOOLS, program};
use crate::workspace;
use inference::{BearingMaterial, ContactState, Estimate, Model, Pair, Sample, shipped};
use object::{Object, ObjectSymbol};
use on_target::noise::Noise;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of inputs; each goes through both bearings.
const INPUTS: usize = 1500;
/// Statuses of the wrong calls in `bits.c`, in its order.
const WRONG_CALLS: [i32; 7] = [1, 2, 26, 16, 20, 3, 1];

/// Builds the libraries and prints their folder, or checks them with programs in C.
pub(crate) fn build_or_check(is_checked: bool) -> Result<(), ChoreError> {
    if is_checked {
        check()?.iter().for_each(|what| println!("not compared or run: {what}"));
    } else {
        println!("{}", c_library::build()?.display());
    }
    Ok(())
}

/// Compares the programs and prints the size of the example. Returns what was skipped.
pub(crate) fn check() -> Result<Vec<String>, ChoreError> {
    crate::setup::setup()?;
    let [cmake, gcc] = C_TOOLS.map(|(name, packages)| match program(name, packages) {
        Ok(()) => None,
        Err(error) => Some(format!("{name}: {error}")),
    });
    if let Some(reason) = cmake {
        return Ok(vec![format!("programs in C: {reason}")]);
    }
    c_library::build()?;
    let folder = target_folder().join("c-check");
    let package = folder.join("package");
    run(workspace::program("model-quant")?.args(["generate", "c", "--out"]).arg(&package))?;
    let inputs = inputs();
    write_atomically(folder.join("inputs.h"), inputs_header(&inputs))?;
    let expected = expected(&inputs)?;
    let mut skipped = cpp(&package)?;

    let host = Programs::build(&folder, &package, "host", None)?;
    compare("bits on this machine", &output_of(&mut Command::new(&host.bits))?, &expected)?;
    let example = output_of(&mut Command::new(&host.example))?;
    println!("C on this machine: the same bits as Rust, {} estimates", 2 * INPUTS);
    if let Some(reason) = gcc {
        skipped.push(format!("programs in C on the emulated Cortex-M4: {reason}"));
        return Ok(skipped);
    }
    let target = Programs::build(&folder, &package, "target", Some("example/cortex-m4.cmake"))?;
    let text = COUNTED.run(&target.bits)?;
    let (estimates, stack) = text.split_once("stack ").unwrap_or((&text, ""));
    compare("bits on the emulated Cortex-M4", estimates, &expected)?;
    check_stack(stack)?;
    compare("example on the emulated Cortex-M4", &COUNTED.run(&target.example)?, &example)?;
    check_panics(&target.example)?;
    println!("C on the emulated Cortex-M4: the same bits; stack of a call {} bytes", stack.trim());
    print!("{}", output_of(Command::new("arm-none-eabi-size").arg(&target.example))?);
    Ok(skipped)
}

/// Programs that CMake has built.
struct Programs {
    bits: PathBuf,
    example: PathBuf,
}

impl Programs {
    /// Builds `bits.c` as a user of the package, and the package's example.
    fn build(
        folder: &Path,
        package: &Path,
        platform: &str,
        toolchain: Option<&str>,
    ) -> Result<Self, ChoreError> {
        let build = |name: &str, source: &Path| {
            let build = folder.join(platform).join(name);
            let mut configure = Command::new("cmake");
            configure.arg("-S").arg(source).arg("-B").arg(&build).arg("-DCMAKE_BUILD_TYPE=Release");
            configure.arg(format!("-DCMAKE_PREFIX_PATH={}", package.display()));
            configure.arg(format!("-DINPUTS={}", folder.display())).arg("--no-warn-unused-cli");
            if let Some(file) = toolchain {
                configure.arg(format!("-DCMAKE_TOOLCHAIN_FILE={}", package.join(file).display()));
            }
            output_of(&mut configure)?;
            output_of(Command::new("cmake").arg("--build").arg(&build))?;
            Ok(build.join(name))
        };
        Ok(Self {
            bits: build("bits", &root().join("crates/c-interface/tests"))?,
            example: build("example", &package.join("example"))?,
        })
    }
}

/// Compiles the headers as C++11.
fn cpp(package: &Path) -> Result<Vec<String>, ChoreError> {
    if !succeeds(Command::new("c++").arg("--version")) {
        return Ok(vec!["headers in C++: no c++".into()]);
    }
    let mut compiler = Command::new("c++");
    compiler.args(["-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-x", "c++"]);
    compiler.arg("-include").arg(package.join("include/pintle_model.h"));
    run(compiler.arg(package.join("include/pintle_image_babbitt.h")))?;
    Ok(vec![])
}

/// One call: the operation's place in [`OPERATIONS`] and its five words.
type Input = [u32; 6];
const OPERATIONS: [&str; 3] = ["PUSH", "STEP", "SKIP"];

/// Returns the inputs: samples in the training range, around it, and words of any bits.
fn inputs() -> Vec<Input> {
    let mut noise = Noise(7);
    let specials = [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e-45, 1.0];
    let mut inputs = Vec::new();
    for index in 0..INPUTS {
        // Uniform in -1 to 1.
        let mut share = || noise.within(1 << 20) as f32 / (1 << 20) as f32;
        let state = [
            0.6e-3 + 0.5e-3 * share(),
            20e-6 + 40e-6 * share(),
            0.02 * share(),
            0.02 * share().abs(),
            0.3 * share(),
        ];
        let mut words = state.map(f32::to_bits);
        let mut operation = 0;
        match index % 50 {
            // In integers, mostly in the training range.
            0..15 => {
                let units = [1e9_f32, 1e12, 1e9, 1e9, 1e9];
                words = core::array::from_fn(|i| ((state[i] * units[i]) as i32).cast_unsigned());
                operation = 1;
            }
            // Special values in one place.
            40..44 => {
                let special = specials[noise.bits() as usize % specials.len()];
                words[noise.bits() as usize % 5] = special.to_bits();
            }
            44..48 => words = words.map(|_| noise.bits() << 1 ^ noise.bits()),
            48 => {
                words = words.map(|_| noise.bits() << 1 ^ noise.bits());
                operation = 1;
            }
            49 => operation = 2,
            _ => {}
        }
        let [a, b, c, d, e] = words;
        inputs.push([operation, a, b, c, d, e]);
    }
    inputs
}

fn inputs_header(inputs: &[Input]) -> String {
    let mut text = format!("#include <stdint.h>\nenum {{ {} }};\n", OPERATIONS.join(", "));
    let _ = writeln!(text, "#define COUNT {}\nstatic const uint32_t inputs[COUNT][6] = {{", inputs.len());
    for words in inputs {
        let words = words.map(|word| format!("{word}u"));
        let _ = writeln!(text, "    {{{}}},", words.join(", "));
    }
    text + "};\n"
}

/// Returns the output of `bits.c` but for its stack, computed with the crate `inference`.
fn expected(inputs: &[Input]) -> Result<String, ChoreError> {
    let mut text = String::new();
    let mut line = |words: &[u32]| {
        for word in words {
            let _ = write!(text, "{}:{} ", word >> 16, word & 0xffff);
        }
        text.push('\n');
    };
    for bearing in BearingMaterial::ALL {
        let model = Model::load(shipped(bearing)).map_err(|error| ChoreError::ByHand(error.to_string()))?;
        let (header, id) = (model.header(), model.header().training_id);
        let force = header.normal_force_n().high;
        line(&[
            model.checksum(),
            id as u32,
            (id >> 32) as u32,
            force.to_bits(),
            header.latch_floor_m_s().to_bits(),
        ]);
        let mut pair: Pair<'_> = Pair::new(model);
        for input in inputs {
            let Estimate { normal_force_mn, friction_force_mn, flags, saturated, .. } =
                estimate(&mut pair, input);
            let newtons = |force: i32| (force as f32 / 1000.0).to_bits();
            let fields = [normal_force_mn.cast_unsigned(), friction_force_mn.cast_unsigned(), flags.bits()];
            line(
                &[
                    &[newtons(normal_force_mn), newtons(friction_force_mn)],
                    &fields[..],
                    &[u32::from(saturated)],
                ]
                .concat(),
            );
        }
    }
    for status in WRONG_CALLS {
        let _ = writeln!(text, "{status}");
    }
    Ok(text + "done\n")
}

fn estimate(pair: &mut Pair<'_>, input: &Input) -> Estimate {
    let [operation, words @ ..] = *input;
    match operation {
        0 => {
            let [clearance, deformation, rate, approach, sliding] = words.map(f32::from_bits);
            pair.push(&ContactState {
                radial_clearance_m: clearance,
                deformation_m: deformation,
                deformation_rate_m_s: rate,
                approach_speed_m_s: approach,
                sliding_speed_m_s: sliding,
            })
        }
        1 => {
            let [clearance, deformation, rate, approach, sliding] = words;
            pair.step(&Sample {
                radial_clearance_nm: clearance,
                deformation_pm: deformation.cast_signed(),
                deformation_rate_nm_s: rate.cast_signed(),
                approach_speed_nm_s: approach,
                sliding_speed_nm_s: sliding.cast_signed(),
            })
        }
        _ => pair.skip(),
    }
}

/// Compares two outputs and names the first line that differs.
fn compare(what: &str, found: &str, expected: &str) -> Result<(), ChoreError> {
    if found == expected {
        return Ok(());
    }
    let equal = found.lines().zip(expected.lines()).take_while(|(found, expected)| found == expected).count();
    let line = |text: &str| text.lines().nth(equal).unwrap_or("the end").to_owned();
    Err(ChoreError::Differs {
        what: format!("{what}, line {}", equal + 1),
        found: line(found),
        expected: line(expected),
    })
}

/// Compares the stack of a call with the header's `PINTLE_MODEL_STACK`: at most that, and not much
/// less.
fn check_stack(found: &str) -> Result<(), ChoreError> {
    let file = root().join("crates/c-interface/include/pintle_model.h");
    let text = std::fs::read_to_string(&file).unwrap_or_default();
    let value = |line: &str| line.strip_prefix("#define PINTLE_MODEL_STACK ")?.parse::<u32>().ok();
    let limit = text.lines().find_map(value);
    let found: Option<u32> = found.trim().parse().ok();
    match (found, limit) {
        (Some(found), Some(limit)) if found <= limit && limit - found < limit / 4 => Ok(()),
        _ => Err(ChoreError::Differs {
            what: "stack of a call on the Cortex-M4".into(),
            found: format!("{found:?}"),
            expected: format!("at most PINTLE_MODEL_STACK, {limit:?}, and more than 3/4 of it"),
        }),
    }
}

/// Rejects a program from which a panic can be reached.
fn check_panics(program: &Path) -> Result<(), ChoreError> {
    let wrong = |found: String| ChoreError::File {
        file: program.into(),
        found,
        expected: "a program that cannot panic",
    };
    let bytes = std::fs::read(program).map_err(|error| wrong(error.to_string()))?;
    let image = object::File::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
    let mut names = image.symbols().filter_map(|symbol| symbol.name().ok());
    match names.find(|name| name.contains("panic") || name.contains("rust_begin_unwind")) {
        Some(name) => Err(wrong(format!("the symbol {name}"))),
        None => Ok(()),
    }
}
