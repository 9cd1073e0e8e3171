//! Scales of a TDMS channel: chains of linear and polynomial scales from the stored numbers to
//! physical values. They are properties of a channel, or of its group or file for all channels.

use super::objects::{Properties, Property};

/// Input of a scale that reads the stored numbers.
const STORED: u32 = u32::MAX;
/// Maximum number of scales and of coefficients.
const MAX_COUNT: u32 = 64;

/// Polynomial by its coefficients, the constant first.
type Polynomial = Vec<f64>;

/// Scales in the order in which they are applied.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Scales(Vec<Polynomial>);

impl Scales {
    /// Scales of an object; `None` if its properties define none.
    ///
    /// # Errors
    ///
    /// The reason why a scale cannot be applied.
    pub(super) fn from_properties(properties: &Properties) -> Option<Result<Self, String>> {
        let count = number(properties, "NI_Number_Of_Scales").filter(|count| *count > 0)?;
        if matches!(properties.get("NI_Scaling_Status"), Some(Property::Text(status)) if status == "scaled") {
            return Some(Ok(Self::default()));
        }
        Some(Self::chain(properties, count))
    }

    /// Follows the inputs from the last of `count` scales to the stored numbers.
    fn chain(properties: &Properties, count: u32) -> Result<Self, String> {
        if count > MAX_COUNT {
            return Err(format!("{count} scales, more than {MAX_COUNT}"));
        }
        let (mut polynomials, mut index) = (Vec::new(), count - 1);
        loop {
            let text = |name: &str| format!("NI_Scale[{index}]_{name}");
            let kind = match properties.get(&text("Scale_Type")) {
                Some(Property::Text(kind)) => kind.as_str(),
                // The scale of a measuring card is not described: it is the stored number.
                _ => break,
            };
            let need = |name: &str| match properties.get(&text(name)) {
                Some(Property::Number(value)) if value.is_finite() => Ok(*value),
                _ => Err(format!("a scale without `{}`", text(name))),
            };
            match kind {
                "Linear" => polynomials.push(vec![need("Linear_Y_Intercept")?, need("Linear_Slope")?]),
                "Polynomial" => {
                    let size = number(properties, &text("Polynomial_Coefficients_Size")).unwrap_or(4);
                    let term = |i| need(&format!("Polynomial_Coefficients[{i}]"));
                    polynomials.push((0..size.min(MAX_COUNT)).map(term).collect::<Result<_, _>>()?);
                }
                "AdvancedAPI" => {}
                other => return Err(format!("a scale of the type `{other}`")),
            }
            let input = number(properties, &text(&format!("{kind}_Input_Source"))).unwrap_or(STORED);
            if input == STORED {
                break;
            }
            if input >= index {
                return Err(format!("scale {index} with the input {input}"));
            }
            index = input;
        }
        polynomials.reverse();
        Ok(Self(polynomials))
    }

    /// Physical value of a stored number.
    pub(super) fn value(&self, stored: f64) -> f64 {
        let apply = |x: f64, p: &Polynomial| p.iter().rev().fold(0.0, |sum, c| sum * x + c);
        self.0.iter().fold(stored, apply)
    }
}

/// Integer of a property.
fn number(properties: &Properties, name: &str) -> Option<u32> {
    match properties.get(name) {
        Some(Property::Number(value)) if (0.0..=f64::from(u32::MAX)).contains(value) => Some(*value as u32),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn properties(items: &[(&str, Property)]) -> Properties {
        items.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
    }

    fn text(value: &str) -> Property {
        Property::Text(value.into())
    }

    #[test]
    fn scales_are_applied_from_the_stored_number_to_the_last_one() {
        let mut items = vec![
            ("NI_Number_Of_Scales", Property::Number(2.0)),
            ("NI_Scale[0]_Scale_Type", text("Polynomial")),
            ("NI_Scale[0]_Polynomial_Coefficients_Size", Property::Number(3.0)),
            ("NI_Scale[0]_Polynomial_Coefficients[0]", Property::Number(1.0)),
            ("NI_Scale[0]_Polynomial_Coefficients[1]", Property::Number(2.0)),
            ("NI_Scale[0]_Polynomial_Coefficients[2]", Property::Number(3.0)),
            ("NI_Scale[1]_Scale_Type", text("Linear")),
            ("NI_Scale[1]_Linear_Slope", Property::Number(10.0)),
            ("NI_Scale[1]_Linear_Y_Intercept", Property::Number(-5.0)),
            ("NI_Scale[1]_Linear_Input_Source", Property::Number(0.0)),
        ];
        let scales = Scales::from_properties(&properties(&items)).unwrap().unwrap();
        assert_eq!(scales.value(2.0), 10.0 * (1.0 + 4.0 + 12.0) - 5.0);
        items.push(("NI_Scaling_Status", text("scaled")));
        assert_eq!(Scales::from_properties(&properties(&items)), Some(Ok(Scales::default())));
        assert_eq!(Scales::from_properties(&properties(&[])), None);
    }

    #[test]
    fn a_scale_that_cannot_be_applied_is_refused_with_its_reason() {
        let refused =
            |items: &[(&str, Property)]| Scales::from_properties(&properties(items)).unwrap().unwrap_err();
        let one = ("NI_Number_Of_Scales", Property::Number(1.0));
        let thermocouple = refused(&[one.clone(), ("NI_Scale[0]_Scale_Type", text("Thermocouple"))]);
        assert_eq!(thermocouple, "a scale of the type `Thermocouple`");
        let linear = ("NI_Scale[0]_Scale_Type", text("Linear"));
        let lacking = refused(&[one.clone(), linear.clone()]);
        assert_eq!(lacking, "a scale without `NI_Scale[0]_Linear_Y_Intercept`");
        let circle = refused(&[
            one,
            linear,
            ("NI_Scale[0]_Linear_Slope", Property::Number(1.0)),
            ("NI_Scale[0]_Linear_Y_Intercept", Property::Number(0.0)),
            ("NI_Scale[0]_Linear_Input_Source", Property::Number(0.0)),
        ]);
        assert_eq!(circle, "scale 0 with the input 0");
        assert!(refused(&[("NI_Number_Of_Scales", Property::Number(1e9))]).contains("more than 64"));
    }
}
