//! Independent subtrees of supernodes for the branches of a parallel factorisation.

use std::ops::Range;

use super::fill::NONE;
use super::supernodes::Supernodes;

/// Threads the cut is balanced for. Results do not depend on the cut, only the time does.
const BALANCED_FOR: f64 = 4.0;
const MOST_BRANCHES: usize = 64;

/// Disjoint subtrees (as ranges of supernodes, ascending) and the supernodes above them.
#[derive(Debug, Clone, Default)]
pub(super) struct Schedule {
    pub(super) branches: Vec<Range<usize>>,
    /// Supernodes in no branch, children before parents.
    pub(super) trunk: Vec<usize>,
}

impl Schedule {
    /// Cuts the heaviest subtree below its root until that no longer shortens the time on four threads; without
    /// at least `least_flops` in all everything is trunk.
    pub(super) fn new(supernodes: &Supernodes, least_flops: f64) -> Self {
        let tree = Tree::new(supernodes);
        let total: f64 = tree.roots.iter().map(|&root| tree.subtree_flops[root]).sum();
        if total < least_flops {
            return Self { branches: Vec::new(), trunk: (0..supernodes.list.len()).collect() };
        }
        let roots = tree.best_cut(supernodes, total);
        let branches: Vec<Range<usize>> = roots.iter().map(|&root| tree.first[root]..root + 1).collect();
        let mut covered = vec![false; supernodes.list.len()];
        branches.iter().for_each(|branch| covered[branch.clone()].fill(true));
        let trunk = (0..covered.len()).filter(|&s| !covered[s]).collect();
        Self { branches, trunk }
    }
}

struct Tree {
    roots: Vec<usize>,
    children: Vec<Vec<u32>>,
    /// First supernode of the subtree of every supernode.
    first: Vec<usize>,
    subtree_flops: Vec<f64>,
}

impl Tree {
    fn new(supernodes: &Supernodes) -> Self {
        let n = supernodes.list.len();
        let mut tree = Self {
            roots: Vec::new(),
            children: vec![Vec::new(); n],
            first: (0..n).collect(),
            subtree_flops: supernodes.list.iter().map(|s| s.flops()).collect(),
        };
        for (s, supernode) in supernodes.list.iter().enumerate() {
            if supernode.parent == NONE {
                tree.roots.push(s);
            } else {
                let parent = supernode.parent as usize;
                tree.children[parent].push(s as u32);
                tree.first[parent] = tree.first[parent].min(tree.first[s]);
                tree.subtree_flops[parent] += tree.subtree_flops[s];
            }
        }
        tree
    }

    fn best_cut(&self, supernodes: &Supernodes, total: f64) -> Vec<usize> {
        let mut roots = self.roots.clone();
        let mut trunk = 0.0;
        let mut best = (total, Vec::new());
        while roots.len() <= MOST_BRANCHES && trunk < best.0 {
            let heaviest = (0..roots.len()).max_by(|&a, &b| {
                let flops = |i: usize| self.subtree_flops[roots[i]];
                flops(a).total_cmp(&flops(b))
            });
            let Some(heaviest) = heaviest else { break };
            let time = trunk + self.subtree_flops[roots[heaviest]].max((total - trunk) / BALANCED_FOR);
            if roots.len() > 1 && time < best.0 {
                best = (time, roots.clone());
            }
            let cut = roots.swap_remove(heaviest);
            trunk += supernodes.list[cut].flops();
            roots.extend(self.children[cut].iter().map(|&child| child as usize));
        }
        best.1.sort_unstable();
        best.1
    }
}
