//! Edits of a log that several checks make.

use bench::{Channel, MeasuredLog};

/// Removes the rows whose entry in `keep` is false.
pub(super) fn keep_rows(log: &mut MeasuredLog, keep: &[bool]) {
    if keep.iter().all(|k| *k) {
        return;
    }
    let cut = |values: &mut Vec<f64>| {
        let mut keep = keep.iter();
        values.retain(|_| keep.next() == Some(&true));
    };
    cut(&mut log.time_s);
    log.channels.values_mut().for_each(cut);
}

/// Multiplies all readings of a channel; no effect if the log lacks it.
pub(super) fn multiply(log: &mut MeasuredLog, channel: Channel, factor: f64) {
    for value in log.channels.get_mut(&channel).into_iter().flatten() {
        *value *= factor;
    }
}
