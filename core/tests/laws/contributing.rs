//! What CONTRIBUTING.md shows is what compiles.

#[test]
fn the_worked_examples_are_those_that_compile() {
    let page = include_str!("../../../CONTRIBUTING.md").replace("\r\n", "\n");
    for (name, code) in [
        ("add_an_estimator", include_str!("../../examples/add_an_estimator.rs")),
        ("add_a_product", include_str!("../../examples/add_a_product.rs")),
    ] {
        let code = code.replace("\r\n", "\n");
        assert!(page.contains(&format!("```rust\n{code}```\n")), "CONTRIBUTING.md shows another {name}.rs");
    }
    let (_, example) = page.split_once("```toml\n").expect("it shows an example");
    let (example, _) = example.split_once("```").expect("the block ends");
    let bundled = include_str!("../../assets/examples/stereo.toml").replace("\r\n", "\n");
    assert!(bundled.contains(example), "CONTRIBUTING.md shows another example");
}
