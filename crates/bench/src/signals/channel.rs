//! Signals of a measured log: names with units, inputs and outputs.

use crate::schema::{FieldKind, FieldType};
use core::fmt;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

macro_rules! channels {
    ($($variant:ident $name:literal $unit:literal $role:ident $doc:literal;)*) => {
        /// Signal of a measured log.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[derive(JsonSchema, Serialize, Deserialize)]
        pub enum Channel { $(#[doc = $doc] #[serde(rename = $name)] $variant,)* }

        impl Channel {
            /// Every channel, in the order of a log's columns.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];
            /// Header name, unit included.
            pub const fn name(self) -> &'static str { match self { $(Self::$variant => $name,)* } }
            /// Unit alone.
            pub const fn unit(self) -> &'static str { match self { $(Self::$variant => $unit,)* } }
            /// Meaning, one sentence.
            pub const fn meaning(self) -> &'static str { match self { $(Self::$variant => $doc,)* } }
            /// Role of the channel in a comparison with a simulation.
            pub const fn role(self) -> Role { match self { $(Self::$variant => Role::$role,)* } }
        }
    };
}

/// Role of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Drives the simulation.
    Input,
    /// Is compared with the simulation.
    Output,
}

channels! {
    DriveDisplacement "drive_displacement_m" "m" Input "Displacement of the drive cylinder along Y.";
    DriveVelocity "drive_velocity_m_s" "m/s" Input "Velocity of the drive cylinder along Y.";
    SpindleAngle "spindle_angle_rad" "rad" Input "Angle of the friction rig's spindle.";
    SpindleSpeed "spindle_speed_rad_s" "rad/s" Input "Speed of the friction rig's spindle.";
    Position "position_m" "m" Input "Position of a linear axis.";
    Velocity "velocity_m_s" "m/s" Input "Velocity of a linear axis.";
    OrderedAngle "ordered_angle_rad" "rad" Input "Ordered angle of a spindle in closed loop.";
    OrderedPosition "ordered_position_m" "m" Input "Ordered position of a linear axis in closed loop.";
    DriveVoltage "drive_voltage_v" "V" Input "Voltage at the amplifier of an axis' drive.";
    LoadForce "load_force_n" "N" Input "Force of the load cylinder.";
    ShaftAngle "shaft_angle_rad" "rad" Output "Angle of the shaft.";
    ShaftSpeed "shaft_speed_rad_s" "rad/s" Output "Speed of the shaft.";
    JournalY "journal_y_m" "m" Output "Journal centre from the bearing's centre along Y.";
    JournalZ "journal_z_m" "m" Output "Journal centre from the bearing's centre along Z, upwards.";
    BearingForceY "bearing_force_y_n" "N" Output "Whole force of the bearing on the journal along Y.";
    BearingForceZ "bearing_force_z_n" "N" Output "Whole force of the bearing on the journal along Z.";
    FrictionTorque "friction_torque_nm" "N m" Output "Torque of the bearing on the shaft.";
    DriveForce "drive_force_n" "N" Output "Force of the fork on the shaft along +Y; effort of a linear axis.";
    DriveTorque "drive_torque_nm" "N m" Output "Effort of the friction rig's spindle.";
    BearingTemperature "bearing_temperature_c" "degC" Output "Temperature of the bearing.";
}

impl Channel {
    /// Returns the channel with a header name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|c| c.name() == name)
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FieldType for Channel {
    const KIND: FieldKind = FieldKind::Name(|| Self::ALL.iter().map(|channel| channel.name()).collect());

    fn text(&self) -> String {
        self.name().into()
    }
}
