use super::*;

#[derive(Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: &'static str,
    #[serde(default)]
    limit: f64,
}

fn refused(text: &'static str) -> String {
    read::<Entry>("toys.toml", text).expect_err("it is wrong").to_string()
}

#[test]
fn entries_keep_the_order_of_the_file() {
    let text = "[[term]]\nname = \"b\"\n\n[[term]]\nname = 'a \"quoted\" name'\nlimit = 2\n";
    let entries = [Entry { name: "b", limit: 0.0 }, Entry { name: "a \"quoted\" name", limit: 2.0 }];
    assert_eq!(read("toys.toml", text), Ok(entries.into()));
}

#[test]
fn an_error_names_the_file_and_the_line() {
    for (text, begins) in [
        ("[[term]]\nname = \"a\"\n\n[[term]]\nnane = \"b\"\n", "line 5: unknown field `nane`, expected `name`"),
        ("[[term]]\nname = \"a\"\n\n[[term]]\nlimit = 1\n", "line 4: missing field `name`"),
        ("[[term]]\nname = a\n", "line 2: "),
        ("[[term]]\nname = \"a\"\nlimit = \"a\"\n", "line 3: invalid type"),
        ("[[tern]]\n", "line 1: unknown field `tern`"),
    ] {
        let why = refused(text);
        assert!(why.starts_with(&format!("core/assets/toys.toml, {begins}")), "{why}");
    }
}
