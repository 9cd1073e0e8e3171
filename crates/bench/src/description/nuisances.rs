//! Per-log nuisance parameters: `[nuisances]` of a description.
//!
//! Each log has its own value of every declared nuisance, drawn from a normal distribution around 0
//! with the declared standard deviation. A diagnosis estimates it together with the uncertain
//! parameters, for that log alone.
//!
//! | key | unit | meaning |
//! | --- | --- | --- |
//! | `temperature_start_k` | K, 0 to 1000 | temperature rise at the first sample |
//! | `offset.<channel>` | the channel's, 0 to 1e12 | constant added to an output's readings |
//! | `delay_s.<channel>` | s, 0 to 10 | delay of an output's clock relative to the inputs |
//!
//! Inputs have none: their errors would change the whole simulation.

use super::Refusal;
use crate::schema::{FieldKind, FieldType, section};
use crate::signals::{Channel, Role};
use std::collections::BTreeMap;

section! {
    /// Standard deviations of per-log parameters; 0 or absent: none.
    #[derive(Default)]
    Nuisances {
        /// Bearing temperature above ambient at a log's first sample.
        #[serde(default, skip_serializing_if = "super::is_zero")]
        temperature_start_k: f64 [0.0, 1e3],
        /// Constant added to the readings of an output.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        offset: BTreeMap<Channel, f64> [0.0, 1e12, "the channel's"],
        /// Delay of an output's clock after that of the inputs.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        delay_s: BTreeMap<Channel, f64> [0.0, 10.0],
    }
}

impl FieldType for BTreeMap<Channel, f64> {
    const KIND: FieldKind = FieldKind::NumberPerChannel;

    fn text(&self) -> String {
        String::new()
    }
}

impl Nuisances {
    /// Returns whether nothing is declared.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the declarations of inputs, which are not allowed.
    pub(crate) fn refusals(&self, role: impl Fn(Channel) -> Role) -> Vec<Refusal> {
        let tables = [("offset", &self.offset), ("delay_s", &self.delay_s)];
        let of_channels =
            tables.into_iter().flat_map(|(table, values)| values.keys().map(move |c| (table, c)));
        let expected = "an output, which is compared with the simulation, such as drive_force_n";
        of_channels
            .filter(|(_, channel)| role(**channel) == Role::Input)
            .map(|(table, c)| (format!("nuisances.{table}.{c}"), "of an input".into(), expected.into()))
            .collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
mod tests {
    use crate::{Bench, PRESETS};

    fn parsed(table: &str) -> Result<Bench, String> {
        let (_, text) = PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap();
        Bench::parse("x.toml", &format!("{text}\n{table}")).map_err(|e| e.to_string())
    }

    #[test]
    fn nuisances_are_read_written_and_absent_unless_declared() {
        let bench = parsed(
            "[nuisances]\ntemperature_start_k = 5.0\n[nuisances.offset]\ndrive_torque_nm = 0.5\n\
             [nuisances.delay_s]\ndrive_torque_nm = 2e-3\n",
        )
        .unwrap();
        let declared = bench.nuisances();
        assert_eq!(declared.temperature_start_k, 5.0);
        assert_eq!(
            declared.offset.values().chain(declared.delay_s.values()).collect::<Vec<_>>(),
            [&0.5, &2e-3]
        );
        assert_eq!(Bench::parse("again", &bench.to_toml().unwrap()).unwrap(), bench);
        for (name, _) in PRESETS {
            let preset = Bench::open(name).unwrap();
            assert!(
                preset.nuisances().is_empty() && !preset.to_toml().unwrap().contains("nuisances"),
                "{name}"
            );
        }
    }

    #[test]
    fn refusals_name_the_field_the_content_found_and_the_content_expected() {
        for (table, expected) in [
            (
                "[nuisances]\ntemperature_start_k = -1.0",
                "nuisances.temperature_start_k is -1; expected 0 to 1000 K",
            ),
            (
                "[nuisances]\nhumidity = 1.0",
                "nuisances.humidity is an unknown field; expected one of temperature_start_k,",
            ),
            (
                "[nuisances.offset]\ndrive_torque_nm = -0.5",
                "nuisances.offset.drive_torque_nm is -0.5; expected",
            ),
            (
                "[nuisances.offset]\ntorque = 0.5",
                "nuisances.offset.torque is an unknown channel; expected one of",
            ),
            (
                "[nuisances.offset]\nload_force_n = 9.0",
                "nuisances.offset.load_force_n is of an input; expected an output",
            ),
            (
                "[nuisances.delay_s]\ndrive_torque_nm = nan",
                "nuisances.delay_s.drive_torque_nm is NaN; expected",
            ),
            ("[nuisances.delay_s]\ndrive_torque_nm = 11.0", "is 11; expected 0 to 10 s"),
        ] {
            let error = parsed(table).unwrap_err();
            assert!(error.starts_with("x.toml") && error.contains(expected), "{error}");
        }
    }
}
