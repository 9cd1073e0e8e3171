//! Sensors of a world: noise, delay and lost readings.

use crate::random::Random;
use crate::row::Row;

/// Properties of the sensors. Noise is one standard deviation of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Noise of the journal's position probes.
    pub position_m: f64,
    /// Noise of the shaft's angle sensor.
    pub angle_rad: f64,
    /// Noise of the load cell.
    pub load_force_n: f64,
    /// Noise of the drive's force sensor.
    pub drive_force_n: f64,
    /// Correlation of all noise from reading to reading, 0 (white) to below 1.
    pub noise_correlation: f64,
    /// Delay of the position probes.
    pub position_delay_s: f64,
    /// Share of the readings that each channel loses; the last good one replaces a lost one.
    pub lost_share: f64,
}

/// Readings of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time.
    pub time_s: f64,
    /// Journal centre along Y.
    pub journal_y_m: f64,
    /// Journal centre along Z.
    pub journal_z_m: f64,
    /// Shaft angle.
    pub shaft_angle_rad: f64,
    /// Load along +Y.
    pub load_force_n: f64,
    /// Force of the fork on the shaft along +Y.
    pub drive_force_n: f64,
}

impl Sensors {
    /// Sensors of bench B: white noise, no delay, no lost reading.
    pub const BENCH_B: Self = Self {
        position_m: 0.2e-6,
        angle_rad: 20e-6,
        load_force_n: 0.5,
        drive_force_n: 20.0,
        noise_correlation: 0.0,
        position_delay_s: 0.0,
        lost_share: 0.0,
    };

    /// Reads every row. A channel's noise depends on the seed and the channel only.
    pub fn read(&self, rows: &[Row], seed: u64) -> Vec<Reading> {
        let channel = |name: &str, truth: fn(&Row) -> f64, noise: f64, delay_s: f64| {
            let mut channel = Channel::new(self, name, seed, noise);
            let late = delayed(rows, truth, delay_s);
            late.map(|value| channel.read(value)).collect::<Vec<f64>>()
        };
        let delay_s = self.position_delay_s;
        let y = channel("journal-y", |r| r.journal_y_m, self.position_m, delay_s);
        let z = channel("journal-z", |r| r.journal_z_m, self.position_m, delay_s);
        let angle = channel("shaft-angle", |r| r.shaft_angle_rad, self.angle_rad, 0.0);
        let load = channel("load-force", |r| r.load_force_n, self.load_force_n, 0.0);
        let drive = channel("drive-force", |r| r.drive_force_n, self.drive_force_n, 0.0);
        let reading = |(index, row): (usize, &Row)| Reading {
            time_s: row.time_s,
            journal_y_m: y[index],
            journal_z_m: z[index],
            shaft_angle_rad: angle[index],
            load_force_n: load[index],
            drive_force_n: drive[index],
        };
        rows.iter().enumerate().map(reading).collect()
    }
}

/// Returns the values of a time ago, interpolated between the rows.
fn delayed(rows: &[Row], truth: fn(&Row) -> f64, delay_s: f64) -> impl Iterator<Item = f64> {
    let step_s = rows.get(1).map_or(1.0, |second| second.time_s - rows[0].time_s);
    let (late, share) = ((delay_s / step_s).floor() as usize, (delay_s / step_s).fract());
    let value = move |index: usize, late: usize| truth(&rows[index.saturating_sub(late)]);
    (0..rows.len()).map(move |i| (1.0 - share) * value(i, late) + share * value(i, late + 1))
}

/// One channel while it is read.
struct Channel {
    noise: f64,
    correlation: f64,
    lost_share: f64,
    random: Random,
    losses: Random,
    /// Noise of the last reading, in standard deviations.
    state: f64,
    last: Option<f64>,
}

impl Channel {
    fn new(sensors: &Sensors, name: &str, seed: u64, noise: f64) -> Self {
        let mut random = Random::new(seed, name);
        let state = random.normal();
        let losses = Random::new(seed, &format!("{name}-lost"));
        let Sensors { noise_correlation: correlation, lost_share, .. } = *sensors;
        Self { noise, correlation, lost_share, random, losses, state, last: None }
    }

    fn read(&mut self, truth: f64) -> f64 {
        let fresh = (1.0 - self.correlation * self.correlation).sqrt();
        self.state = self.correlation * self.state + fresh * self.random.normal();
        let is_lost = self.losses.uniform() < self.lost_share;
        let value = self.last.filter(|_| is_lost).unwrap_or(truth + self.noise * self.state);
        self.last = Some(value);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Vec<Row> {
        let row = |index: u32| Row {
            time_s: f64::from(index) * 1e-4,
            journal_y_m: f64::from(index) * 1e-6,
            drive_force_n: 1000.0,
            ..Row::default()
        };
        (0..50_000).map(row).collect()
    }

    fn spread_and_correlation(off: &[f64]) -> (f64, f64) {
        let variance = off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64;
        let next = off.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / off.len() as f64;
        (variance.sqrt(), next / variance)
    }

    #[test]
    fn noise_has_its_deviation_and_its_correlation() {
        let rows = ramp();
        for correlation in [0.0, 0.9] {
            let sensors = Sensors { noise_correlation: correlation, ..Sensors::BENCH_B };
            let readings = sensors.read(&rows, 1);
            let off: [fn(&Reading, &Row) -> f64; 5] = [
                |m, r| (m.journal_y_m - r.journal_y_m) / Sensors::BENCH_B.position_m,
                |m, r| (m.journal_z_m - r.journal_z_m) / Sensors::BENCH_B.position_m,
                |m, r| (m.shaft_angle_rad - r.shaft_angle_rad) / Sensors::BENCH_B.angle_rad,
                |m, r| (m.load_force_n - r.load_force_n) / Sensors::BENCH_B.load_force_n,
                |m, r| (m.drive_force_n - r.drive_force_n) / Sensors::BENCH_B.drive_force_n,
            ];
            let off = off.map(|off| readings.iter().zip(&rows).map(|(m, r)| off(m, r)).collect::<Vec<_>>());
            for off in &off {
                let (spread, next) = spread_and_correlation(off);
                assert!((spread - 1.0).abs() < 0.05, "{correlation}: {spread}");
                assert!((next - correlation).abs() < 0.02, "{correlation}: {next}");
            }
            let across = off[0].iter().zip(&off[1]).map(|(a, b)| a * b).sum::<f64>() / rows.len() as f64;
            assert!(across.abs() < 0.1, "{correlation}: {across} between two channels");
        }
        let read = |seed| Sensors::BENCH_B.read(&rows, seed);
        assert_eq!(read(4), read(4));
        assert_ne!(read(4), read(5));
    }

    #[test]
    fn a_delay_is_that_of_the_position_probes_and_may_be_part_of_a_sample() {
        let silent = Sensors { position_m: 0.0, drive_force_n: 0.0, ..Sensors::BENCH_B };
        let readings = Sensors { position_delay_s: 2.5e-4, ..silent }.read(&ramp(), 1);
        assert!((readings[100].journal_y_m - 97.5e-6).abs() < 1e-12);
        assert_eq!(readings[0].journal_y_m, 0.0);
        assert_eq!(readings[100].drive_force_n, 1000.0);
    }

    #[test]
    fn a_lost_reading_repeats_the_last_one_and_changes_no_other() {
        let (rows, some) = (ramp(), Sensors { lost_share: 0.05, ..Sensors::BENCH_B });
        let (good, some) = (Sensors::BENCH_B.read(&rows, 2), some.read(&rows, 2));
        let mut lost = 0;
        for index in 1..rows.len() {
            if some[index].journal_y_m != good[index].journal_y_m {
                assert_eq!(some[index].journal_y_m, some[index - 1].journal_y_m);
                lost += 1;
            }
        }
        assert!((2300..2700).contains(&lost), "{lost}");
    }
}
