//! The union–find forest of the provisional labels as a drawing: roots above, children below.

use crate::base::words::counted;
use crate::scene::{Diagram, DiagramLine, Node, Role, Words};

/// The most labels that are drawn.
const MOST: usize = 24;
/// From a node to its label, in columns.
const ASIDE: f32 = 0.16;

/// Draws the trees, that of the last union first and labels alone last; `None` where there is no label. `parents` holds
/// the parent of each label, and `union` root and child of the current union.
pub fn drawn(parents: &[u32], union: Option<[u32; 2]>) -> Option<Diagram> {
    let mut children = vec![Vec::new(); parents.len()];
    for (label, parent) in parents.iter().enumerate().filter(|(label, parent)| *label != **parent as usize) {
        children[*parent as usize].push(label);
    }
    let mut roots: Vec<usize> = (0..parents.len()).filter(|label| parents[*label] as usize == *label).collect();
    // The sort is stable: the others stay in the order of their labels.
    let is_at_work = |root: usize| union.is_some_and(|[at_work, _]| at_work as usize == root);
    roots.sort_by_key(|root| (!is_at_work(*root), children[*root].is_empty()));
    let mut forest =
        Forest { children: &children, union, left: MOST, columns: 0, deepest: 0, diagram: Diagram::default() };
    for root in roots {
        forest.grow(root, 0);
    }
    (!parents.is_empty()).then(|| forest.finished(parents.len().saturating_sub(MOST)))
}

/// The drawing so far.
struct Forest<'a> {
    children: &'a [Vec<usize>],
    union: Option<[u32; 2]>,
    /// Number of further labels that may be drawn.
    left: usize,
    /// The columns that are taken; each label without children has one.
    columns: usize,
    deepest: usize,
    diagram: Diagram,
}

impl Forest<'_> {
    /// Draws `label` and the labels below it until the limit is reached; returns the place of its node.
    fn grow(&mut self, label: usize, depth: usize) -> Option<[f32; 2]> {
        self.left = self.left.checked_sub(1)?;
        self.deepest = self.deepest.max(depth);
        let all = self.children;
        let below: Vec<[f32; 2]> = all[label].iter().map_while(|child| self.grow(*child, depth + 1)).collect();
        let x = match (below.first(), below.last()) {
            (Some(first), Some(last)) => (first[0] + last[0]) / 2.0,
            _ => {
                self.columns += 1;
                (self.columns - 1) as f32
            }
        };
        let at = [x, depth as f32];
        for (child, end) in self.children[label].iter().zip(&below) {
            let is_new = self.union == Some([label as u32, *child as u32]);
            let (role, width) = if is_new { (Role::Measured, 4.0) } else { (Role::Best, 1.5) };
            self.diagram.lines.push(DiagramLine { role, width, is_faded: false, points: vec![at, *end] });
        }
        let role = if depth == 0 { Role::Result } else { Role::Best };
        self.diagram.nodes.push(Node { role, is_faded: false, at, radius: 5.0 });
        let text = (label + 1).to_string();
        self.diagram.words.push(Words { text, role: Some(role), at: [x + ASIDE, depth as f32], side: 1 });
        Some(at)
    }

    /// The drawing with its size, its title, and a note on the `others`: labels that are not drawn.
    fn finished(self, others: usize) -> Diagram {
        let size = [self.columns as f32, self.deepest as f32 + 0.6];
        let mut diagram = self.diagram;
        if others > 0 {
            let text = format!("and {}", counted(others, "more label"));
            diagram.words.push(Words { text, role: None, at: [0.0, size[1]], side: 1 });
        }
        let summary = format!("{} drawn", counted(diagram.nodes.len(), "label"));
        Diagram { title: "Union–find forest of the labels", size, summary, ..diagram }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_stand_above_their_children_and_the_union_is_marked() {
        // Labels 1 and 4 are roots of 2, 3 and of 5; label 6 stands alone.
        let diagram = drawn(&[0, 0, 1, 3, 3, 5], Some([3, 4])).expect("two trees");
        let of = |label: &str| {
            let at = diagram.words.iter().position(|words| words.text == label).expect("it is drawn");
            diagram.nodes[at].at
        };
        assert_eq!((of("1")[1], of("2")[1], of("3")[1]), (0.0, 1.0, 2.0), "each level one lower");
        assert_eq!((of("4")[1], of("5")[1]), (0.0, 1.0));
        assert!(of("4")[0] < of("1")[0], "the tree at work is the first");
        assert!(of("6")[0] > of("2")[0], "a label alone is the last");
        let unions = diagram.lines.iter().filter(|line| line.role == Role::Measured).count();
        assert_eq!((diagram.lines.len(), unions), (3, 1));
        assert_eq!(drawn(&[], None), None);
    }

    #[test]
    fn a_large_forest_is_drawn_in_part_and_says_so() {
        let parents: Vec<u32> = (0..200).map(|label| label / 2 * 2).collect();
        let diagram = drawn(&parents, None).expect("a hundred trees");
        assert_eq!(diagram.nodes.len(), MOST);
        assert!(diagram.words.iter().any(|words| words.text == "and 176 more labels"), "{:?}", diagram.words.last());
        // A chain, as deep as it is long, is cut too.
        let chain: Vec<u32> = (0..100_000_u32).map(|label| label.saturating_sub(1)).collect();
        assert_eq!(drawn(&chain, None).map(|diagram| diagram.nodes.len()), Some(MOST));
    }
}
