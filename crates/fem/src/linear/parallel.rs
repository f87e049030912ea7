//! The few parallel constructs of the solvers, which run in sequence without the feature `parallel`.
//!
//! Work is cut at places that do not depend on the number of threads and every part is computed by sequential
//! kernels, so that results are bitwise equal for any number of threads.

/// Runs both closures, at the same time if there are threads.
pub(super) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(feature = "parallel")]
    return rayon::join(a, b);
    #[cfg(not(feature = "parallel"))]
    return (a(), b());
}

/// Applies `work` to every item; the results stand in the order of the items.
pub(super) fn map_mut<T: Send, R: Send>(items: &mut [T], work: &(impl Fn(&mut T) -> R + Sync)) -> Vec<R> {
    match items {
        [] => Vec::new(),
        [one] => vec![work(one)],
        _ => {
            let (left, right) = items.split_at_mut(items.len() / 2);
            let (mut done, rest) = join(|| map_mut(left, work), || map_mut(right, work));
            done.extend(rest);
            done
        }
    }
}
