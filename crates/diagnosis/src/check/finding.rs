//! Findings of the checks of a log.

use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The channel would make the diagnosis meaningless. It was corrected if the correction is
    /// exact, else left out.
    Wrong,
    /// May lead to a wrong diagnosis; needs a look by the user.
    Doubtful,
    /// Information.
    Note,
}

impl Severity {
    /// Name in JSON and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wrong => "wrong",
            Self::Doubtful => "doubtful",
            Self::Note => "note",
        }
    }
}

/// A finding about one channel of one log.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Finding {
    /// Severity.
    pub severity: Severity,
    /// Name of the log.
    pub log: String,
    /// Name of the channel, or `t_s`.
    pub channel: String,
    /// Kind, from a stable vocabulary: `sampling`, `gap`, `jitter`, `duplicate-time`,
    /// `backward-time`, `clock-unit`, `missing-values`, `outliers`, `stuck`, `constant`,
    /// `saturated`, `quantised`, `unit`, `sign`, `swapped-axes`, `gain`, `contradiction`, `delay`,
    /// `copy`, `nuisance-at-bound`, `out-of-tolerance`, `immaterial`, `open-loop`.
    pub kind: &'static str,
    /// The finding as a clause.
    pub found: String,
    /// The likely cause.
    pub cause: String,
    /// The numbers that support it.
    pub evidence: BTreeMap<&'static str, f64>,
    /// The line of `[columns]` that corrects it.
    #[serde(rename = "mend")]
    pub correction: Option<String>,
    /// Change of the data before the diagnosis; none if nothing was changed.
    #[serde(rename = "done")]
    pub applied: Option<String>,
}

impl Finding {
    /// A finding without cause, evidence and correction.
    pub(crate) fn new(
        severity: Severity,
        log: &str,
        channel: &str,
        kind: &'static str,
        found: String,
    ) -> Self {
        Self {
            severity,
            log: log.into(),
            channel: channel.into(),
            kind,
            found,
            cause: String::new(),
            evidence: BTreeMap::new(),
            correction: None,
            applied: None,
        }
    }

    /// Adds the likely cause.
    pub(crate) fn cause(mut self, words: impl Into<String>) -> Self {
        self.cause = words.into();
        self
    }

    /// Adds a number that supports the finding.
    pub(crate) fn evidence(mut self, name: &'static str, value: f64) -> Self {
        // JSON has no infinite numbers.
        if value.is_finite() {
            self.evidence.insert(name, value);
        }
        self
    }

    /// Adds the line of `[columns]` that corrects it.
    pub(super) fn correction(mut self, line: String) -> Self {
        self.correction = Some(line);
        self
    }

    /// Adds the change of the data.
    pub(super) fn applied(mut self, words: impl Into<String>) -> Self {
        self.applied = Some(words.into());
        self
    }
}
