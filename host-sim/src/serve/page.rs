//! Page of a live view: everything is in it, so that it works without a network.

use report::script_page::ScriptPage;

/// Returns the page.
pub(super) fn page() -> ScriptPage {
    ScriptPage::new(
        "host-sim: live run",
        include_str!("page.css"),
        include_str!("page.html"),
        include_str!("page.js"),
    )
}
