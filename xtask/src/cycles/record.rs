//! Runs of the emulator with the plugin `trace.c`: what is traced, and which sections are priced.

use super::maxima::Maxima;
use super::trace::{Image, Section, read};
use super::work::Work;
use crate::cores::COUNTED;
use crate::counts::Figure;
use crate::firmware;
use crate::run::{ChoreError, output_of, run, target_folder};
use crate::setup::{self, EMULATOR};
use crate::workspace;
use inference::BearingMaterial;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of inputs of every figure of the counting image.
const INPUTS: usize = 1000;
/// Exception number of SysTick.
const SYSTICK: usize = 15;
/// Arguments of the plugin for ticks in lockstep: they read the counter at the start, after the
/// estimate and after its frame. Every seventh tick is priced, and each that is longer than all
/// before it.
const TICKS: &str = "reads=3,keep=0-1000000/7,longest=1";
/// Arguments of the plugin for the handler. Handlers without a sample are left out, and so are
/// those after the commands that end the test.
const HANDLERS: &str = "min=2000,keep=0-8000/8,longest=1";
/// Test that samples the board's own sensors.
const OWN_SAMPLES: &str =
    "own_sensors::without_sensors_on_its_bus_it_estimates_on_time_and_reports_every_channel_as_missing";
/// Test with disturbed samples.
const TROUBLED: &str = "ticks::no_tick_exceeds_its_budget_whatever_the_samples";

/// Folder with the plugin, the traces, and a script that stands in for the emulator and adds the
/// plugin to its arguments.
pub(super) struct Runs {
    folder: PathBuf,
    emulator: PathBuf,
}

impl Runs {
    /// Compiles the plugin and finds the emulator.
    pub(super) fn prepare() -> Result<Self, ChoreError> {
        setup::setup()?;
        let folder = target_folder().join("cycles");
        let folder = std::path::absolute(&folder).unwrap_or(folder);
        let path = std::env::var_os("PATH").unwrap_or_default();
        let emulator =
            std::env::split_paths(&path).map(|folder| folder.join(EMULATOR)).find(|file| file.is_file());
        let emulator =
            emulator.ok_or_else(|| ChoreError::ByHand(format!("{EMULATOR} is not on the path")))?;
        let runs = Self { folder, emulator };
        std::fs::create_dir_all(runs.folder.join("bin")).map_err(|error| runs.wrong(error.to_string()))?;
        let source = crate::run::root().join("xtask/src/cycles/trace.c");
        run(Command::new("cc").args(["-O2", "-shared", "-fPIC", "-o"]).arg(runs.plugin()).arg(source))?;
        Ok(runs)
    }

    fn plugin(&self) -> PathBuf {
        self.folder.join("trace.so")
    }

    fn wrong(&self, found: String) -> ChoreError {
        ChoreError::File { file: self.folder.clone(), found, expected: "a folder for traces" }
    }

    /// Returns the argument that loads the plugin.
    fn argument(&self, arguments: &str) -> String {
        let [plugin, out] = [self.plugin(), self.folder.join("run")].map(|path| path.display().to_string());
        format!("{plugin},out={out},{arguments}")
    }

    /// Runs a command whose emulators load the plugin, and prices the sections that they record.
    fn trace(
        &self,
        command: &mut Command,
        arguments: &str,
        image: &Image,
        mut each: impl FnMut(&Section),
    ) -> Result<(), ChoreError> {
        self.remove_traces()?;
        let script = format!(
            "#!/bin/sh\nexec '{}' -plugin '{}' \"$@\"\n",
            self.emulator.display(),
            self.argument(arguments)
        );
        let bin = self.folder.join("bin");
        write_program(&bin.join(EMULATOR), &script).map_err(|error| self.wrong(error.to_string()))?;
        let path = std::env::var_os("PATH").unwrap_or_default();
        let path = std::env::join_paths(std::iter::once(bin).chain(std::env::split_paths(&path)));
        output_of(command.env("PATH", path.unwrap_or_else(|_| OsString::new())))?;
        let traces = self.traces()?;
        if traces.is_empty() {
            return Err(self.wrong("no trace".into()));
        }
        traces.iter().try_for_each(|trace| read(trace, image, &mut each))?;
        self.remove_traces()
    }

    fn traces(&self) -> Result<Vec<PathBuf>, ChoreError> {
        let entries = std::fs::read_dir(&self.folder).map_err(|error| self.wrong(error.to_string()))?;
        let paths = entries.flatten().map(|entry| entry.path());
        Ok(paths.filter(|path| path.extension().is_some_and(|name| name == "trace")).collect())
    }

    fn remove_traces(&self) -> Result<(), ChoreError> {
        let remove = |trace: &PathBuf| std::fs::remove_file(trace);
        self.traces()?.iter().try_for_each(remove).map_err(|error| self.wrong(error.to_string()))
    }

    /// Prices the ticks and the handler of the firmware.
    pub(super) fn controller(&self, maxima: &mut Maxima) -> Result<(), ChoreError> {
        let elf = firmware::DEFAULT.build()?;
        let image = Image::read(&elf)?;
        for bearing in BearingMaterial::ALL {
            maxima.set_weights(&weights(&elf, &image, bearing)?);
            let out = self.folder.join(bearing.name());
            let mut command = workspace::program("host-sim")?;
            command.args(["run", "--controller", "emulated", "--json", "--bearing", bearing.name(), "--out"]);
            command.arg(out);
            self.trace(&mut command, TICKS, &image, |section| maxima.add(Work::Tick, section))?;
        }
        // All bearings run in the test.
        let mut all = u32::MAX..0;
        for bearing in BearingMaterial::ALL {
            let own = weights(&elf, &image, bearing)?;
            all = all.start.min(own.start)..all.end.max(own.end);
        }
        maxima.set_weights(&all);
        let each = |section: &Section| maxima.add(Work::DisturbedTick, section);
        self.trace(&mut workspace::emulator_test(TROUBLED), TICKS, &image, each)?;
        let wrong = || ChoreError::File {
            file: elf.clone(),
            found: "no handler of SysTick".into(),
            expected: "a vector table",
        };
        let entry = image.handler(SYSTICK).ok_or_else(wrong)?;
        let arguments = format!("entry={entry},{HANDLERS}");
        let each = |section: &Section| maxima.add(Work::Handler, section);
        self.trace(&mut workspace::emulator_test(OWN_SAMPLES), &arguments, &image, each)
    }

    /// Prices the networks and the filter of the counting image.
    pub(super) fn counting(&self, maxima: &mut Maxima) -> Result<(), ChoreError> {
        let elf = COUNTED.build("count")?;
        let image = Image::read(&elf)?;
        let wrong = |found| ChoreError::File { file: elf.clone(), found, expected: "the counting image" };
        // The first section is the counter's own cost, then come the inputs of each figure.
        let output = COUNTED.run(&elf)?;
        let names: Vec<String> = output.lines().filter_map(Figure::parse).map(|(name, _)| name).collect();
        let first = |work: Work| -> Result<usize, ChoreError> {
            let at =
                names.iter().filter(|name| !name.ends_with("_bytes")).position(|name| name == work.name());
            Ok(1 + INPUTS * at.ok_or_else(|| wrong(format!("no `{}`", work.name())))?)
        };
        let mut works = vec![];
        let mut arguments = "reads=2,exit=1".to_owned();
        for (work, stride) in Work::COUNTING {
            let from = first(work)?;
            works.push((from..from + INPUTS, work));
            arguments += &format!(",keep={from}-{}/{stride}", from + INPUTS);
        }
        let traces = self.emulate(&elf, &arguments)?;
        let work_of = |section: &Section| {
            let is_within = |(range, _): &&(Range<usize>, Work)| range.contains(&(section.index as usize));
            works.iter().find(is_within).map(|(_, work)| *work)
        };
        let mut weights = None;
        for trace in &traces {
            read(trace, &image, |section| {
                if weights.is_none() && work_of(section) == Some(Work::ReferenceWindow) {
                    weights = constant_data(section);
                }
            })?;
        }
        maxima.set_weights(&weights.ok_or_else(|| wrong("no weights in the trace".into()))?);
        for trace in &traces {
            read(trace, &image, |section| {
                if let Some(work) = work_of(section) {
                    maxima.add(work, section);
                }
            })?;
        }
        self.remove_traces()
    }

    /// Prices an image between its first two reads of SysTick's counter.
    pub(super) fn image(&self, elf: &Path, maxima: &mut Maxima) -> Result<(), ChoreError> {
        let image = Image::read(elf)?;
        maxima.set_weights(&(0..0));
        for trace in self.emulate(elf, "reads=2,keep=0-1/1,exit=1")? {
            read(&trace, &image, |section| maxima.add(Work::Image, section))?;
        }
        self.remove_traces()
    }

    /// Runs an image that ends by itself, and returns its traces.
    fn emulate(&self, elf: &Path, arguments: &str) -> Result<Vec<PathBuf>, ChoreError> {
        self.remove_traces()?;
        COUNTED.run_with(elf, &["-plugin", &self.argument(arguments)])?;
        self.traces()
    }
}

/// Returns the addresses of a network's parameters: the largest block in RAM that a section reads
/// and does not write. The counting image draws its networks and holds them on its stack.
fn constant_data(section: &Section) -> Option<Range<u32>> {
    const WORD: u32 = 4;
    const RAM: Range<u32> = 0x2000_0000..0x2002_0000;
    let (mut read, mut written) = (BTreeSet::new(), BTreeSet::new());
    for access in section.steps.iter().flat_map(|step| section.accesses(step)) {
        let words = if access.is_store { &mut written } else { &mut read };
        words.extend(
            (access.address / WORD..=(access.address + access.bytes - 1) / WORD).map(|word| word * WORD),
        );
    }
    let constant = read.difference(&written).copied().filter(|address| RAM.contains(address));
    let mut blocks: Vec<Range<u32>> = vec![];
    for address in constant {
        match blocks.last_mut() {
            Some(block) if block.end == address => block.end += WORD,
            _ => blocks.push(address..address + WORD),
        }
    }
    blocks.into_iter().max_by_key(ExactSizeIterator::len)
}

/// Returns the addresses of a bearing's networks in an image.
fn weights(elf: &Path, image: &Image, bearing: BearingMaterial) -> Result<Range<u32>, ChoreError> {
    image.find(inference::shipped(bearing)).ok_or_else(|| ChoreError::File {
        file: elf.into(),
        found: format!("no networks for {}", bearing.name()),
        expected: "the networks that are shipped",
    })
}

/// Writes a program that can be executed.
fn write_program(path: &Path, text: &str) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::write(path, text)?;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
}

#[cfg(test)]
mod tests {
    use super::super::decode::Instruction;
    use super::super::trace::Access;
    use super::*;

    #[test]
    fn the_largest_block_that_is_only_read_is_a_networks_parameters() {
        let mut section = Section::default();
        section.push(0x0800_0000, Instruction::decode(0x6808, 0));
        let mut access = |addresses: Range<u32>, is_store| {
            for address in addresses.step_by(4) {
                section.push_access(Access { address, bytes: 4, is_store });
            }
        };
        // Constants in flash, inputs, parameters, results that are read again.
        access(0x0800_1000..0x0800_2000, false);
        access(0x2000_0000..0x2000_0020, false);
        access(0x2000_1000..0x2000_1100, false);
        access(0x2000_2000..0x2000_2200, true);
        access(0x2000_2000..0x2000_2200, false);
        assert_eq!(constant_data(&section), Some(0x2000_1000..0x2000_1100));
        assert_eq!(constant_data(&Section::default()), None);
    }
}
