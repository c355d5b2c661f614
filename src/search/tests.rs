use super::*;

/// The kinds and titles of what `query` finds.
fn found(query: &str) -> Vec<(Kind, String)> {
    search(query).into_iter().map(|hit| (hit.kind, hit.title)).collect()
}

fn has(query: &str, kind: Kind, title: &str) -> bool {
    found(query).iter().any(|(of, name)| *of == kind && name == title)
}

#[test]
fn everything_with_text_is_found_by_its_title() {
    for (query, kind, title) in [
        ("structure tensor", Kind::Term, "Structure tensor"),
        ("farneback", Kind::Estimator, "Farnebäck"),
        ("search range", Kind::Parameter, "Search range"),
        ("point cloud", Kind::Chart, "Point cloud"),
        ("lucas-kanade", Kind::Estimator, "Lucas–Kanade"),
    ] {
        assert!(has(query, kind, title), "{query}: {:?}", found(query));
    }
    for lesson in crate::session::lesson::all() {
        for (number, page) in lesson.pages.iter().enumerate() {
            let hits = search(&page.title);
            let is_page = |hit: &Hit| matches!(&hit.target, Target::Page(address) if *address == Address { page: number, ..Address::from(lesson) });
            assert!(hits.iter().take(20).any(is_page), "{}: {}", lesson.title, page.title);
        }
    }
}

#[test]
fn titles_come_before_text_and_phrases_before_words() {
    let hits = search("Kalman gain");
    assert_eq!((hits[0].kind, hits[0].title.as_str()), (Kind::Term, "Kalman gain"));
    let hits = found("horn schunck");
    assert_eq!(hits[0], (Kind::Estimator, "Horn–Schunck".to_owned()), "{hits:?}");
    assert_eq!(found("aperture")[0], (Kind::Term, "Aperture problem".to_owned()), "before examples that fail by it");
    assert!(has("lucas kanade aperture", Kind::Example, "The barber's pole"));
    let ranks: Vec<_> = {
        let query = Query::new("search window");
        let mut ranks: Vec<_> = index().iter().filter_map(|entry| rank(entry, &query)).collect();
        ranks.sort();
        ranks
    };
    assert!(ranks.contains(&Rank::Phrase) && ranks.contains(&Rank::InText), "{ranks:?}");
}

#[test]
fn a_word_of_the_text_is_shown_with_the_words_around_it() {
    let hits = search("misprint");
    assert!(!hits.is_empty());
    for hit in &hits {
        let Excerpt { text, marks } = &hit.excerpt;
        assert!(text.chars().count() <= 160, "{text}");
        let marked: Vec<_> = marks.iter().map(|mark| text[mark.clone()].to_lowercase()).collect();
        assert!(marked.iter().all(|word| word.starts_with("misprint")) && !marked.is_empty(), "{text}: {marked:?}");
    }
    let far = Searched::new(format!("{}The Kalman gain is here. {}", "Some words. ".repeat(40), "More. ".repeat(40)));
    let excerpt = far.excerpt(&Query::new("kalman gains"));
    assert!(excerpt.text.starts_with("… ") && excerpt.text.ends_with(" …"), "{}", excerpt.text);
    let marked: Vec<_> = excerpt.marks.iter().map(|mark| &excerpt.text[mark.clone()]).collect();
    assert_eq!(marked, ["Kalman", "gain"]);
}

#[test]
fn words_are_found_from_their_beginning_and_in_any_number() {
    assert!(has("eigenvalues", Kind::Term, "Eigenvalue") && has("eigen", Kind::Term, "Eigenvalue"));
    assert!(!has("igenvalue", Kind::Term, "Eigenvalue"));
    assert!(search("").is_empty() && search("  ").is_empty() && search("xyzzy").is_empty());
    assert!(search("kalman xyzzy").is_empty(), "all words must be there");
    // Letters of any script, and of any length in bytes, are cut nowhere.
    for query in ["λ", "α", "é", "−", "\u{1d11e}", "((", "\\"] {
        for hit in search(query) {
            assert!(hit.excerpt.marks.iter().all(|mark| hit.excerpt.text.get(mark.clone()).is_some()));
        }
    }
}

#[test]
fn a_misspelling_is_answered_with_the_nearest_words() {
    for (typed, meant) in [
        ("kalmann gain", "kalman gain"),
        ("optcal flow", "optical flow"),
        ("apreture", "aperture"),
        ("igenvalue", "eigenvalue"),
        ("lucas-kanadde", "lucas kanade"),
        ("farnebeck", "farneback"),
        // The word with which the whole query has hits, and of two equally near ones the more frequent.
        ("blok matching", "block matching"),
        ("blok", "block"),
        // The beginning of a word is completed beside a misspelling.
        ("exhaustiv serach", "exhaustive search"),
        ("exhaustiv search windwo", "exhaustive search window"),
    ] {
        assert!(search(typed).is_empty(), "{typed}");
        let suggested = suggest(typed).unwrap_or_default();
        assert!(Searched::new(&*suggested).is(&Query::new(meant)), "{typed}: {suggested}");
        assert!(!search(&suggested).is_empty(), "{suggested}");
    }
    assert_eq!(suggest("kalmann gain").as_deref(), Some("Kalman gain"), "as it is written most often");
    for known in ["kalman gain", "eigen", "", "  "] {
        assert_eq!(suggest(known), None, "{known} is no misspelling");
    }
    for unknown in ["xyzzy", "kalman xyzzy", "\u{1d11e}", "(("] {
        assert_eq!(suggest(unknown), None, "nothing is near {unknown}");
    }
}

#[test]
fn formulas_in_snippets_mark_transposed_matrices() {
    let snippet = |query: &str, title: &str| {
        let hits = search(query);
        let of_title = hits.into_iter().find(|hit| hit.title == title);
        of_title.map(|hit| hit.excerpt.text).unwrap_or_default()
    };
    let innovation = snippet("innovation covariance", "Innovation covariance");
    assert!(innovation.contains("S = H P⁻ Hᵀ + R"), "{innovation}");
    for query in ["H^T + R", "h^t + r", "Hᵀ + R"] {
        assert_eq!(snippet(query, "Innovation covariance"), innovation, "{query}, however it is typed");
    }
    for entry in index() {
        let texts = [&entry.title].into_iter().chain(&entry.also).chain(&entry.texts);
        for text in texts {
            assert!(!text.original().contains("^T"), "{}", text.original());
        }
    }
}

#[test]
fn names_are_found_without_their_accents() {
    for (written, typed) in [
        ("Åström", "astrom"),
        ("ČECH", "cech"),
        ("Gonçalves", "goncalves"),
        ("Íñigo", "inigo"),
        ("Sørensen", "sorensen"),
        ("Dvořák", "dvorak"),
        ("Benoît", "benoit"),
    ] {
        assert!(Searched::new(written).is(&Query::new(typed)), "{written}");
        assert!(Searched::new(typed).is(&Query::new(written)), "{written}, typed as it is written");
    }
}

#[test]
fn a_parameter_that_many_estimators_share_is_found_once() {
    let ranges =
        found("search range").into_iter().filter(|(kind, title)| *kind == Kind::Parameter && title == "Search range");
    assert!(ranges.count() <= 3);
    let hits = search("search range");
    let of_many = hits.iter().find(|hit| hit.kind == Kind::Parameter).expect("it is there");
    assert!(of_many.place.contains("more"), "{}", of_many.place);
}

#[test]
fn hits_stand_in_groups_with_the_best_kind_first() {
    let hits = search("gradient");
    let groups = grouped(&hits);
    assert_eq!(groups[0].0, hits[0].kind);
    assert_eq!(groups.iter().map(|(_, group)| group.len()).sum::<usize>(), hits.len());
    let mut kinds: Vec<_> = groups.iter().map(|(kind, _)| *kind).collect();
    kinds.sort();
    kinds.dedup();
    assert_eq!(kinds.len(), groups.len());
}
