//! Run with a unit of another program as the plant: it moves the journal, and takes the force of
//! the bearing if it has inputs for that.

use super::plant_unit::{PlantUnit, QUANTITIES, WITH_RATE};
use crate::cli::error::CliError;
use crate::run::force::{ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::run::networks::{Networks, Readings};
use bench::description::TransmissionBench;
use bench::integrate::ContactAngles;
use bench::plants::transmission::{
    BearingForces, ContactView, JointContact, JointMemory, JointMotion, Snapshot,
};
use bench::signals::Motion;
use bench::simulate::Run;
use bench::simulate::peaks::Extremes;
use bench::simulate::stepped::HeldContact;
use inference::Flags;
use pintle_fmu::{ImportedVariable, Slave};

impl PlantUnit {
    /// Runs the unit over the described duration in steps of `step_s`, with the contact of a
    /// resolved description.
    pub(crate) fn run(
        &self,
        bench: &TransmissionBench,
        source: ForceSource,
        step_s: f64,
        mut tick: impl FnMut(),
    ) -> Result<ForcedRun, CliError> {
        let contact = self.check(bench, step_s)?;
        let has_networks = matches!(source, ForceSource::FloatNet | ForceSource::QuantisedNet);
        let networks = has_networks.then(|| Networks::new(source, bench.bearing.material));
        let (mut networks, mut readings) = (networks.transpose()?, Readings::default());
        let started = std::time::Instant::now();
        let start: Vec<(&ImportedVariable, f64)> = self.start.iter().map(|(v, value)| (v, *value)).collect();
        let mut slave = Slave::start(&self.import, &start, 0.0)?;
        let (samples_s, end_s) = (bench.sample_times_s(SAMPLE_RATE_HZ), bench.duration_s());
        let count = (end_s / step_s).round() as usize;
        let every = (count / 100).max(1);
        let (mut memory, mut held) = (JointMemory::default(), HeldContact::default());
        let (mut samples, mut impacts, mut extremes) = (Vec::new(), Vec::new(), Extremes::default());
        let mut before = None;
        for step in 0..count {
            if step % every == 0 {
                tick();
            }
            let time_s = step as f64 * step_s;
            let values = self.read(&mut slave, before, step_s)?;
            before = Some(values);
            let motion = motion(&values).after(0.5 * step_s);
            let mut view = contact.view(&motion, &memory);
            let angles = || ContactAngles { crank_rad: values[2], contact_rad: values[1].atan2(values[0]) };
            impacts.extend(held.switch(time_s, &mut view, angles));
            memory.latched_m_s = (view.deformation_m > 0.0).then_some(held.latched_m_s());
            let reading = match &mut networks {
                Some(networks) => networks.push(&view),
                None => {
                    contact.check_deformation(&view)?;
                    let law = contact.law(&view, &memory);
                    ([law.normal_n, law.friction_n], Flags::NONE)
                }
            };
            let forces = readings.count(&view, reading);
            held.measure((time_s, step_s), &view, forces.normal_n);
            let (force_n, torque_nm) = contact.on_journal(&motion, &forces);
            for (variable, value) in self.forces.iter().zip([force_n[0], force_n[1], torque_nm]) {
                if let Some(variable) = variable {
                    slave.set(variable, value)?;
                }
            }
            let snapshot = snapshot(time_s, &values, (view, forces), (force_n, torque_nm));
            extremes.update(&snapshot);
            while samples_s.get(samples.len()).is_some_and(|&t| t < time_s + 0.5 * step_s) {
                samples.push(snapshot);
            }
            slave.step(step_s)?;
            contact.advance(&mut memory, &view, step_s);
        }
        impacts.extend(held.impact);
        let peaks = extremes.to_peaks([None, None]);
        let losses_j = vec![[0.0; 3]; samples.len()];
        let run = Run {
            samples,
            impacts,
            energy_residual_rel: 0.0,
            energy: Default::default(),
            losses_j,
            steps: count,
            extremes: Some(extremes),
        };
        Ok(ForcedRun {
            wall_s: started.elapsed().as_secs_f64(),
            peaks,
            outside_training_share: readings.outside_share(),
            without_contact_n: readings.without_contact_n,
            plant: Some(self.figures()),
            ..ForcedRun::from_run(run)
        })
    }

    /// Contact of a description that a unit can move, with a step that the unit can take.
    fn check(&self, bench: &TransmissionBench, step_s: f64) -> Result<JointContact, CliError> {
        let refuse = |field: &str, found: &str, expected: &str| {
            Err(CliError::Input(format!("{field}: found {found}; expected {expected} with --plant-fmu")))
        };
        if bench.two_plane.is_some() {
            return refuse("two_plane", "a section", "a planar bench");
        }
        if bench.servo.is_some() {
            return refuse("servo", "a section", "none: the unit moves the drive");
        }
        if let Some(own_s) = self.import.internal_step_s().filter(|own_s| *own_s > 0.0) {
            let count = (step_s / own_s).round();
            if count < 1.0 || (count * own_s - step_s).abs() > 1e-9 * step_s {
                let expected = format!("a multiple of {}, the unit's internal step,", own_s * 1e6);
                return refuse("--step-us", &format!("{}", step_s * 1e6), &expected);
            }
        }
        match JointContact::new(bench) {
            Some(contact) => Ok(contact),
            None => refuse("friction.law", "one that sticks", "one without sticking"),
        }
    }

    /// Quantities at the present time. Missing rates are those since the step before.
    fn read(
        &self,
        slave: &mut Slave,
        before: Option<[f64; QUANTITIES.len()]>,
        step_s: f64,
    ) -> Result<[f64; QUANTITIES.len()], CliError> {
        let (mut values, mut stack) = ([0.0; QUANTITIES.len()], Vec::new());
        for (value, expression) in values.iter_mut().zip(&self.quantities) {
            let Some(expression) = expression else { continue };
            let mut readings = Vec::with_capacity(expression.columns.len());
            for column in &expression.columns {
                readings.push(match self.read.get(*column) {
                    Some(variable) => slave.get(variable)?,
                    None => f64::NAN,
                });
            }
            *value = expression.value(&readings, &mut stack);
        }
        for (i, before) in before.iter().flatten().take(WITH_RATE).enumerate() {
            if self.quantities[WITH_RATE + i].is_none() {
                values[WITH_RATE + i] = (values[i] - before) / step_s;
            }
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(i) => Err(CliError::Work(format!("the unit's {} is not finite", QUANTITIES[i]))),
            None => Ok(values),
        }
    }
}

fn motion(values: &[f64; QUANTITIES.len()]) -> JointMotion {
    JointMotion {
        offset_m: [values[0], values[1]],
        velocity_m_s: [values[4], values[5]],
        speed_rad_s: values[6],
    }
}

fn snapshot(
    time_s: f64,
    values: &[f64; QUANTITIES.len()],
    (contact, forces): (ContactView, BearingForces),
    ([force_y_n, force_z_n], friction_torque_nm): ([f64; 2], f64),
) -> Snapshot {
    let [y_m, z_m, angle_rad, displacement_m, _, _, speed_rad_s, velocity_m_s, load_force_n, drive_force_n] =
        *values;
    Snapshot {
        time_s,
        angle_rad,
        speed_rad_s,
        y_m,
        z_m,
        contact,
        forces,
        force_y_n,
        force_z_n,
        friction_torque_nm,
        drive_force_n,
        load_force_n,
        drive: Motion { value: displacement_m, rate: velocity_m_s, acceleration: 0.0 },
    }
}
