//! What a contact remembers, kept and taken up.
//!
//! The list of pairs is kept, since it depends on where the surfaces have been before; so are the places where projections
//! start. The tree of the search is not: whatever its shape, it finds the same patches.

use nalgebra::{Vector2, Vector3};
use subrope_fem::{StateError, StateReader, StateWriter};

use crate::contact::{Contact, Pairs};
use crate::foot::Place;
use crate::point::{History, Point};

/// Patch of a place that is none.
const NONE: u64 = u64::MAX;
/// Numbers and counts of a point.
const NUMBERS: usize = 19;
const COUNTS: usize = 2;

impl Contact {
    pub(crate) fn save_state(&self, state: &mut dyn StateWriter) -> Result<(), StateError> {
        let points = &self.points;
        state.numbers("points", NUMBERS * points.len(), &mut points.iter().flat_map(numbers))?;
        let patches = |p: &Point| [p.hint, p.old.place].map(|place| place.map_or(NONE, |at| u64::from(at.patch)));
        state.counts("patches", COUNTS * points.len(), &mut points.iter().flat_map(patches))?;
        let pairs = self.pairs.list();
        let mut flat = pairs.iter().flat_map(|(s, p)| [u64::from(*s), u64::from(*p)]);
        state.counts("pairs", 2 * pairs.len(), &mut flat)?;
        state.counts("fresh", 1, &mut std::iter::once(u64::from(self.fresh)))
    }

    pub(crate) fn restore_state(&mut self, state: &dyn StateReader) -> Result<(), StateError> {
        let (kept, patches) = (state.numbers("points")?, state.counts("patches")?);
        StateError::expect("points", kept.len(), NUMBERS * self.points.len())?;
        StateError::expect("patches", patches.len(), COUNTS * self.points.len())?;
        let primary = self.primary.patch_count() as u64;
        if patches.iter().any(|p| *p != NONE && *p >= primary) {
            return Err(StateError::Value { name: "patches".into() });
        }
        let (kept, patches) = (kept.as_chunks::<NUMBERS>().0, patches.as_chunks::<COUNTS>().0);
        for ((point, kept), patches) in self.points.iter_mut().zip(kept).zip(patches) {
            take_up(point, kept, *patches);
        }
        self.pairs = Pairs::new(&self.kept_pairs(state)?, &self.primary, &self.secondary);
        self.rounds = 0;
        self.fresh = state.counts("fresh")? != [0];
        Ok(())
    }

    fn kept_pairs(&self, state: &dyn StateReader) -> Result<Vec<(u32, u32)>, StateError> {
        let flat = state.counts("pairs")?;
        let (secondary, primary) = (self.secondary.patch_count() as u64, self.primary.patch_count() as u64);
        let pairs = flat.as_chunks::<2>().0;
        let known = pairs.iter().all(|&[s, p]| s < secondary && p < primary) && pairs.is_sorted();
        if !known || flat.len() % 2 != 0 {
            return Err(StateError::Value { name: "pairs".into() });
        }
        Ok(pairs.iter().map(|&[s, p]| (s as u32, p as u32)).collect())
    }
}

/// All that a point remembers but patches. Taken apart, so that nothing that is added later can be forgotten.
fn numbers(point: &Point) -> [f64; NUMBERS] {
    let Point { own: _, area: _, overlap, hint, multiplier: _, committed_multiplier, frozen, pulling, old, new: _ } =
        point;
    let History { place, gap, pressure, traction, elastic, elastic_length, slip, work, work_mid } = old;
    let xi = |place: &Option<Place>| place.map_or([0.0; 2], |at| at.xi);
    let ([a, b], [c, d]) = (xi(hint), xi(place));
    let [x, y, z] = (*traction).into();
    let [e, f] = (*elastic).into();
    [
        *overlap,
        *committed_multiplier,
        *frozen,
        *pulling,
        a,
        b,
        c,
        d,
        *gap,
        *pressure,
        x,
        y,
        z,
        e,
        f,
        *elastic_length,
        *slip,
        *work,
        *work_mid,
    ]
}

fn take_up(point: &mut Point, kept: &[f64; NUMBERS], patches: [u64; COUNTS]) {
    let &[
        overlap,
        multiplier,
        frozen,
        pulling,
        a,
        b,
        c,
        d,
        gap,
        pressure,
        x,
        y,
        z,
        e,
        f,
        elastic_length,
        slip,
        work,
        work_mid,
    ] = kept;
    let place = |patch: u64, xi| (patch != NONE).then_some(Place { patch: patch as u32, xi });
    (point.overlap, point.committed_multiplier, point.frozen, point.pulling) = (overlap, multiplier, frozen, pulling);
    point.hint = place(patches[0], [a, b]);
    point.old = History {
        place: place(patches[1], [c, d]),
        gap,
        pressure,
        traction: Vector3::new(x, y, z),
        elastic: Vector2::new(e, f),
        elastic_length,
        slip,
        work,
        work_mid,
    };
    point.revert();
}
