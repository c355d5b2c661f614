//! What CONTRIBUTING.md shows is what compiles.

#[test]
fn the_worked_examples_are_those_that_compile() {
    let page = include_str!("../../CONTRIBUTING.md").replace("\r\n", "\n");
    for (name, code) in [
        ("add_an_estimator", include_str!("../examples/add_an_estimator.rs")),
        ("add_a_product", include_str!("../examples/add_a_product.rs")),
    ] {
        let code = code.replace("\r\n", "\n");
        assert!(page.contains(&format!("```rust\n{code}```\n")), "CONTRIBUTING.md shows another {name}.rs");
    }
}
