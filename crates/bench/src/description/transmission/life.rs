//! Life of the bearing: wear, temperature, water, lubricant film; used by `host-sim life`.

use crate::schema::section;

section! {
    /// Wear by Archard's law: depth per pressure and sliding distance. Without the section its
    /// defaults hold. The run of a bench does not use it.
    WearSection {
        /// Specific wear rate of the lining. Default: that of the material against steel. Plastic
        /// 6.2e-15: Orkot TLM Marine, 10 MPa, 1 m/min, in water (Trelleborg 2021). Babbitt, dry,
        /// 6e-14: Archard's coefficient 1.5e-5 (Rabinowicz 1981) over a hardness of 250 MPa. 1e-15
        /// m3/(N m) are 1e-6 mm3/(N m).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        specific_wear_rate_m3_nm: Option<f64> [0.0, 1e-6, "m3/(N m)"],
        /// Specific wear rate of the journal.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        journal_wear_rate_m3_nm: f64 [0.0, 1e-6, "m3/(N m)"],
        /// Factor by which both rates may be larger or smaller (95 %): rates of one material differ
        /// between rigs and surfaces by 3 to 10.
        #[serde(default = "three")]
        factor: f64 [1.0, 1e3],
        /// Thickness of the lining. Default: 0.04 of the shaft's diameter and 2 mm (Trelleborg,
        /// Orkot Marine Bearings, engineering manual).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lining_thickness_m: Option<f64> [1e-5, 1.0],
    }
}
section! {
    /// Change of the clearance by temperature and water in `host-sim life`. The run of a bench does
    /// not use it.
    ThermalSection {
        /// Temperature of housing, lining and shaft above that at which the clearance is described.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        ambient_rise_k: f64 [-200.0, 1000.0],
        /// Further rise of lining and shaft per friction power.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        thermal_resistance_k_w: f64 [0.0, 1e3, "K/W"],
        /// Linear expansion of the shaft; steel 12e-6.
        #[serde(default = "steel")]
        shaft_expansion_per_k: f64 [-1e-3, 1e-2, "1/K"],
        /// Linear expansion of the housing.
        #[serde(default = "steel")]
        housing_expansion_per_k: f64 [-1e-3, 1e-2, "1/K"],
        /// Linear expansion of the lining. Default: Babbitt 23e-6, plastic 90e-6.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lining_expansion_per_k: Option<f64> [-1e-3, 1e-2, "1/K"],
        /// Relative growth of the lining's thickness when it is saturated with water; laminates
        /// below 0.001, polyamides some 0.02.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        swelling: f64 [0.0, 0.5],
        /// Diffusivity of water in the lining; without it the lining is saturated from the start.
        /// Polyamides some 1e-12 at 23 degrees Celsius.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        diffusivity_m2_s: Option<f64> [1e-18, 1e-3, "m2/s"],
    }
}
section! {
    /// Lubricant film in series with the dry contact in `host-sim life`: it carries a part of the
    /// force that then does not wear. The run of a bench does not use it.
    FilmSection {
        /// Viscosity: water 1e-3 at 20 degrees Celsius; grease: that of its base oil, 0.05 to 1.
        viscosity_pa_s: f64 [1e-6, 1e4, "Pa s"],
        /// Film thickness at which the surfaces touch: some three times the roughness of both.
        #[serde(default = "five_micrometres")]
        min_film_m: f64 [1e-8, 1e-3],
    }
}
section! {
    /// Life in `host-sim life`. Without the section its defaults hold.
    LifeSection {
        /// Cycles of the drive.
        #[serde(default = "million")]
        cycles: f64 [1.0, 1e12],
        /// Radial clearance that ends the life. Default: twice the described one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        limit_clearance_m: Option<f64> [1e-9, 10.0],
        /// Cycles of each run before those that count.
        #[serde(default = "two")]
        settling_cycles: u32 [0.0, 1000.0],
        /// Cycles of each run that count: more for a random course.
        #[serde(default = "four")]
        duty_cycles: u32 [1.0, 1000.0],
        /// Largest wear of a cell in a jump as a share of the described clearance; the error of a
        /// jump is at most a tenth of that.
        #[serde(default = "jump_share")]
        jump_share: f64 [1e-5, 0.5],
    }
}

fn three() -> f64 {
    3.0
}

fn steel() -> f64 {
    12e-6
}

fn five_micrometres() -> f64 {
    5e-6
}

fn million() -> f64 {
    1e6
}

fn two() -> u32 {
    2
}

fn four() -> u32 {
    4
}

fn jump_share() -> f64 {
    0.02
}

impl Default for WearSection {
    fn default() -> Self {
        Self {
            specific_wear_rate_m3_nm: None,
            journal_wear_rate_m3_nm: 0.0,
            factor: three(),
            lining_thickness_m: None,
        }
    }
}

impl Default for LifeSection {
    fn default() -> Self {
        Self {
            cycles: million(),
            limit_clearance_m: None,
            settling_cycles: two(),
            duty_cycles: four(),
            jump_share: jump_share(),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Bench, PRESETS};

    fn error(sections: &str) -> String {
        let (_, text) = PRESETS[0];
        let bench = Bench::parse("x", &text.replace("[logging]", &format!("{sections}\n[logging]")));
        bench.map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn wear_and_life_out_of_range_are_refused_with_their_field() {
        let found = error("[life]\nlimit_clearance_m = 1e-4");
        assert!(found.contains("life.limit_clearance_m is 1e-4; expected 5e-4 to 0.007"), "{found}");
        let found = error("[wear]\nfactor = 0.5");
        assert!(found.contains("wear.factor is 0.5; expected 1 to 1000"), "{found}");
        let found = error("[film]\nmin_film_m = 1e-6");
        assert!(found.contains("viscosity_pa_s"), "{found}");
        let found = error("[film]\nviscosity_pa_s = 1.0\nmin_film_m = 1e-3");
        assert!(found.contains("film.min_film_m is 0.001; expected 1e-8 to 2.5e-4"), "{found}");
    }
}
