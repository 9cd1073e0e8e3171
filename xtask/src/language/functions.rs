//! Length and number of branches of functions.
//!
//! A branch is an `if`, a guard, an arm of a `match` after the first, a loop, `&&` or `||`.
//! Closures count as a part of their function, functions inside of functions do not. The arguments
//! of macros are not seen.

use syn::visit::{self, Visit};
use syn::{Arm, BinOp, Block, ExprBinary, ExprForLoop, ExprIf, ExprLoop, ExprMatch, ExprWhile, Signature};

/// Maximum length of a function from its signature to its closing brace, in lines.
pub(super) const MAX_LINES: usize = 80;
/// Maximum number of branches of a function.
pub(super) const MAX_BRANCHES: usize = 20;
/// Files, names and reasons of the functions that may exceed both.
const EXEMPT: &str = include_str!("exempt-functions.txt");

/// Lists the functions of a file that exceed a limit: line number from 1, and what is wrong.
pub(super) fn check(path: &str, content: &str) -> Vec<(usize, String)> {
    match syn::parse_file(content) {
        Ok(file) => {
            let mut functions = Functions { path, ..Functions::default() };
            functions.visit_file(&file);
            functions.departures
        }
        Err(error) => vec![(error.span().start().line, format!("not understood: {error}"))],
    }
}

/// Walk through a file.
#[derive(Default)]
struct Functions<'a> {
    path: &'a str,
    departures: Vec<(usize, String)>,
    /// Branches of the current function.
    branches: usize,
}

impl Functions<'_> {
    fn function(&mut self, signature: &Signature, body: &Block) {
        let outer = std::mem::take(&mut self.branches);
        visit::visit_block(self, body);
        let branches = std::mem::replace(&mut self.branches, outer);
        let first = signature.fn_token.span.start().line;
        let lines = body.brace_token.span.close().end().line - first + 1;
        let name = signature.ident.to_string();
        let limits = [("lines", lines, MAX_LINES), ("branches", branches, MAX_BRANCHES)];
        for (what, found, max) in limits.into_iter().filter(|_| !is_exempt(self.path, &name)) {
            if found > max {
                self.departures.push((first, format!("`{name}` has {found} {what}; at most {max}")));
            }
        }
    }
}

impl<'ast> Visit<'ast> for Functions<'_> {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.function(&function.sig, &function.block);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.function(&function.sig, &function.block);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        if let Some(body) = &function.default {
            self.function(&function.sig, body);
        }
    }

    fn visit_expr_if(&mut self, expression: &'ast ExprIf) {
        self.branches += 1;
        visit::visit_expr_if(self, expression);
    }

    fn visit_expr_match(&mut self, expression: &'ast ExprMatch) {
        self.branches += expression.arms.len().saturating_sub(1);
        visit::visit_expr_match(self, expression);
    }

    fn visit_arm(&mut self, arm: &'ast Arm) {
        self.branches += usize::from(arm.guard.is_some());
        visit::visit_arm(self, arm);
    }

    fn visit_expr_loop(&mut self, expression: &'ast ExprLoop) {
        self.branches += 1;
        visit::visit_expr_loop(self, expression);
    }

    fn visit_expr_while(&mut self, expression: &'ast ExprWhile) {
        self.branches += 1;
        visit::visit_expr_while(self, expression);
    }

    fn visit_expr_for_loop(&mut self, expression: &'ast ExprForLoop) {
        self.branches += 1;
        visit::visit_expr_for_loop(self, expression);
    }

    fn visit_expr_binary(&mut self, expression: &'ast ExprBinary) {
        self.branches += usize::from(matches!(expression.op, BinOp::And(_) | BinOp::Or(_)));
        visit::visit_expr_binary(self, expression);
    }
}

fn is_exempt(path: &str, name: &str) -> bool {
    EXEMPT.lines().any(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some(path) && words.next() == Some(name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_over_the_limit_is_reported_by_name_and_first_line() {
        let function = |lines: usize| {
            format!(
                "impl A {{\n    pub(crate) fn long<T>(\n    ) {{\n{}    }}\n}}\n",
                "        a();\n".repeat(lines - 3)
            )
        };
        assert_eq!(check("a.rs", &function(MAX_LINES)), []);
        let long = function(MAX_LINES + 1);
        assert_eq!(check("a.rs", &long), [(2, "`long` has 81 lines; at most 80".to_owned())]);
        let kernel = "crates/inference/src/kernel/cortex_m/layer.rs";
        assert_eq!(check(kernel, &long.replace("long", "wide_layer")), []);
        assert_eq!(check("a.rs", &long.replace("long", "wide_layer")).len(), 1);
    }

    #[test]
    fn every_exemption_names_a_function_over_a_limit() {
        for line in EXEMPT.lines().skip(1) {
            let [path, name] = [0, 1].map(|word| line.split_whitespace().nth(word).unwrap());
            let text = std::fs::read_to_string(crate::run::root().join(path)).unwrap();
            let departures = check("elsewhere.rs", &text);
            assert!(departures.iter().any(|(_, what)| what.starts_with(&format!("`{name}` "))), "{line}");
        }
    }

    #[test]
    fn a_declaration_without_a_body_has_no_length() {
        let body = "    const A: u8 = 0;\n".repeat(MAX_LINES);
        assert_eq!(check("a.rs", &format!("trait A {{\n    fn a<T>(\n    ) -> u8;\n{body}}}\n")), []);
    }

    #[test]
    fn every_kind_of_branch_counts_and_those_of_an_inner_function_do_not() {
        let functions = |body: &str| {
            let mut functions = Functions::default();
            functions.visit_block(&syn::parse_str(&format!("{{ {body} }}")).unwrap());
            functions.branches
        };
        for (body, branches) in [
            ("a(); let Some(b) = c else { return };", 0),
            ("if a {} else if b {} else {}", 2),
            ("if let A = b && c || d {}", 3),
            ("match a { 1 => {} 2 if b => {} _ => {} }", 3),
            ("loop { while a {} for b in c {} }", 3),
            ("a.map(|b| if b { 1 } else { 2 });", 1),
            ("fn b() { if a {} } if a {}", 1),
        ] {
            assert_eq!(functions(body), branches, "{body}");
        }
        let many = "if a {}".repeat(MAX_BRANCHES + 1);
        assert_eq!(
            check("a.rs", &format!("fn b() {{ {many} }}")),
            [(1, "`b` has 21 branches; at most 20".to_owned())]
        );
    }
}
