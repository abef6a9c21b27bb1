//! Given transmittance.

use crate::RenderError;

/// Transmittance that replaces the result of the shadow method. References are rendered with
/// [`converged`](lovelock_shadow::converged) transmittance.
///
/// There is one list per light, in the order of the lights that are switched on. Values that are not given come from the method
/// `exact`: those of the ground, and those of the body if its lists are empty.
#[derive(Clone, Copy, Debug)]
pub struct KnownTransmittance<'a> {
    /// Transmittance at each strand point, 0 to 1, one list per light.
    pub at_points: &'a [Vec<f32>],
    /// The same at each vertex of the body; no lists if it is not known.
    pub at_vertices: &'a [Vec<f32>],
}

impl KnownTransmittance<'_> {
    /// Returns an error if the lists do not match the picture.
    pub(crate) fn check(&self, lights: usize, points: usize, vertices: usize) -> Result<(), RenderError> {
        let same = |of, found, needed| {
            if found == needed { Ok(()) } else { Err(RenderError::Known { of, found, needed }) }
        };
        same("lists for strand points (one per light)", self.at_points.len(), lights)?;
        for list in self.at_points {
            same("strand points", list.len(), points)?;
        }
        if self.at_vertices.is_empty() {
            return Ok(());
        }
        same("lists for vertices of the body (one per light)", self.at_vertices.len(), lights)?;
        for list in self.at_vertices {
            same("vertices of the body", list.len(), vertices)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_that_do_not_fit_are_refused_with_both_numbers() {
        let (points, vertices) = ([vec![1.0; 5], vec![0.5; 5]], [vec![1.0; 3], vec![1.0; 3]]);
        let known = KnownTransmittance { at_points: &points, at_vertices: &vertices };
        assert!(known.check(2, 5, 3).is_ok());
        let without = KnownTransmittance { at_vertices: &[], ..known };
        assert!(without.check(2, 5, 3).is_ok() && without.check(2, 5, 0).is_ok());
        for wrong in [known.check(1, 5, 3), known.check(2, 6, 3), known.check(2, 5, 4)] {
            assert!(
                matches!(wrong, Err(RenderError::Known { found, needed, .. }) if found != needed),
                "{wrong:?}"
            );
        }
        let one = KnownTransmittance { at_vertices: &vertices[..1], ..known };
        assert!(one.check(2, 5, 3).is_err());
        assert_eq!(
            known.check(2, 6, 3).unwrap_err().to_string(),
            "the values given for the image have 5 strand points; 6 are needed"
        );
    }
}
