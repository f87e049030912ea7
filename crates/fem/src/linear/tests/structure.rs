//! Pattern, graph, levels, elimination and supernodes against brute force.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::fixtures::{Grid, Random, pattern_of, random_cliques};
use crate::linear::cross_sections::cross_sections;
use crate::linear::dissection::nested_dissection;
use crate::linear::fill::{Elimination, NONE, invert, postorder};
use crate::linear::graph::Graph;
use crate::linear::levels::{Origin, components};
use crate::linear::ordering::choose;
use crate::linear::supernodes::{Limits, Supernodes};
use crate::linear::{LinearError, Ordering, Relaxation, SparsePattern, Storage};

const RELAXATION: [Relaxation; 2] = [Relaxation { columns: 12, zeros: 0.8 }, Relaxation { columns: 32, zeros: 0.2 }];

fn brute_force(n: usize, cliques: &[Vec<u32>], storage: Storage) -> Vec<BTreeSet<u32>> {
    let mut columns: Vec<BTreeSet<u32>> = (0..n as u32).map(|i| BTreeSet::from([i])).collect();
    for dofs in cliques {
        for &col in dofs {
            let stored = dofs.iter().filter(|&&row| storage == Storage::Full || row >= col);
            columns[col as usize].extend(stored);
        }
    }
    columns
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn pattern_is_the_union_of_its_cliques(n in 1usize..40, count in 0usize..20, size in 1usize..9, seed: u64) {
        let cliques = random_cliques(n, count, size, &mut Random(seed));
        for storage in [Storage::Lower, Storage::Full] {
            let pattern = pattern_of(n, &cliques, storage);
            for (col, rows) in brute_force(n, &cliques, storage).iter().enumerate() {
                prop_assert!(pattern.column(col).iter().eq(rows.iter()));
                for row in 0..n {
                    let slot = pattern.slot(row, col);
                    prop_assert_eq!(slot.is_some(), rows.contains(&(row as u32)));
                    prop_assert!(slot.is_none_or(|slot| pattern.row_indices()[slot] as usize == row));
                }
            }
        }
    }

    #[test]
    fn column_counts_are_those_of_the_factor(n in 1usize..40, count in 0usize..15, size in 2usize..6, seed: u64) {
        let mut random = Random(seed);
        let pattern = pattern_of(n, &random_cliques(n, count, size, &mut random), Storage::Lower);
        let graph = Graph::compress(&pattern);
        let order = random.permutation(graph.len());
        let elimination = Elimination::new(&graph, &order);
        let columns = eliminate(&pattern, &graph.expand(&order));
        let mut first = 0;
        for (place, &vertex) in order.iter().enumerate() {
            prop_assert_eq!(elimination.count[place] as usize, columns[first].len());
            first += graph.weight[vertex as usize] as usize;
        }
        let fill = elimination.estimate(&graph, &order);
        prop_assert_eq!(fill.nonzeros, columns.iter().map(|c| c.len() as f64).sum::<f64>());
        prop_assert_eq!(fill.flops, columns.iter().map(|c| (c.len() as f64).powi(2)).sum::<f64>());
    }

    #[test]
    fn supernodes_hold_the_factor(n in 1usize..50, count in 0usize..20, size in 2usize..6, widest in 1usize..9, seed: u64) {
        let pattern = pattern_of(n, &random_cliques(n, count, size, &mut Random(seed)), Storage::Lower);
        let graph = Graph::compress(&pattern);
        let (choice, _) = choose(&graph, None).unwrap();
        let limits = Limits { relaxation: &RELAXATION, widest };
        let supernodes = Supernodes::new(&graph, &choice.order, &choice.elimination, &limits);
        let columns = eliminate(&pattern, &graph.expand(&choice.order));
        let mut next = 0;
        for supernode in &supernodes.list {
            prop_assert_eq!(supernode.begin, next);
            next = supernode.end;
            let mut rows: BTreeSet<usize> = (supernode.begin..supernode.end).collect();
            rows.extend(supernodes.runs(supernode).iter().flat_map(|run| run.begin as usize..run.end as usize));
            prop_assert_eq!(rows.len(), supernode.rows);
            prop_assert!(columns[supernode.begin..supernode.end].iter().all(|column| column.is_subset(&rows)));
            for (local, &row) in rows.iter().enumerate() {
                prop_assert_eq!(supernodes.local_row(supernode, row), local);
            }
            let parent = rows.range(supernode.end..).next();
            prop_assert_eq!(supernode.parent, parent.map_or(NONE, |&row| supernodes.of_unknown[row]));
        }
        prop_assert_eq!(next, n);
    }

    #[test]
    fn levels_touch_only_their_neighbours(n in 1usize..60, count in 0usize..40, size in 2usize..5, seed: u64) {
        let pattern = pattern_of(n, &random_cliques(n, count, size, &mut Random(seed)), Storage::Full);
        let graph = Graph::compress(&pattern);
        for origin in [Origin::Section, Origin::Vertex] {
            let components = components(&graph, origin);
            let mut place = vec![None; graph.len()];
            for (number, levels) in components.iter().enumerate() {
                for level in 0..levels.len() {
                    for &vertex in levels.level(level) {
                        prop_assert_eq!(place[vertex as usize].replace((number, level)), None);
                    }
                }
            }
            for vertex in 0..graph.len() as u32 {
                let (number, level) = place[vertex as usize].unwrap();
                for &other in graph.neighbours(vertex) {
                    let (other_number, other_level) = place[other as usize].unwrap();
                    prop_assert_eq!(number, other_number);
                    prop_assert!(level.abs_diff(other_level) <= 1);
                }
            }
        }
    }
}

/// Rows of every column of the factor by symbolic elimination.
fn eliminate(pattern: &SparsePattern, order: &[u32]) -> Vec<BTreeSet<usize>> {
    let position = invert(order);
    let mut columns: Vec<BTreeSet<usize>> = (0..pattern.n()).map(|i| BTreeSet::from([i])).collect();
    for col in 0..pattern.n() {
        for &row in pattern.column(col) {
            let (a, b) = (position[row as usize] as usize, position[col] as usize);
            columns[a.min(b)].insert(a.max(b));
        }
    }
    for col in 0..pattern.n() {
        let below: Vec<usize> = columns[col].range(col + 1..).copied().collect();
        if let Some(&parent) = below.first() {
            columns[parent].extend(below);
        }
    }
    columns
}

#[test]
fn unknown_beyond_the_system_is_an_error() {
    let cliques = [vec![0, 1], vec![1, 3]];
    let error = SparsePattern::from_cliques(3, cliques.iter().map(Vec::as_slice), Storage::Full).unwrap_err();
    assert_eq!(error, LinearError::DofOutOfRange { clique: 1, dof: 3, n: 3 });
}

#[test]
fn nodes_are_the_vertices_of_a_grid() {
    let grid = Grid::new(3, 4, 5);
    let renumbered = grid.renumbered(&Random(7).permutation(grid.n));
    for grid in [&grid, &renumbered] {
        for storage in [Storage::Lower, Storage::Full] {
            let graph = Graph::compress(&grid.pattern(storage));
            assert_eq!(graph.len(), 60);
            assert!(graph.weight.iter().all(|&weight| weight == 3));
        }
    }
}

#[test]
fn layers_of_a_slender_grid_are_its_sections() {
    let graph = Graph::compress(&Grid::new(4, 4, 20).pattern(Storage::Lower));
    let levels = &components(&graph, Origin::Section)[0];
    assert_eq!(levels.len(), 20);
    assert!((0..20).all(|number| levels.level(number).len() == 16));
}

#[test]
fn slender_grids_are_ordered_by_layers_and_cubes_by_dissection() {
    let ordering = |nx, ny, nz| {
        let graph = Graph::compress(&Grid::new(nx, ny, nz).pattern(Storage::Lower));
        let (choice, candidates) = choose(&graph, None).unwrap();
        let least = candidates.iter().map(|c| c.fill.flops).fold(f64::INFINITY, f64::min);
        assert!(choice.candidate.fill.flops <= 1.05 * least);
        choice.candidate.ordering
    };
    assert!(matches!(ordering(5, 5, 60), Ordering::TwistedLayers | Ordering::TwistedWavefront));
    assert!(matches!(ordering(14, 14, 14), Ordering::NestedDissection | Ordering::CrossSections));
}

#[test]
fn dissection_is_a_repeatable_permutation() {
    let graph = Graph::compress(&Grid::new(9, 9, 9).pattern(Storage::Lower));
    let first = nested_dissection(&graph).unwrap();
    assert_eq!(first, nested_dissection(&graph).unwrap());
    let mut sorted = first;
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..graph.len() as u32));
}

/// The work of a slender body grows with its length: that of the cuts between parts does so exactly, that of nested
/// dissection only in the end.
#[test]
fn cross_sections_are_permutations_whose_work_grows_with_the_length() {
    let flops = |nz| {
        let graph = Graph::compress(&Grid::new(8, 8, nz).pattern(Storage::Lower));
        let sections = cross_sections(&graph, &components(&graph, Origin::Section)).unwrap().unwrap();
        for order in sections.orders.into_iter().chain([sections.nested]) {
            let mut sorted = order;
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..graph.len() as u32));
        }
        choose(&graph, Some(Ordering::CrossSections)).unwrap().0.candidate.fill.flops
    };
    let (short, long) = (flops(60), flops(240));
    assert!(long < 4.6 * short, "{short:e} {long:e}");
}

/// Bricks one face of which is bridged over several rows of nodes, as by contact.
fn bridged(nz: usize, rows: usize) -> Graph {
    let (nx, ny) = (5, 5);
    let mut grid = Grid::new(nx, ny, nz);
    for k in 0..nz - rows {
        let nodes = (k..=k + rows).flat_map(|k| (0..ny).map(move |j| nx - 1 + nx * (j + ny * k)));
        grid.elements.push(nodes.flat_map(|node| [0, 1, 2].map(|c| (3 * node + c) as u32)).collect());
    }
    Graph::compress(&grid.pattern(Storage::Lower))
}

/// A wavefront is thicker at the bridged face than inside, which layers and plane cuts cannot be.
#[test]
fn a_wavefront_is_thin_where_edges_are_short() {
    let graph = bridged(80, 4);
    let flops = |ordering| choose(&graph, Some(ordering)).unwrap().0.candidate.fill.flops;
    let others = [Ordering::Layers, Ordering::TwistedLayers, Ordering::NestedDissection, Ordering::CrossSections];
    let others = others.map(flops).into_iter().fold(f64::INFINITY, f64::min);
    for ordering in [Ordering::Wavefront, Ordering::TwistedWavefront] {
        assert!(flops(ordering) < 0.8 * others, "{ordering:?}: {:e} against {others:e}", flops(ordering));
    }
}

#[test]
fn wavefronts_are_permutations() {
    let mut graphs = vec![bridged(20, 4)];
    for [nx, ny, nz] in [[2, 2, 2], [2, 2, 3], [3, 4, 9]] {
        graphs.push(Graph::compress(&Grid::new(nx, ny, nz).pattern(Storage::Lower)));
    }
    for seed in 0..50 {
        let n = 1 + seed as usize;
        graphs.push(Graph::compress(&pattern_of(n, &random_cliques(n, n, 3, &mut Random(seed)), Storage::Lower)));
    }
    for graph in graphs {
        for ordering in [Ordering::Wavefront, Ordering::TwistedWavefront] {
            let mut order = choose(&graph, Some(ordering)).unwrap().0.order;
            order.sort_unstable();
            assert!(order.into_iter().eq(0..graph.len() as u32), "{ordering:?}");
        }
    }
}

#[test]
fn postorder_visits_children_first_and_siblings_in_order() {
    let parent = [5, 2, 4, 4, 5, NONE, 7, NONE];
    assert_eq!(postorder(&parent), [0, 1, 2, 3, 4, 5, 6, 7]);
    let parent = [3, 2, NONE, 2];
    assert_eq!(postorder(&parent), [1, 0, 3, 2]);
}
