//! The type stubs of the native module against its source. This test also makes `cargo test` build
//! the library for `cargo xtask wheel --check`.

use std::collections::BTreeSet;

/// Identifiers before `end` in the lines that start with `start`.
fn names<'t>(text: &'t str, start: &str, end: char) -> BTreeSet<&'t str> {
    text.lines().filter_map(|line| line.strip_prefix(start)?.split_once(end)).map(|(name, _)| name).collect()
}

#[test]
fn the_stubs_name_what_the_module_exports() {
    let module = include_str!("../src/lib.rs").split("mod native").nth(1).unwrap_or_default();
    let exported: BTreeSet<&str> = module
        .split("use crate::")
        .skip(1)
        .filter_map(|line| line.split_once("::")?.1.split_once(';'))
        .flat_map(|(names, _)| names.split(['{', '}', ',']))
        .map(str::trim)
        .filter(|name| !name.is_empty())
        .collect();
    let stubs = include_str!("../python/pintle/_native.pyi");
    let classes = stubs.lines().filter_map(|line| line.strip_prefix("class "));
    let classes = classes.filter_map(|rest| rest.split(['(', ':']).next());
    let named: BTreeSet<&str> = names(stubs, "def ", '(').into_iter().chain(classes).collect();
    assert!(exported.len() > 15, "{exported:?}");
    assert_eq!(exported, named);
}
