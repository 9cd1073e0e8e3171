//! The two networks of a bearing on arrays, with the code of the controller.

use crate::arrays::{Numbers, columns};
use crate::error::input;
use inference::{BearingMaterial, ContactState, Flags, Range, WINDOW, shipped};
use model_quant::quantise::image::{AlignedImage, AnyModel, AnyPair};
use numpy::PyArray1;
use pyo3::types::PyBytes;
use pyo3::{Bound, PyResult, Python, pyclass, pymethods};

/// Finds a bearing material by its name.
pub(crate) fn material(name: &str) -> PyResult<BearingMaterial> {
    let known = BearingMaterial::ALL.map(BearingMaterial::name).join("`, `");
    BearingMaterial::from_name(name)
        .ok_or_else(|| input(format!("material: found `{name}`; expected one of `{known}`")))
}

/// Networks of a model image.
#[pyclass(module = "pintle", frozen)]
pub(crate) struct Networks {
    image: AlignedImage,
}

/// Normal force, friction force and whether the state is outside the training range.
type Forces<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);

#[pymethods]
impl Networks {
    /// Checks a model image.
    #[new]
    fn new(image: &[u8]) -> PyResult<Self> {
        let image = AlignedImage::copy(image);
        AnyModel::load(&image).map_err(|error| input(format!("model image: {error}")))?;
        Ok(Self { image })
    }

    /// Networks that the package contains for a bearing material.
    #[staticmethod]
    fn shipped(material: &str) -> PyResult<Self> {
        Ok(Self { image: AlignedImage::copy(shipped(self::material(material)?)) })
    }

    /// The model image.
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.image)
    }

    /// Bearing material.
    #[getter]
    fn material(&self) -> PyResult<&'static str> {
        Ok(self.model()?.header().bearing.name())
    }

    /// Ranges of the training in SI units, lowest and highest value by name.
    #[getter]
    fn ranges(&self) -> PyResult<Vec<(&'static str, (f32, f32))>> {
        let header = self.model()?.header();
        let range = |range: Range| (range.low, range.high);
        Ok(vec![
            ("radial_clearance_m", range(header.radial_clearance_m())),
            ("deformation_m", range(header.deformation_m())),
            ("rate_ratio", range(header.rate_ratio())),
            ("sliding_m_s", range(header.sliding_speed_m_s())),
            ("normal_force_n", range(header.normal_force_n())),
        ])
    }

    /// Evaluates both networks: clearance and deformation in m, rate, approach and sliding speed in
    /// m/s. The rows are consecutive samples if `is_series`; else each stands for itself, after a
    /// history of the same state. A state that is not finite has no force and is outside.
    #[allow(clippy::too_many_arguments)]
    fn forces<'py>(
        &self,
        py: Python<'py>,
        radial_clearance_m: Numbers<'_>,
        deformation_m: Numbers<'_>,
        rate_m_s: Numbers<'_>,
        approach_m_s: Numbers<'_>,
        sliding_m_s: Numbers<'_>,
        is_series: bool,
    ) -> PyResult<Forces<'py>> {
        let [clearance, deformation, rate, approach, sliding] = columns([
            ("radial_clearance_m", &radial_clearance_m),
            ("deformation_m", &deformation_m),
            ("rate_m_s", &rate_m_s),
            ("approach_m_s", &approach_m_s),
            ("sliding_m_s", &sliding_m_s),
        ])?;
        let mut pair = AnyPair::new(self.model()?);
        let (mut normal, mut friction, mut outside) = (Vec::new(), Vec::new(), Vec::new());
        let repetitions = if is_series { 1 } else { WINDOW };
        let rows = clearance.iter().zip(&deformation).zip(&rate).zip(&approach).zip(&sliding);
        for ((((clearance, deformation), rate), approach), sliding) in rows {
            let state = ContactState {
                radial_clearance_m: *clearance as f32,
                deformation_m: *deformation as f32,
                deformation_rate_m_s: *rate as f32,
                approach_speed_m_s: *approach as f32,
                sliding_speed_m_s: *sliding as f32,
            };
            if !state.is_finite() {
                normal.push(f64::NAN);
                friction.push(f64::NAN);
                outside.push(true);
                continue;
            }
            let mut found = pair.push(&state);
            for _ in 1..repetitions {
                found = pair.push(&state);
            }
            normal.push(f64::from(found.normal_force_n()));
            friction.push(f64::from(found.friction_force_n()));
            outside.push(found.flags.intersects(Flags::OUTSIDE_TRAINING));
        }
        Ok((
            PyArray1::from_vec(py, normal),
            PyArray1::from_vec(py, friction),
            PyArray1::from_vec(py, outside),
        ))
    }
}

impl Networks {
    fn model(&self) -> PyResult<AnyModel<'_>> {
        AnyModel::load(&self.image).map_err(input)
    }
}
