//! Changes one equation of the bench at a time: each leaves a residual in the energy balance, as no
//! term is the remainder of the others.

use super::bearing::OnShaft;
use super::{STATES, State, Transmission};
use crate::description::TransmissionBench;
use crate::integrate::{ContactAngles, ContactPlant, ContactReading, Touch, integrate};
use crate::plants::energy::EnergyAudit;
use contact::BearingMaterial;

/// Residual of the unchanged equations at a tolerance of 1e-7, relative to the drive's work.
const BOUND: f64 = 1e-8;

/// The bench with a change of the bearing's action on the shaft and one of the state's rates.
struct Changed<'a> {
    plant: &'a Transmission,
    action: fn(&mut OnShaft),
    rates: fn(&mut State),
}

impl ContactPlant<STATES> for Changed<'_> {
    fn derivative(&self, time_s: f64, state: &State, touch: Option<Touch>, out: &mut State) {
        let g = self.plant.geometry(time_s, state);
        let forces = touch.map(|touch| self.plant.forces_at(time_s, state, &g, touch)).unwrap_or_default();
        let mut bearing = self.plant.on_shaft_at(&g, &forces);
        (self.action)(&mut bearing);
        self.plant.motion::<true>(time_s, state, &g, touch.is_some(), &bearing, out);
        (self.rates)(out);
    }

    fn deformation(&self, time_s: f64, state: &State) -> (f64, f64) {
        self.plant.deformation(time_s, state)
    }

    fn contact(&self, time_s: f64, state: &State, latched_m_s: f64) -> ContactReading {
        self.plant.contact(time_s, state, latched_m_s)
    }

    fn angles(&self, time_s: f64, state: &State) -> ContactAngles {
        self.plant.angles(time_s, state)
    }
}

fn audit(plant: &Transmission, action: fn(&mut OnShaft), rates: fn(&mut State)) -> EnergyAudit {
    let changed = Changed { plant, action, rates };
    let initial = plant.initial_state(0.0);
    let tolerances = plant.tolerances(1e-7);
    let run = integrate(&changed, (0.0, 1.0), initial, false, &[], &tolerances, |_, _, _| {}).unwrap();
    plant.audit((0.0, &initial), (1.0, &run.state))
}

type Change = (&'static str, fn(&mut OnShaft), fn(&mut State));

#[test]
fn every_equation_that_is_changed_alone_leaves_a_residual() {
    let changes: [Change; 12] = [
        ("normal force along Y", |b| b.force_y_n *= 1.01, |_| {}),
        ("normal force along Z", |b| b.force_z_n *= 1.1, |_| {}),
        ("friction torque", |b| b.torque_nm *= 0.5, |_| {}),
        ("friction of the heat", |b| b.friction_n *= 0.5, |_| {}),
        ("normal force of the damping", |b| b.normal_n *= 1.01, |_| {}),
        ("acceleration along Y", |_| {}, |out| out[2] *= 1.01),
        ("weight", |_| {}, |out| out[3] -= 1.0),
        ("work of the drive", |_| {}, |out| out[6] *= 1.01),
        ("work of the load", |_| {}, |out| out[8] *= 1.01),
        ("heat of the friction", |_| {}, |out| out[9] *= 0.5),
        ("loss of the damping", |_| {}, |out| out[10] *= 0.9),
        ("heat of the load cylinder", |_| {}, |out| out[11] *= 0.9),
    ];
    for material in BearingMaterial::ALL {
        let mut bench = TransmissionBench::open("bench-b").unwrap();
        bench.set_material(material);
        bench.load_friction = Some(crate::description::LoadFriction {
            coulomb_n: 400.0,
            viscous_n_s_m: 1000.0,
            regularisation_m_s: 1e-3,
        });
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let right = audit(&plant, |_| {}, |_| {});
        assert!(right.residual_rel < BOUND, "{material:?}: {right:?}");
        for (name, action, rates) in changes {
            let found = audit(&plant, action, rates);
            assert!(found.residual_rel > 10.0 * BOUND, "{material:?}, {name}: {found:?}");
        }
    }
}

/// A term that is wrong in the audit alone shows as its own difference.
#[test]
fn a_wrong_term_does_not_move_the_others() {
    let bench = TransmissionBench::open("bench-b").unwrap();
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let right = audit(&plant, |_| {}, |_| {});
    let wrong = audit(&plant, |b| b.friction_n *= 0.5, |_| {});
    assert!((wrong.friction_heat_j / right.friction_heat_j - 0.5).abs() < 1e-9, "{wrong:?}");
    assert_eq!(wrong.damping_loss_j, right.damping_loss_j);
    assert!((wrong.residual_j - 0.5 * right.friction_heat_j).abs() < 1e-3, "{wrong:?}");
}
