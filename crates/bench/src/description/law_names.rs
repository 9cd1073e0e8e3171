//! Names of the law catalogue in a description.

use crate::schema::{FieldKind, FieldType};
use contact::{CompleteLawKind, Damping, Dissipation, FrictionKind, StiffnessKind};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

macro_rules! catalogue_names {
    ($($(#[$meta:meta])* $name:ident($kind:ty) $group:literal;)*) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $name(pub $kind);

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.0.entry().name)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = String::deserialize(deserializer)?;
                <$kind>::from_name(&text).map(Self).ok_or_else(|| {
                    let known: Vec<&str> = <$kind>::ALL.iter().map(|k| k.entry().name).collect();
                    D::Error::custom(format!(
                        concat!("found ", $group, " `{}`; expected one of {}"), text, known.join(", ")
                    ))
                })
            }
        }

        impl FieldType for $name {
            const KIND: FieldKind =
                FieldKind::Name(|| <$kind>::ALL.iter().map(|k| k.entry().name).collect());

            fn text(&self) -> String {
                self.0.entry().name.into()
            }
        }
    )*};
}

catalogue_names! {
    /// Stiffness part by name.
    StiffnessName(StiffnessKind) "stiffness";
    /// Dissipation factor by name.
    DissipationName(Dissipation) "dissipation";
    /// Normal law with its own damping, by name.
    CompleteLawName(CompleteLawKind) "law";
    /// Friction law by name.
    FrictionName(FrictionKind) "friction law";
}

/// Reference of the deformation rate, by name: `latched`, `bounded` or `reference`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DampingName(&'static str);

impl DampingName {
    /// Returns the damping with its floor or reference speed.
    pub fn damping(self, speed_m_s: f64) -> Damping {
        Damping::from_name(self.0, speed_m_s).unwrap_or(Damping::Latched { floor_m_s: speed_m_s })
    }

    /// Returns whether this is the form of the literature.
    pub(crate) fn is_latched(&self) -> bool {
        *self == Self::default()
    }
}

impl Default for DampingName {
    fn default() -> Self {
        Self(Damping::<f64>::NAMES[0])
    }
}

impl FieldType for DampingName {
    const KIND: FieldKind = FieldKind::Name(|| Damping::<f64>::NAMES.to_vec());

    fn text(&self) -> String {
        self.0.into()
    }
}

impl Serialize for DampingName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0)
    }
}

impl<'de> Deserialize<'de> for DampingName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let known = Damping::<f64>::NAMES;
        known.into_iter().find(|name| *name == text).map(Self).ok_or_else(|| {
            D::Error::custom(format!("found damping `{text}`; expected one of {}", known.join(", ")))
        })
    }
}
