//! What reading and checking a log found.

use serde::Serialize;
use std::collections::BTreeMap;

/// What a finding means for the diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// As it stands the channel would make the diagnosis meaningless. It was corrected where the correction is exact, else left out.
    Wrong,
    /// May mislead; somebody should look.
    Doubtful,
    /// Worth knowing.
    Note,
}

impl Severity {
    /// The word in JSON and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wrong => "wrong",
            Self::Doubtful => "doubtful",
            Self::Note => "note",
        }
    }
}

/// One finding about one channel of one log.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// What it means.
    pub severity: Severity,
    /// The log.
    pub log: String,
    /// The channel's name, or `t_s`.
    pub channel: String,
    /// What was found, one of a stable vocabulary in kebab-case: `sampling`, `gap`, `jitter`, `duplicate-time`, `backward-time`,
    /// `clock-unit`, `missing-values`, `outliers`, `stuck`, `constant`, `saturated`, `quantised`, `unit`, `sign`,
    /// `swapped-axes`, `gain`, `contradiction`, `delay`, `copy`, `nuisance-at-bound`.
    pub kind: &'static str,
    /// The same in words.
    pub found: String,
    /// The likely cause in words.
    pub cause: String,
    /// The numbers behind it.
    pub evidence: BTreeMap<&'static str, f64>,
    /// The line of `[columns]` that would mend it.
    pub mend: Option<String>,
    /// What was done to the data before the diagnosis.
    pub done: Option<String>,
}

impl Finding {
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
            mend: None,
            done: None,
        }
    }

    pub(crate) fn cause(mut self, words: impl Into<String>) -> Self {
        self.cause = words.into();
        self
    }

    pub(crate) fn evidence(mut self, name: &'static str, value: f64) -> Self {
        // JSON has no other numbers.
        if value.is_finite() {
            self.evidence.insert(name, value);
        }
        self
    }

    pub(super) fn mend(mut self, line: String) -> Self {
        self.mend = Some(line);
        self
    }

    pub(super) fn done(mut self, words: impl Into<String>) -> Self {
        self.done = Some(words.into());
        self
    }
}
