//! Pictures of the paper that need its data sets and trainings: Figs. 8 and 10. `host-sim figures`
//! shows them on its page.

use super::training::ReportError;
use super::training::pictures::{Picture, epochs};
use crate::data::cleaning_chart;
use crate::data::friction::FrictionSet;
use crate::data::friction_source::from_rig;
use crate::train::history::History;
use crate::train::rig::SMOOTHING_S;
use inference::BearingMaterial;
use report::figure::Drawing;

/// Seed of the rig's records.
const SEED: u64 = 1;
/// Group of the drawn record: the largest load.
const GROUP: &str = "240000 N, forward";

/// A picture with its file name and caption.
#[derive(Clone, Debug)]
pub struct PaperPicture {
    /// File name without extension.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// Content.
    pub drawing: Drawing,
}

impl From<Picture> for PaperPicture {
    fn from(Picture { name, caption, drawing }: Picture) -> Self {
        Self { name, caption, drawing }
    }
}

/// Draws a record of the rig before and after cleaning (Fig. 8).
///
/// # Errors
///
/// The rig cannot be recorded or the picture cannot be drawn.
pub fn cleaning(bearing: BearingMaterial) -> Result<PaperPicture, String> {
    let logs = from_rig(&format!("friction-rig-{}", bearing.name()), bearing, SEED);
    let logs = logs.map_err(|e| e.to_string())?;
    let set = FrictionSet::new(logs, SMOOTHING_S, SEED).map_err(|e| e.to_string())?;
    let group = set.groups.iter().find(|group| group.source == GROUP).ok_or("no group of the rig")?;
    let drawing = cleaning_chart::comparison(group).map_err(|e| e.to_string())?;
    let caption = format!("Fig. 8, {}: {} outliers removed, then averaged.", bearing.name(), group.outliers);
    Ok(PaperPicture { name: format!("cleaning-{}", bearing.name()), caption, drawing: drawing.into() })
}

/// Draws the errors over the epochs of the shipped training of a bearing (Fig. 10).
///
/// # Errors
///
/// The embedded history has other content or a picture cannot be drawn.
pub fn training(bearing: BearingMaterial) -> Result<Vec<PaperPicture>, String> {
    let history = History::shipped(bearing).map_err(|e| e.to_string())?;
    let pictures = epochs(&history).map_err(|e: ReportError| e.to_string())?;
    Ok(pictures.into_iter().map(PaperPicture::from).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_bearings_have_pictures_of_their_records_and_trainings() {
        for bearing in [BearingMaterial::Babbitt, BearingMaterial::Plastic] {
            let cleaning = cleaning(bearing).unwrap();
            assert!(cleaning.drawing.svg.contains("240000 N") && !cleaning.caption.contains(" 0 outliers"));
            let training = training(bearing).unwrap();
            assert_eq!(training.len(), 4);
            assert!(training.iter().all(|picture| picture.drawing.svg.contains("validation")));
        }
    }
}
