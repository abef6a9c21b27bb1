//! Whether a surface has an inside: then what faces away is never seen and need not be drawn.

use std::sync::Arc;

use lovelock_motion::{Body, Mesh};

/// Remembers the answer for the body that was asked for last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Closedness {
    body: Option<Arc<Body>>,
    closed: bool,
}

impl Closedness {
    /// Whether the body's surface is closed.
    pub fn of(&mut self, body: &Arc<Body>) -> bool {
        if !self.body.as_ref().is_some_and(|old| Arc::ptr_eq(old, body)) {
            self.closed = is_closed(&body.mesh);
            self.body = Some(Arc::clone(body));
        }
        self.closed
    }
}

/// Whether every edge has a triangle on each side, once in each direction.
fn is_closed(mesh: &Mesh) -> bool {
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut there: Vec<(u32, u32)> = edges.clone().collect();
    let mut back: Vec<(u32, u32)> = edges.map(|(a, b)| (b, a)).collect();
    there.sort_unstable();
    back.sort_unstable();
    !there.is_empty() && there == back && there.windows(2).all(|pair| pair[0] != pair[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_is_closed_and_an_open_or_twisted_one_is_not() {
        let mut mesh =
            Mesh { triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], ..Mesh::default() };
        assert!(is_closed(&mesh));
        mesh.triangles[3] = [0, 2, 3];
        assert!(!is_closed(&mesh), "one turned round");
        mesh.triangles.truncate(3);
        assert!(!is_closed(&mesh), "one left out");
        assert!(!is_closed(&Mesh::default()));
    }
}
