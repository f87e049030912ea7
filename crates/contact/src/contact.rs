//! A pair of surfaces as a contribution to residual and tangent.

use std::sync::Arc;

use nalgebra::Vector3;
use subrope_fem::analysis::Analysis;
use subrope_fem::{
    Configuration, Contribution, Energies, FemError, Request, Sink, StateError, StateReader, StateWriter, Verdict,
};

use crate::foot::{Local, Place, Posture, project};
use crate::kernel::{PairBuffer, PointTerms, terms};
use crate::patch::{PATCH_NODES, PatchKind};
use crate::point::{History, Point, PointRecord, Ramp, Touch};
use crate::search::Tree;
use crate::{ContactError, ContactOptions, FrictionTangent, Method, Surface};

/// How far from its edges a patch counts as near, in its coordinates: its neighbours become candidates too.
const MARGIN: f64 = 0.3;
/// Depth of the toe of a law that is softened, over the reach.
const SOFT: f64 = 0.01;
/// Candidates are dropped when so many times more are kept than are near.
const STALE: usize = 4;

/// Contact of a secondary surface, which carries the integration points, with a primary one.
pub struct Contact {
    name: String,
    pub(crate) primary: Surface,
    pub(crate) secondary: Surface,
    positions: Vec<Vector3<f64>>,
    options: ContactOptions,
    pub(crate) points: Vec<Point>,
    per_patch: usize,
    pub(crate) pairs: Pairs,
    tree: Tree,
    pub(crate) rounds: usize,
    /// Toe of the trial, where the law is softened \[mm\].
    softened: f64,
    pub(crate) fresh: bool,
    /// Whether the primary surface goes on beyond its edges in truth.
    confined: bool,
    buffers: Vec<PairBuffer>,
}

/// Secondary and primary patches.
type PairList = Vec<(u32, u32)>;

/// Pairs of patches that may touch: the elements of the contribution.
#[derive(Default)]
pub(crate) struct Pairs {
    /// First pair of every secondary patch, and the end.
    starts: Vec<usize>,
    primary: Vec<u32>,
    node_starts: Vec<usize>,
    nodes: Vec<u32>,
}

/// State of a contact as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactReport {
    /// Integration points under pressure.
    pub touching: usize,
    /// Reference area under pressure \[mm^2\].
    pub area: f64,
    /// Sum of the pressure over the area \[N\].
    pub normal: f64,
    /// Sum of the friction traction over the area \[N\].
    pub friction: f64,
    /// Largest pressure \[MPa\].
    pub pressure: f64,
    /// Largest penetration \[mm\].
    pub penetration: f64,
    /// Friction work since the start \[mJ\].
    pub work: f64,
}

/// The contacts among the contributions of an analysis, in their order.
pub fn contacts(analysis: &Analysis) -> impl Iterator<Item = &Contact> {
    analysis.model().contributions.iter().filter_map(|c| c.as_any()?.downcast_ref())
}

impl Contact {
    /// A contact of `secondary` with `primary`; `positions` are the reference positions of all nodes \[mm\].
    ///
    /// # Errors
    /// [`ContactError`]: options out of range, empty surfaces, a node that belongs to both.
    pub fn new(
        name: &str,
        primary: Surface,
        secondary: Surface,
        positions: &[Vector3<f64>],
        options: ContactOptions,
    ) -> Result<Self, ContactError> {
        options.validate()?;
        if primary.patch_count() == 0 || secondary.patch_count() == 0 {
            return Err(ContactError::Empty { name: name.into() });
        }
        let own = primary.all_nodes();
        if let Some(&node) = secondary.all_nodes().iter().find(|n| own.binary_search(n).is_ok()) {
            return Err(ContactError::SharedNode { name: name.into(), node });
        }
        let points = points(&secondary, positions, options.points);
        Ok(Self {
            name: name.into(),
            primary,
            secondary,
            positions: positions.to_vec(),
            options,
            points,
            per_patch: options.points[0] * options.points[1],
            pairs: Pairs::default(),
            tree: Tree::default(),
            rounds: 0,
            softened: 0.0,
            fresh: true,
            confined: false,
            buffers: Vec::new(),
        })
    }

    /// The same for a primary surface that goes on beyond its edges in truth, as the images of a strand do: a point
    /// that comes near a patch at an edge is an error then, and not a contact lost.
    #[must_use]
    pub fn confined(self) -> Self {
        Self { confined: true, ..self }
    }

    /// Name of the pair.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The settings.
    #[must_use]
    pub fn options(&self) -> &ContactOptions {
        &self.options
    }

    /// The surface that carries the integration points.
    #[must_use]
    pub fn secondary(&self) -> &Surface {
        &self.secondary
    }

    /// The other surface.
    #[must_use]
    pub fn primary(&self) -> &Surface {
        &self.primary
    }

    /// All integration points at the committed state, patch by patch.
    pub fn points(&self) -> impl Iterator<Item = PointRecord<'_>> {
        let per_patch = self.per_patch;
        self.points.iter().enumerate().map(move |(i, p)| PointRecord {
            patch: i / per_patch,
            area: p.area,
            state: &p.old,
        })
    }

    /// Where all integration points are at nodal displacements, patch by patch \[mm\].
    pub fn places<'a>(&'a self, displacement: &'a [f64]) -> impl Iterator<Item = Vector3<f64>> + 'a {
        let per_patch = self.per_patch;
        self.points
            .iter()
            .enumerate()
            .map(move |(i, p)| combine(&p.own, &self.secondary.gather(i / per_patch, &self.positions, displacement)))
    }

    /// Feet and gaps \[mm\] of all integration points at nodal displacements, patch by patch; [`None`] where the
    /// primary surface is out of reach. Gaps are those of the surfaces themselves: an overlap at the start is not
    /// taken off.
    pub fn gaps<'a>(&'a self, displacement: &'a [f64]) -> impl Iterator<Item = Option<(Place, f64)>> + 'a {
        let primary = Posture { surface: &self.primary, positions: &self.positions, displacement };
        self.points.iter().zip(self.places(displacement)).map(move |(point, x)| {
            let foot = project(&primary, &x, point.hint.or(point.old.place)?)?;
            (foot.gap < self.options.reach).then_some((foot.place, foot.gap))
        })
    }

    /// Sums and extremes of the committed state.
    #[must_use]
    pub fn report(&self) -> ContactReport {
        let mut out = ContactReport::default();
        for point in &self.points {
            let state = &point.old;
            out.work += point.area * state.work;
            if state.pressure > 0.0 {
                out.touching += 1;
                out.area += point.area;
                out.normal += point.area * state.pressure;
                out.friction += point.area * state.traction.norm();
                out.pressure = out.pressure.max(state.pressure);
                out.penetration = out.penetration.max(-state.gap);
            }
        }
        out
    }

    /// Largest initial overlap \[mm\], positive.
    #[must_use]
    pub fn initial_overlap(&self) -> f64 {
        self.points.iter().fold(0.0, |most, p| most.max(-p.overlap))
    }

    /// Feet of all points near the primary surface at some displacements; sets their hints. Answers secondary patch,
    /// foot and gap; an error beyond the edge of a surface that goes on there.
    fn feet(&mut self, displacement: &[f64]) -> Result<Vec<(u32, Place, f64)>, FemError> {
        let primary = Posture { surface: &self.primary, positions: &self.positions, displacement };
        let secondary = Posture { surface: &self.secondary, positions: &self.positions, displacement };
        let unbounded = self.primary.kind(0).is_unbounded();
        if !unbounded {
            self.tree.fit(&primary);
        }
        let (mut out, mut beyond) = (Vec::new(), None);
        for patch in 0..self.secondary.patch_count() {
            let near = if unbounded { vec![0] } else { self.tree.near(&secondary, patch, self.options.reach) };
            if near.is_empty() {
                continue;
            }
            let nodal = secondary.gather(patch);
            for point in &mut self.points[patch * self.per_patch..(patch + 1) * self.per_patch] {
                let x = combine(&point.own, &nodal);
                let found = point.hint.and_then(|hint| project(&primary, &x, hint));
                let found = found
                    .filter(|f| f.gap < self.options.reach)
                    .or_else(|| project(&primary, &x, nearest(&primary, &near, &x)));
                let Some(foot) = found else { continue };
                point.hint = Some(foot.place);
                if foot.gap < self.options.reach {
                    let at_edge = self.confined && self.primary.is_at_edge(foot.place.patch as usize);
                    // A foot on the far side of a body belongs to no contact.
                    beyond = beyond.or((at_edge && foot.gap > -self.options.reach).then_some(foot.gap));
                    out.push((patch as u32, foot.place, foot.gap));
                }
            }
        }
        beyond.map_or(Ok(out), |gap| Err(self.beyond(gap)))
    }

    /// Pairs around all feet, sorted: those needed now, and those that may soon be.
    fn candidates(&self, feet: &[(u32, Place, f64)]) -> (PairList, PairList) {
        let (mut needed, mut wide) = (Vec::new(), Vec::new());
        for &(patch, place, gap) in feet {
            if gap < 0.5 * self.options.reach {
                needed.push((patch, place.patch));
            }
            wide.push((patch, place.patch));
            if self.primary.kind(place.patch as usize).is_unbounded() {
                continue;
            }
            let close = |edge: u8| match edge {
                0 => place.xi[1] < MARGIN - 1.0,
                1 => place.xi[0] > 1.0 - MARGIN,
                2 => place.xi[1] > 1.0 - MARGIN,
                _ => place.xi[0] < MARGIN - 1.0,
            };
            for edge in (0..4).filter(|e| close(*e)) {
                if let Some((next, at)) = self.primary.cross(place.patch as usize, edge, place.xi) {
                    wide.push((patch, next as u32));
                    for turn in [(edge + 1) % 4, (edge + 3) % 4] {
                        let diagonal =
                            if close(turn) { corner(&self.primary, place, edge, turn, at, next) } else { None };
                        wide.extend(diagonal.map(|d| (patch, d)));
                    }
                }
            }
        }
        for list in [&mut needed, &mut wide] {
            list.sort_unstable();
            list.dedup();
        }
        (needed, wide)
    }

    fn beyond(&self, gap: f64) -> FemError {
        refused(ContactError::BeyondImages { name: self.name.clone(), gap })
    }

    fn failure(&self, gap: f64) -> FemError {
        refused(ContactError::NoFoot { name: self.name.clone(), gap })
    }
}

/// The patch across a corner: through the neighbour beyond `edge`, then on in the direction of `turn`.
fn corner(surface: &Surface, place: Place, edge: u8, turn: u8, at: [f64; 2], next: usize) -> Option<u32> {
    // The same turn, seen from the neighbour: push the point far over the edge and see which side of it it leaves.
    let mut pushed = place.xi;
    match turn {
        0 => pushed[1] -= 1.0,
        1 => pushed[0] += 1.0,
        2 => pushed[1] += 1.0,
        _ => pushed[0] -= 1.0,
    }
    let (_, moved) = surface.cross(place.patch as usize, edge, pushed)?;
    let (dx, dy) = (moved[0] - at[0], moved[1] - at[1]);
    let side = if dx.abs() > dy.abs() {
        if dx > 0.0 { 1 } else { 3 }
    } else if dy > 0.0 {
        2
    } else {
        0
    };
    surface.cross(next, side, at).map(|(d, _)| d as u32)
}

fn refused(cause: ContactError) -> FemError {
    FemError::Contribution { source: Arc::new(cause), recoverable: true }
}

impl Pairs {
    pub(crate) fn new(list: &[(u32, u32)], primary: &Surface, secondary: &Surface) -> Self {
        let mut out = Self { node_starts: vec![0], ..Self::default() };
        let mut at = 0;
        for patch in 0..secondary.patch_count() {
            out.starts.push(at);
            while at < list.len() && list[at].0 as usize == patch {
                out.primary.push(list[at].1);
                out.nodes.extend_from_slice(secondary.nodes(patch));
                out.nodes.extend_from_slice(primary.nodes(list[at].1 as usize));
                out.node_starts.push(out.nodes.len());
                at += 1;
            }
        }
        out.starts.push(at);
        out
    }

    pub(crate) fn list(&self) -> Vec<(u32, u32)> {
        let patches = (0_u32..).zip(self.starts.windows(2));
        patches.flat_map(|(s, w)| self.primary[w[0]..w[1]].iter().map(move |p| (s, *p))).collect()
    }

    /// Range of the pairs of a secondary patch.
    fn of(&self, patch: usize) -> std::ops::Range<usize> {
        match self.starts.get(patch..patch + 2) {
            Some(w) => w[0]..w[1],
            None => 0..0,
        }
    }
}

fn combine(weights: &[f64; PATCH_NODES], nodal: &[Vector3<f64>; PATCH_NODES]) -> Vector3<f64> {
    weights.iter().zip(nodal).map(|(w, x)| x * *w).sum()
}

/// Middle of the nearest of some patches.
fn nearest(posture: &Posture<'_>, patches: &[u32], x: &Vector3<f64>) -> Place {
    let middle = |p: u32| Place { patch: p, xi: [0.0, 0.0] };
    let distance = |p: u32| (posture.position(&middle(p)) - x).norm_squared();
    let best = patches.iter().map(|&p| (distance(p), p)).min_by(|a, b| a.0.total_cmp(&b.0));
    middle(best.map_or(0, |(_, p)| p))
}

/// Integration points of all patches: midpoints of equal parts on smooth patches, Gauss points on facets.
fn points(surface: &Surface, positions: &[Vector3<f64>], count: [usize; 2]) -> Vec<Point> {
    let rest = vec![0.0; 3 * positions.len()];
    let mut out = Vec::with_capacity(surface.patch_count() * count[0] * count[1]);
    for patch in 0..surface.patch_count() {
        let kind = surface.kind(patch);
        let lines = count.map(|n| if matches!(kind, PatchKind::Spline(_)) { midpoints(n) } else { gauss(n) });
        let nodal = surface.gather(patch, positions, &rest);
        for (y, wy) in &lines[1] {
            for (x, wx) in &lines[0] {
                let local = Local::new(kind.shape([*x, *y]), &nodal);
                let area = local.tangents[0].cross(&local.tangents[1]).norm() * wx * wy;
                out.push(Point {
                    own: local.shape.value,
                    area,
                    overlap: 0.0,
                    hint: None,
                    frozen: 0.0,
                    pulling: 0.0,
                    multiplier: 0.0,
                    committed_multiplier: 0.0,
                    old: History::default(),
                    new: History::default(),
                });
            }
        }
    }
    out
}

/// Middles of `n` equal parts of \[-1, 1\] and their lengths.
fn midpoints(n: usize) -> Vec<(f64, f64)> {
    let h = 2.0 / n as f64;
    (0..n).map(|i| (h * (i as f64 + 0.5) - 1.0, h)).collect()
}

/// Gauss points of \[-1, 1\] by Newton's iteration on the Legendre polynomial.
fn gauss(n: usize) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut before, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
        }
        let value = if n == 0 { 1.0 } else { value };
        (value, n as f64 * (x * value - before) / (x * x - 1.0))
    };
    let place = |i: usize| {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..20 {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let slope = legendre(x).1;
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(place).collect()
}

impl Contribution for Contact {
    fn element_count(&self) -> usize {
        self.pairs.primary.len()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.pairs.nodes[self.pairs.node_starts[element]..self.pairs.node_starts[element + 1]]
    }

    fn is_symmetric(&self) -> bool {
        true
    }

    fn has_products(&self) -> bool {
        self.options.friction > 0.0 && self.options.tangent == FrictionTangent::Exact
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn freeze(&mut self) -> f64 {
        if self.options.friction == 0.0 {
            return 0.0;
        }
        let options = self.options_of_trial();
        self.points.iter_mut().map(|p| p.area * p.freeze(&options)).sum()
    }

    fn is_intermittent(&self) -> bool {
        true
    }

    fn prepare(&mut self, displacement: &[f64]) -> Result<bool, FemError> {
        let feet = self.feet(displacement)?;
        if std::mem::take(&mut self.fresh) && self.options.ramp > 0.0 {
            self.note_overlap(displacement);
        }
        let (needed, wide) = self.candidates(&feet);
        let current = self.pairs.list();
        let known = |pair: &(u32, u32)| current.binary_search(pair).is_ok();
        let built = !self.pairs.starts.is_empty();
        if built && needed.iter().all(known) {
            return Ok(false);
        }
        let mut list = wide;
        if current.len() <= STALE * list.len() {
            list.extend(current);
            list.sort_unstable();
            list.dedup();
        }
        self.pairs = Pairs::new(&list, &self.primary, &self.secondary);
        Ok(true)
    }

    fn assemble(
        &mut self,
        configuration: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError> {
        let mut energies = Energies::ZERO;
        let mut buffers = std::mem::take(&mut self.buffers);
        for patch in 0..self.secondary.patch_count() {
            let pairs = self.pairs.of(patch);
            if pairs.is_empty() {
                continue;
            }
            buffers.resize_with(buffers.len().max(pairs.len()), PairBuffer::default);
            let mut used = vec![false; pairs.len()];
            energies += self.assemble_patch(patch, configuration, request, &mut buffers, &mut used)?;
            for ((element, buffer), used) in pairs.zip(&buffers).zip(used) {
                if used {
                    let stiffness = (request == Request::Tangent).then_some(buffer.stiffness.as_slice());
                    sink.add(element, &buffer.force, stiffness);
                    let products: Vec<_> = buffer.products().collect();
                    if !products.is_empty() {
                        sink.add_products(element, &products);
                    }
                }
            }
        }
        self.buffers = buffers;
        Ok(energies)
    }

    fn commit(&mut self) {
        self.points.iter_mut().for_each(Point::commit);
        self.rounds = 0;
    }

    fn revert(&mut self) {
        self.points.iter_mut().for_each(Point::revert);
        self.rounds = 0;
    }

    fn save(&self, state: &mut dyn StateWriter) -> Result<(), StateError> {
        self.save_state(state)
    }

    fn restore(&mut self, state: &dyn StateReader) -> Result<(), StateError> {
        self.restore_state(state)
    }

    fn review(&mut self) -> Result<Verdict, FemError> {
        let Method::Augmented { penetration: wanted, rounds } = self.options.method else {
            return Ok(Verdict::Accepted);
        };
        let touching = self.points.iter().filter(|p| p.new.pressure > 0.0);
        let penetration = touching.fold(0.0_f64, |most, p| most.max(-p.new.gap));
        if penetration <= wanted {
            return Ok(Verdict::Accepted);
        }
        if self.rounds >= rounds {
            let name = self.name.clone();
            return Err(refused(ContactError::Penetration { name, penetration, wanted, rounds }));
        }
        self.rounds += 1;
        self.points.iter_mut().for_each(|p| p.multiplier = p.new.pressure);
        Ok(Verdict::Augmented)
    }

    /// With a toe, which gets shallower. Multipliers hold what the law itself presses: an augmented Lagrangian stays
    /// as it is.
    fn soften(&mut self, part: f64) -> bool {
        let can = self.options.method == Method::Penalty;
        self.softened = if can { part * SOFT * self.options.reach } else { 0.0 };
        can
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }
}

impl Contact {
    /// The options, softened.
    fn options_of_trial(&self) -> ContactOptions {
        ContactOptions { toe: self.options.toe.max(self.softened), ..self.options }
    }

    /// Notes the gaps at the start where they are negative.
    fn note_overlap(&mut self, displacement: &[f64]) {
        let primary = Posture { surface: &self.primary, positions: &self.positions, displacement };
        for patch in 0..self.secondary.patch_count() {
            let nodal = self.secondary.gather(patch, &self.positions, displacement);
            for point in &mut self.points[patch * self.per_patch..(patch + 1) * self.per_patch] {
                let x = combine(&point.own, &nodal);
                let foot = point.hint.and_then(|hint| project(&primary, &x, hint));
                point.overlap = foot.map_or(0.0, |f| f.gap.min(0.0));
            }
        }
    }

    fn assemble_patch(
        &mut self,
        patch: usize,
        configuration: &Configuration<'_>,
        request: Request,
        buffers: &mut [PairBuffer],
        used: &mut [bool],
    ) -> Result<Energies, FemError> {
        let pairs = self.pairs.of(patch);
        let posture = |displacement| Posture { surface: &self.primary, positions: &self.positions, displacement };
        let (now, committed) = (posture(configuration.displacement), posture(configuration.committed));
        let options = self.options_of_trial();
        let ramp = Ramp::new(self.options.ramp, configuration.time, configuration.time_increment);
        let nodal = self.secondary.gather(patch, &self.positions, configuration.displacement);
        let count = self.secondary.nodes(patch).len();
        let symmetric = self.options.tangent == FrictionTangent::Symmetric;
        let mut energies = Energies::ZERO;
        let (mut no_foot, mut beyond) = (None, None);
        for point in &mut self.points[patch * self.per_patch..(patch + 1) * self.per_patch] {
            let x = combine(&point.own, &nodal);
            let Some(foot) = point.hint.or(point.old.place).and_then(|hint| project(&now, &x, hint)) else {
                beyond = beyond.or((self.confined && point.old.pressure > 0.0).then_some(point.old.gap));
                point.pulling = 0.0;
                point.new = History { place: None, gap: f64::INFINITY, ..point.old };
                (point.new.pressure, point.new.traction) = (0.0, Vector3::zeros());
                continue;
            };
            let (touch, e) = point.evaluate(&foot, &committed, &options, ramp, configuration.predicting);
            energies.potential += point.area * e.potential;
            energies.contact_stored += point.area * e.stored;
            energies.contact_friction += point.area * e.friction;
            energies.interference += point.area * e.interference;
            let Some(Touch { pressure, friction }) = touch else { continue };
            let Ok(at) = self.pairs.primary[pairs.clone()].binary_search(&foot.place.patch) else {
                return Err(FemError::SearchOutdated);
            };
            let third = foot.local.third(&now.gather(foot.place.patch as usize));
            let parts = friction.as_ref().map(|f| (f, &third));
            let Some(terms) = terms(&foot, pressure, parts, symmetric) else {
                no_foot = Some(foot.gap);
                continue;
            };
            let buffer = &mut buffers[at];
            if !used[at] {
                buffer.reset(count + foot.local.shape.n, request == Request::Tangent);
                used[at] = true;
            }
            spread(buffer, &terms, point, count, &foot);
        }
        match (no_foot, beyond) {
            (Some(gap), _) => Err(self.failure(gap)),
            (None, Some(gap)) => Err(self.beyond(gap)),
            (None, None) => Ok(energies),
        }
    }
}

fn spread(buffer: &mut PairBuffer, terms: &PointTerms, point: &Point, count: usize, foot: &crate::foot::Foot) {
    buffer.spread(terms, &point.own, count, foot, point.area);
}
