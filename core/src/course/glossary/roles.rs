//! Which marks show what a term is about.

use super::{Term, find, in_family};
use crate::scene::Role;

/// The roles of the marks that show what a term is about, where no entry of a legend names the term itself.
const USUAL: [(Role, &[&str]); 8] = [
    (
        Role::Reference,
        &[
            "background model",
            "block",
            "corner response",
            "gray level",
            "image gradient",
            "neighbourhood mean",
            "temporal derivative",
        ],
    ),
    (Role::Window, &["innovation covariance", "Mahalanobis distance", "search range", "structure tensor"]),
    (Role::Candidate, &["candidate", "cost", "hypothesis", "sum of absolute differences"]),
    (Role::Best, &["global minimum", "local minimum", "match"]),
    (Role::Result, &["displacement", "disparity", "motion vector", "optical flow"]),
    (Role::Predicted, &["prediction", "predictor", "process noise"]),
    (Role::Estimate, &["covariance matrix", "state", "track", "update"]),
    (Role::Truth, &["ground truth"]),
];

/// The role of the marks that show what `term` is about in a family of estimators, wherever such marks are drawn.
///
/// ```
/// use motionscope_core::course::glossary::{find, role_of};
/// use motionscope_core::scene::Role;
///
/// let range = find("search range").expect("it is in the glossary");
/// assert_eq!(role_of(range, "Block matching"), Some(Role::Window));
/// ```
pub fn role_of(term: &Term, family: &str) -> Option<Role> {
    let is_meant = |name: &&str| find(name).is_some_and(|found| in_family(found, family) == term);
    USUAL.iter().find(|(_, names)| names.iter().any(is_meant)).map(|(role, _)| *role)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_that_of_a_term_and_stands_once() {
        let mut names: Vec<&str> = USUAL.iter().flat_map(|(_, names)| *names).copied().collect();
        names.iter().for_each(|name| assert_eq!(find(name).map(|term| term.name), Some(*name)));
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn the_sense_is_that_of_the_family() {
        let meant = |family| role_of(in_family(find("hypothesis").expect("a term"), family), family);
        assert_eq!(["Region tracking", "Tracking", "Correspondence"].map(meant), [Some(Role::Candidate); 3]);
        assert_eq!(role_of(find("Kalman gain").expect("a term"), "Tracking"), None, "it is a matrix, and no mark");
    }
}
