//! From runs to a report.

use super::file::{Clock, Reference, ReferenceKind, StudyFile};
use super::front::{Bound, Ratio, cheapest, cost_at, pareto};
use super::machine::Machine;
use super::members::Member;
use super::order::{observed, richardson};
use super::quantity::{self, Source};
use super::report::{
    Best, Cheapest, Counts, MemberReport, MemberStatus, Noise, Pair, QuantityReport, ReferenceReport, Report,
    SeriesReport, TIMED, Times, ValueReport,
};
use super::rounds::Runs;
use super::sample::Sample;

/// What the user asked of the report.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub target: f64,
    pub repeats: usize,
    pub complete: bool,
}

/// The report of a study.
pub(super) fn reduce(file: &StudyFile, runs: &[Runs], machine: Machine, asked: Asked) -> Report {
    let study = &file.study;
    let has_cpu = runs.iter().flat_map(|r| &r.samples).all(|s| s.cpu().is_some());
    let clock = if study.clock == Clock::Cpu && has_cpu { Clock::Cpu } else { Clock::Wall };
    let members: Vec<_> = file.members.iter().zip(runs).map(|(m, r)| member(file, m, r, clock)).collect();
    let mut report = Report {
        title: study.title.clone(),
        scene: study.scene.display().to_string(),
        version: env!("CARGO_PKG_VERSION"),
        complete: asked.complete,
        repeats: asked.repeats,
        threads: study.threads,
        clock,
        timed: TIMED,
        target: asked.target,
        machine,
        noise: noise(&members),
        series: file.families.iter().map(|f| series(&f.name, &f.members, &members)).collect(),
        members,
        quantities: Vec::new(),
        cheapest_for_all: None,
    };
    for index in 0..study.quantity.len() {
        let quantity = Compared { report: &mut report, file, index }.quantity();
        report.quantities.push(quantity);
    }
    report.cheapest_for_all = cheapest_for_all(&report);
    report
}

fn member(file: &StudyFile, member: &Member, runs: &Runs, clock: Clock) -> MemberReport {
    let Runs { samples, failure } = runs;
    let last = samples.last();
    let time = |s: &Sample| match clock {
        Clock::Cpu => s.cpu(),
        Clock::Wall => s.wall(),
    };
    let values = file.study.quantity.iter().map(|quantity| {
        let found = Source::of(quantity).zip(last).map(|(source, s)| source.value(&s.summary, &s.history));
        match found {
            Some(Ok(value)) => ValueReport { value: Some(value), ..ValueReport::default() },
            Some(Err(missing)) => ValueReport { missing: Some(missing.to_string()), ..ValueReport::default() },
            None => ValueReport::default(),
        }
    });
    let json = |value: &toml::Value| serde_json::to_value(value).unwrap_or_default();
    MemberReport {
        name: member.name.clone(),
        series: file.families[member.family].name.clone(),
        level: member.level,
        settings: member.settings.iter().map(|(key, value)| (key.clone(), json(&value.0))).collect(),
        size: member.size,
        folder: format!("members/{}", member.folder),
        status: match (failure, samples.is_empty()) {
            (Some(reason), _) => MemberStatus::Failed(reason.clone()),
            (None, true) => MemberStatus::NotRun,
            (None, false) => MemberStatus::Done,
        },
        counts: last.map(counts),
        time: Times::of(samples.iter().filter_map(time).collect()),
        wall: Times::of(samples.iter().filter_map(Sample::wall).collect()),
        memory_mb: samples.iter().filter_map(Sample::memory).max_by(f64::total_cmp),
        values: values.collect(),
    }
}

fn counts(sample: &Sample) -> Counts {
    Counts {
        elements: sample.count("/size/elements"),
        nodes: sample.count("/size/nodes"),
        unknowns: sample.count("/size/unknowns"),
        increments: sample.count("/counts/increments"),
        iterations: sample.count("/counts/iterations"),
        cutbacks: sample.count("/counts/cutbacks"),
        unstable_increments: sample.count("/counts/unstable_increments"),
    }
}

fn noise(members: &[MemberReport]) -> Option<Noise> {
    let repeated = members.iter().filter_map(|m| m.time.as_ref()).filter(|t| t.all.len() > 1 && t.min > 0.0);
    let spread = Times::of(repeated.map(|t| (t.max - t.min) / t.min).collect())?;
    Some(Noise { median: spread.median, largest: spread.max })
}

fn series(name: &str, indices: &[usize], members: &[MemberReport]) -> SeriesReport {
    let given = indices.iter().any(|&i| members[i].size.is_some());
    let derived = |m: &MemberReport| m.counts.filter(|c| c.unknowns > 0).map(|c| (c.unknowns as f64).powf(-1.0 / 3.0));
    let size = |&i: &usize| if given { members[i].size } else { derived(&members[i]) };
    SeriesReport {
        name: name.to_owned(),
        members: indices.to_vec(),
        sizes_from: if given { "given" } else { "unknowns^(-1/3)" },
        sizes: indices.iter().map(size).collect(),
    }
}

/// A quantity being compared with its reference.
struct Compared<'a> {
    report: &'a mut Report,
    file: &'a StudyFile,
    index: usize,
}

impl Compared<'_> {
    fn quantity(mut self) -> QuantityReport {
        let quantity = &self.file.study.quantity[self.index];
        let reference = self.reference();
        if let Some(reference) = &reference {
            self.errors(reference);
        }
        let points = self.points();
        let front = pareto(&points);
        front.iter().for_each(|&m| self.report.members[m].values[self.index].on_front = true);
        let curve = |s: &SeriesReport| s.members.iter().filter_map(|&m| points[m]).collect::<Vec<_>>();
        let curves: Vec<_> = self.report.series.iter().map(curve).collect();
        let time_at_target: Vec<_> = curves.iter().map(|c| cost_at(c, self.report.target)).collect();
        let unit = quantity.unit.clone().or_else(|| quantity::known(&quantity.name).map(|k| k.unit.to_owned()));
        QuantityReport {
            name: quantity.name.clone(),
            unit: unit.unwrap_or_else(|| "-".to_owned()),
            orders: self.report.series.iter().map(|s| self.orders(s)).collect(),
            front,
            pairs: pairs(&curves, self.report.target),
            time_at_target,
            cheapest: self.cheapest(&points),
            best: best(&points),
            reference,
        }
    }

    fn value(&self, member: usize) -> Option<f64> {
        self.report.members[member].values[self.index].value
    }

    /// What the quantity is compared with; `None` when there is nothing.
    fn reference(&self) -> Option<ReferenceReport> {
        let study = &self.file.study;
        if let Some(value) = study.quantity[self.index].value {
            return Some(plain(ReferenceKind::Value, value, None));
        }
        let Reference { kind, series } = study.reference.as_ref()?;
        let families = &self.file.families;
        let family = families.iter().position(|f| series.as_ref().is_none_or(|name| f.name == *name))?;
        let known: Vec<usize> = families[family].members.iter().copied().filter(|&m| self.value(m).is_some()).collect();
        let last = *known.last()?;
        let mut finest = plain(ReferenceKind::Finest, self.value(last)?, Some(last));
        if families[family].members.last() != Some(&last) {
            finest.note = Some("the finest level gave no value: this is the finest that did".to_owned());
        }
        if *kind != ReferenceKind::Extrapolated {
            return Some(finest);
        }
        match self.extrapolated(family, &known) {
            Ok(reference) => Some(reference),
            Err(cause) => {
                finest.note = Some(format!("not extrapolated: {cause}; this is the finest level"));
                Some(finest)
            }
        }
    }

    fn extrapolated(&self, family: usize, known: &[usize]) -> Result<ReferenceReport, String> {
        let series = &self.report.series[family];
        let size = |m: usize| series.members.iter().position(|&i| i == m).and_then(|p| series.sizes[p]);
        let levels: Vec<(f64, f64)> = known.iter().filter_map(|&m| Some((size(m)?, self.value(m)?))).collect();
        let [.., a, b, c] = levels.as_slice() else {
            return Err(format!("{} of three levels gave a value", levels.len()));
        };
        let found = richardson([a.0, b.0, c.0], [a.1, b.1, c.1]).map_err(|e| e.to_string())?;
        let mut reference = plain(ReferenceKind::Extrapolated, found.value, None);
        reference.order = Some(found.order);
        Ok(reference)
    }

    fn errors(&mut self, reference: &ReferenceReport) {
        let scale = reference.value.abs();
        for (index, member) in self.report.members.iter_mut().enumerate() {
            let own = &mut member.values[self.index];
            own.is_reference = reference.member == Some(index);
            if !own.is_reference && scale > 0.0 {
                own.error = own.value.map(|v| (v - reference.value).abs() / scale);
            }
        }
    }

    /// Time and error of every member.
    fn points(&self) -> Vec<Option<(f64, f64)>> {
        let point = |m: &MemberReport| Some((m.time.as_ref()?.min, m.values[self.index].error?));
        self.report.members.iter().map(point).collect()
    }

    fn orders(&self, series: &SeriesReport) -> Vec<Option<f64>> {
        let error = |&m: &usize| self.report.members[m].values[self.index].error;
        let sizes: Vec<f64> = series.sizes.iter().map(|h| h.unwrap_or(0.0)).collect();
        observed(&sizes, &series.members.iter().map(error).collect::<Vec<_>>())
    }

    fn cheapest(&self, points: &[Option<(f64, f64)>]) -> Option<Cheapest> {
        found(self.report, points)
    }
}

fn plain(kind: ReferenceKind, value: f64, member: Option<usize>) -> ReferenceReport {
    ReferenceReport { kind, value, member, order: None, note: None }
}

/// The cheapest member at or below the target.
fn found(report: &Report, points: &[Option<(f64, f64)>]) -> Option<Cheapest> {
    let member = cheapest(points, report.target)?;
    let (time, error) = points[member]?;
    let own = &report.members[member];
    let finer = |(m, p): (&MemberReport, &Option<(f64, f64)>)| {
        m.series == own.series && m.level > own.level && p.is_some_and(|(_, e)| e > report.target)
    };
    let by_chance = report.members.iter().zip(points).any(finer);
    Some(Cheapest { member, time, error, by_chance })
}

fn best(points: &[Option<(f64, f64)>]) -> Option<Best> {
    let known = points.iter().enumerate().filter_map(|(member, p)| p.map(|(_, error)| Best { member, error }));
    known.min_by(|a, b| a.error.total_cmp(&b.error))
}

/// All pairs of series that are compared with the reference, the slower one first; points are (time, error) from coarse to
/// fine.
fn pairs(curves: &[Vec<(f64, f64)>], target: f64) -> Vec<Pair> {
    let all = (0..curves.len()).flat_map(|i| (i + 1..curves.len()).map(move |j| (i, j)));
    all.filter_map(|(i, j)| pair(curves, i, j, target)).collect()
}

fn pair(curves: &[Vec<(f64, f64)>], first: usize, second: usize, target: f64) -> Option<Pair> {
    let common_error = curves[first].last()?.1.max(curves[second].last()?.1);
    let over = |a: usize, b: usize, error| cost_at(&curves[a], error)?.over(cost_at(&curves[b], error)?);
    let ratio = over(first, second, common_error)?;
    let (slower, faster) = if ratio.value < 1.0 { (second, first) } else { (first, second) };
    let common = over(slower, faster, common_error)?;
    // That the slower one takes at least a part of the time of the faster one tells nothing.
    let empty = |r: &Ratio| r.bound == Bound::AtLeast && r.value < 1.0 && r.estimate.is_none();
    let at_target = over(slower, faster, target).filter(|r| !empty(r));
    Some(Pair { slower, faster, common, common_error, at_target })
}

/// The cheapest member that is good enough in all quantities.
fn cheapest_for_all(report: &Report) -> Option<Cheapest> {
    let point = |m: &MemberReport| {
        let worst = m.values.iter().try_fold(0.0, |worst: f64, v| Some(worst.max(v.error?)))?;
        Some((m.time.as_ref()?.min, worst))
    };
    found(report, &report.members.iter().map(point).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_compared_at_an_error_that_both_reach() {
        let slow = vec![(1.0, 0.4), (10.0, 0.1), (100.0, 0.025)];
        let fast = vec![(0.5, 0.2), (5.0, 0.002)];
        let found = pairs(&[slow, Vec::new(), fast], 0.01);
        let [pair] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((pair.slower, pair.faster, pair.common_error), (0, 2, 0.025));
        // The fast one: from .2 to .002 in a decade of time, .025 at .5 x 10^(log10(8)/2).
        let expected = 100.0 / (0.5 * 8.0_f64.sqrt());
        assert!((pair.common.value - expected).abs() < 1e-9 * expected, "{pair:?}");
        let at_target = pair.at_target.unwrap();
        assert_eq!(at_target.bound, Bound::AtLeast);
        assert!(at_target.estimate.is_some_and(|e| e > expected), "{at_target:?}");
    }
}
