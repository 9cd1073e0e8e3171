//! Effects of one sensor.

use super::{EffectKind, EffectParameter};
use crate::channel::Channel;
use crate::description::Bench;
use crate::sensor::Sensor;

macro_rules! sensor_effect {
    ($constant:ident, $name:literal, $summary:literal, $parameter:literal, $unit:literal, $scale:expr, $most:expr,
     |$sensor:ident, $value:ident| $body:expr) => {
        #[doc = $summary]
        pub(super) const $constant: EffectKind = EffectKind {
            name: $name,
            summary: $summary,
            per_channel: true,
            parameters: |_| {
                &[EffectParameter {
                    name: $parameter,
                    unit: $unit,
                    scale: $scale,
                    least: -$most,
                    most: $most,
                }]
            },
            apply: |bench, channel, parameter| {
                if let Some($sensor) = sensor(bench, channel) {
                    let $value = parameter($parameter);
                    $body;
                }
            },
        };
    };
}

sensor_effect!(
    OFFSET,
    "sensor-offset",
    "A sensor reads a constant too much.",
    "offset",
    "channel",
    1.0,
    1e12,
    |sensor, value| sensor.offset += value
);
sensor_effect!(
    GAIN,
    "sensor-gain",
    "A sensor's factor is off.",
    "relative_change",
    "1",
    0.01,
    0.99,
    |sensor, value| sensor.gain *= 1.0 + value
);
sensor_effect!(DELAY, "sensor-delay", "A sensor is late.", "delay_s", "s", 2e-4, 0.5, |sensor, value| {
    sensor.delay_s += value
});
sensor_effect!(
    DRIFT,
    "sensor-drift",
    "A sensor's offset drifts.",
    "drift_per_s",
    "channel/s",
    1.0,
    1e12,
    |sensor, value| sensor.drift_per_s += value
);

fn sensor(bench: &mut Bench, channel: Option<Channel>) -> Option<&mut Sensor> {
    let sensors = match bench {
        Bench::Transmission(bench) => &mut bench.sensors,
        Bench::FrictionRig(rig) => &mut rig.sensors,
    };
    Some(sensors.entry(channel?).or_default())
}
