//! The tree of the hypotheses of a cluster over the frames that are not decided.

use std::sync::Arc;

use super::forest::{Claim, Cluster, Hypothesis, Origin, Scan};
use crate::methods::numbers::ratio;
use crate::scene::{Diagram, DiagramLine, Node, Role, Words};

/// The most hypotheses that are drawn.
const MOST_LEAVES: usize = 16;
/// The most claims of a leaf in words.
const CLAIMS: usize = 3;
/// Columns for the words beside the leaves.
const BESIDE: f32 = 1.8;

/// A hypothesis: a path through the tree.
#[derive(Clone, Debug)]
struct Leaf {
    past: Vec<Arc<Scan>>,
    probability: f64,
    /// Whether N-scan pruning deletes it.
    is_deleted: bool,
}

/// The hypotheses of a cluster: the leading one, then the others, the most probable first. The first [`MOST_LEAVES`] are drawn.
#[derive(Clone, Debug)]
pub struct Tree {
    leaves: Vec<Leaf>,
}

impl Tree {
    /// The tree of the cluster with the most hypotheses, those included that a decision has just deleted from each.
    pub fn largest(clusters: &[Cluster], deleted: &[Vec<Hypothesis>]) -> Option<Self> {
        let of = |i: usize| deleted.get(i).map_or(&[][..], |all| all);
        let size = |i: &usize| clusters[*i].hypotheses.len() + of(*i).len();
        let most =
            (0..clusters.len()).filter(|i| size(i) > 1).reduce(|a, b| if size(&b) > size(&a) { b } else { a })?;
        Some(Self::of(&clusters[most], of(most)))
    }

    fn of(cluster: &Cluster, deleted: &[Hypothesis]) -> Self {
        // The kept ones are scaled to a sum of 1 again.
        let kept = 1.0 - deleted.iter().map(Hypothesis::probability).sum::<f64>();
        let leaf = |one: &Hypothesis, scale: f64, is_deleted| Leaf {
            past: one.past.clone(),
            probability: scale * one.probability(),
            is_deleted,
        };
        let all = cluster.hypotheses.iter().map(|one| leaf(one, kept, false));
        let mut leaves: Vec<Leaf> = all.chain(deleted.iter().map(|one| leaf(one, 1.0, true))).collect();
        // The leader stays first, even if rounding makes another one more probable.
        if let Some((_, others)) = leaves.split_first_mut() {
            others.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        }
        Self { leaves }
    }

    /// Whether one of the hypotheses ends with a scan.
    pub fn has(&self, scan: &Arc<Scan>) -> bool {
        self.leaves.iter().any(|leaf| leaf.past.last().is_some_and(|last| Arc::ptr_eq(last, scan)))
    }

    /// The frames that are not decided.
    fn frames(&self) -> Vec<usize> {
        let mut frames: Vec<usize> =
            self.leaves.iter().flat_map(|leaf| leaf.past.iter().map(|scan| scan.frame)).collect();
        frames.sort_unstable();
        frames.dedup();
        frames
    }

    /// The tree drawn from left to right, a column for each frame, with notes below it.
    pub fn drawn(&self, notes: &[String]) -> Diagram {
        let frames = self.frames();
        let mut drawing = Drawing { tree: self, frames: &frames, rows: 0, diagram: Diagram::default() };
        let all: Vec<usize> = (0..self.leaves.len().min(MOST_LEAVES)).collect();
        let root = drawing.grow(&all, 0);
        drawing.node((0, root), &all);
        let rows = drawing.rows;
        let mut diagram = drawing.diagram;
        diagram.title = "Tree of hypotheses";
        let width = frames.len() as f32 + 0.4 + BESIDE;
        let note = |(i, text): (usize, String)| Words {
            text,
            role: Some(Role::Rejected),
            at: [0.1, rows as f32 + 1.5 + i as f32],
            side: 1,
        };
        let others = self.leaves.len() - all.len();
        let others = (others > 0).then(|| format!("{others} less probable ones are not drawn"));
        let notes: Vec<String> = others.into_iter().chain(notes.iter().cloned()).collect();
        diagram.size = [width, rows as f32 + 1.5 + notes.len() as f32];
        diagram.words.extend(notes.into_iter().enumerate().map(note));
        let frame = |(i, frame): (usize, &usize)| Words {
            // Named once, because the columns may be narrow.
            text: if i == 0 { format!("frame {frame}") } else { frame.to_string() },
            role: None,
            at: [column(i + 1), 0.4],
            side: 0,
        };
        diagram.words.extend(frames.iter().enumerate().map(frame));
        diagram.summary = self.summary(&frames);
        diagram
    }

    fn summary(&self, frames: &[usize]) -> String {
        let deleted = self.leaves.iter().filter(|leaf| leaf.is_deleted).count();
        let leader = self.leaves.first().map_or(0.0, |leaf| leaf.probability);
        format!(
            "Tree of {} hypotheses over {} undecided frames: the leading one has a probability of {}, N-scan pruning deletes {deleted}",
            self.leaves.len(),
            frames.len(),
            ratio(leader)
        )
    }

    /// The probability of the branch to a leaf over these frames: of all hypotheses that share it, drawn or not.
    fn probability(&self, leaf: usize, frames: &[usize]) -> f64 {
        let shares =
            |other: &usize| frames.iter().all(|frame| self.claims(*other, *frame) == self.claims(leaf, *frame));
        (0..self.leaves.len()).filter(shares).map(|other| self.leaves[other].probability).sum()
    }

    /// A hypothesis's explanation of a frame.
    fn claims(&self, leaf: usize, frame: usize) -> &[Claim] {
        let scan = self.leaves[leaf].past.iter().find(|scan| scan.frame == frame);
        scan.map_or(&[], |scan| &scan.claims)
    }
}

fn column(depth: usize) -> f32 {
    depth as f32 + 0.2
}

/// A tree that is being drawn.
struct Drawing<'a> {
    tree: &'a Tree,
    frames: &'a [usize],
    /// The number of leaves drawn so far.
    rows: usize,
    diagram: Diagram,
}

impl Drawing<'_> {
    /// Draws what follows a node that these hypotheses share; returns the height of the node.
    fn grow(&mut self, leaves: &[usize], depth: usize) -> f32 {
        let Some(frame) = self.frames.get(depth) else {
            self.rows += 1;
            return self.rows as f32 + 0.3;
        };
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for leaf in leaves {
            let claims = self.tree.claims(*leaf, *frame);
            match groups.iter_mut().find(|group| self.tree.claims(group[0], *frame) == claims) {
                Some(group) => group.push(*leaf),
                None => groups.push(vec![*leaf]),
            }
        }
        let heights: Vec<f32> = groups.iter().map(|group| self.grow(group, depth + 1)).collect();
        let middle = (heights.iter().copied().fold(f32::INFINITY, f32::min)
            + heights.iter().copied().fold(f32::NEG_INFINITY, f32::max))
            / 2.0;
        // The leading branch lies on top of the others.
        for (group, height) in groups.iter().zip(heights).rev() {
            let (role, is_faded) = self.look(group);
            let points = vec![[column(depth), middle], [column(depth) + 0.35, height], [column(depth + 1), height]];
            let width = if role == Role::Best { 2.5 } else { 1.2 };
            self.diagram.lines.push(DiagramLine { role, width, is_faded, points });
            self.node((depth + 1, height), group);
            if groups.len() > 1 && depth + 1 < self.frames.len() {
                let text = ratio(self.tree.probability(group[0], &self.frames[..=depth]));
                self.diagram.words.push(Words {
                    text,
                    role: Some(role),
                    at: [column(depth + 1) - 0.08, height - 0.35],
                    side: -1,
                });
            }
        }
        middle
    }

    /// The leading hypothesis stands out, deleted ones step back.
    fn look(&self, group: &[usize]) -> (Role, bool) {
        if group.contains(&0) {
            (Role::Best, false)
        } else if group.iter().all(|leaf| self.tree.leaves[*leaf].is_deleted) {
            (Role::Rejected, true)
        } else {
            (Role::Candidate, false)
        }
    }

    /// Draws a node, and beside a leaf its probability, its claims about the last frame, and the reason for its deletion.
    fn node(&mut self, (depth, height): (usize, f32), group: &[usize]) {
        let (role, is_faded) = self.look(group);
        let at = [column(depth), height];
        self.diagram.nodes.push(Node { role, is_faded, at, radius: if depth < self.frames.len() { 3.5 } else { 4.5 } });
        if depth < self.frames.len() {
            return;
        }
        let last = self.frames.last().map_or(&[][..], |frame| self.tree.claims(group[0], *frame));
        let why = if role == Role::Rejected { ", N-scan" } else { "" };
        let text = format!("{}{why}  {}", ratio(self.tree.probability(group[0], self.frames)), short(last));
        self.diagram.words.push(Words { text, role: Some(role), at: [at[0] + 0.12, height], side: 1 });
    }
}

fn short(claims: &[Claim]) -> String {
    let one = |claim: &Claim| {
        let detection = claim.detection + 1;
        match claim.origin {
            Origin::Track(id) => format!("{detection}→{id}"),
            Origin::New(id) => format!("{detection}→new {id}"),
            Origin::False => format!("{detection}→false"),
        }
    };
    let mut all: Vec<String> = claims.iter().take(CLAIMS).map(one).collect();
    if claims.len() > CLAIMS {
        all.push("…".into());
    }
    all.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(frame: usize, origin: Origin) -> Arc<Scan> {
        Arc::new(Scan { frame, tracks: Vec::new(), claims: vec![Claim { detection: 0, origin }] })
    }

    fn hypothesis(track: usize, probability: f64, past: &[&Arc<Scan>]) -> Hypothesis {
        let past = past.iter().map(|scan| Arc::clone(scan)).collect();
        Hypothesis { tracks: vec![track], ln_probability: probability.ln(), past }
    }

    #[test]
    fn branches_part_where_the_claims_do() {
        let [a, b] = [Origin::Track(1), Origin::False].map(|origin| scan(4, origin));
        let [c, d, e] = [Origin::Track(1), Origin::New(7), Origin::False].map(|origin| scan(5, origin));
        let hypotheses = vec![hypothesis(0, 0.75, &[&a, &c]), hypothesis(1, 0.25, &[&a, &d])];
        let cluster = Cluster { tracks: Vec::new(), hypotheses };
        let alone = Cluster { tracks: Vec::new(), hypotheses: vec![hypothesis(0, 1.0, &[&a])] };
        assert!(Tree::largest(std::slice::from_ref(&alone), &[]).is_none(), "a single hypothesis is no tree");
        let deleted = [Vec::new(), vec![hypothesis(2, 0.2, &[&b, &e])]];
        let tree = Tree::largest(&[alone, cluster], &deleted).expect("a tree");
        assert!(tree.has(&e) && !tree.has(&a));
        let diagram = tree.drawn(&["k best".into()]);
        // A root, two nodes in frame 4 and three in frame 5.
        assert_eq!((diagram.nodes.len(), diagram.lines.len()), (6, 5));
        let faded = diagram.lines.iter().filter(|line| line.is_faded && line.role == Role::Rejected).count();
        let leading = diagram.lines.iter().filter(|line| line.role == Role::Best).count();
        assert_eq!((faded, leading), (2, 2), "the deleted branch and the leading one have two lines each");
        let words: Vec<&str> = diagram.words.iter().map(|words| &words.text[..]).collect();
        // Before the deletion the kept ones had 0.8 in all.
        for text in ["0.600  1→1", "0.200  1→new 7", "0.200, N-scan  1→false", "0.800", "frame 4", "5", "k best"]
        {
            assert!(words.contains(&text), "{text} is missing in {words:?}");
        }
        let is_inside = |at: &[f32; 2]| (0..2).all(|i| (0.0..=diagram.size[i]).contains(&at[i]));
        assert!(diagram.lines.iter().flat_map(|line| &line.points).all(is_inside));
    }

    #[test]
    fn the_leader_stays_first_and_branches_count_what_is_not_drawn() {
        let [a, b] = [Origin::Track(1), Origin::False].map(|origin| scan(4, origin));
        let ends: Vec<_> = (0..20).map(|id| scan(5, Origin::New(id))).collect();
        // All are equally probable, and the deleted one by rounding a little more.
        let kept = ends.iter().map(|end| hypothesis(0, 0.05, &[&a, end])).collect();
        let cluster = Cluster { tracks: Vec::new(), hypotheses: kept };
        let deleted = [vec![hypothesis(1, 0.05 / 1.05 + 1e-12, &[&b, &ends[0]])]];
        let tree = Tree::largest(&[cluster], &deleted).expect("a tree");
        assert!(!tree.leaves[0].is_deleted && tree.leaves[1].is_deleted);
        let diagram = tree.drawn(&[]);
        let words: Vec<&str> = diagram.words.iter().map(|words| &words.text[..]).collect();
        // 20 of 21 equal hypotheses share the branch, 15 of them are drawn.
        assert!(words.contains(&"0.952") && words.contains(&"5 less probable ones are not drawn"), "{words:?}");
        assert!(diagram.summary.contains("Tree of 21 hypotheses"), "{}", diagram.summary);
    }
}
