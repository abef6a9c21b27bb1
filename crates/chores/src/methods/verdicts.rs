//! What the numbers of all scenes say together.

use super::report::Report;

/// The factor between two errors from which on one method is said to be worse.
pub(super) const FACTOR: f64 = 2.0;
/// Times that differ by less are taken as the same.
const SAME_TIME: f64 = 1.1;

/// Methods that err by at least [`FACTOR`] times as much as another one in every scene, although that one needs neither more time nor more
/// memory; each with the least of the factors.
pub(super) fn twice_the_error(scenes: &[&Report]) -> Vec<(String, String, f64)> {
    let Some(first) = scenes.first() else { return Vec::new() };
    // No shadow is no method of making one.
    let ids = || first.methods.iter().map(|method| method.id.as_str()).filter(|id| *id != "none");
    let mut all = Vec::new();
    for worse in ids() {
        for better in ids().filter(|id| *id != worse) {
            let factors: Option<Vec<f64>> = scenes.iter().map(|scene| factor(scene, worse, better)).collect();
            let least = factors.and_then(|factors| factors.into_iter().reduce(f64::min));
            if let Some(least) = least.filter(|least| *least >= FACTOR) {
                all.push((worse.to_owned(), better.to_owned(), least));
            }
        }
    }
    all
}

/// How many times as large the error of `worse` is; `None` if `better` needs more time or memory, or one of them was not measured.
fn factor(scene: &Report, worse: &str, better: &str) -> Option<f64> {
    let (worse, better) = (scene.method(worse)?, scene.method(better)?);
    let ms = |(build, query): (f64, f64)| build + query;
    let costs_more = ms(better.cost()?) > SAME_TIME * ms(worse.cost()?)
        || better.memory_bytes.unwrap_or(0) > worse.memory_bytes.unwrap_or(0);
    let factor = worse.rmse()? / better.rmse()?;
    (!costs_more && factor.is_finite()).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::report::{Error, Method, Reference, Scene, StageMs};

    fn method(id: &str, ms: f64, memory: u64, rmse: f64) -> Method {
        Method {
            id: id.to_owned(),
            transmittance_common: Some(Error { rmse, ..Error::default() }),
            ms: Some(StageMs { build: Some(ms), query: Some(0.0) }),
            memory_bytes: Some(memory),
            ..Method::default()
        }
    }

    fn scene(methods: Vec<Method>) -> Report {
        Report {
            complete: true,
            machine: String::new(),
            scene: Scene { strands: 1, segments: 1 },
            reference: Reference { converged: true, change: 0.0 },
            methods,
        }
    }

    #[test]
    fn a_method_is_named_only_if_another_is_as_cheap_and_twice_as_good_everywhere() {
        let one = || {
            scene(vec![method("a", 1.0, 10, 0.02), method("b", 1.0, 10, 0.05), method("none", 0.0, 0, 0.9)])
        };
        assert_eq!(twice_the_error(&[&one()]), [("b".to_owned(), "a".to_owned(), 2.5)]);
        // Not where it is nearer in one scene, nor where the better one costs more time or memory.
        let near = scene(vec![method("a", 1.0, 10, 0.02), method("b", 1.0, 10, 0.03)]);
        assert!(twice_the_error(&[&one(), &near]).is_empty());
        let slow = scene(vec![method("a", 1.2, 10, 0.02), method("b", 1.0, 10, 0.05)]);
        assert!(twice_the_error(&[&one(), &slow]).is_empty());
        let large = scene(vec![method("a", 1.0, 11, 0.02), method("b", 1.0, 10, 0.05)]);
        assert!(twice_the_error(&[&one(), &large]).is_empty());
    }
}
