//! Reference for a chain of rigid links: its equations of motion in double precision, solved by a different
//! method from the simulator's: tensions from the second derivative of the lengths, and the classical
//! Runge-Kutta method of fourth order.

use glam::{DVec3, Vec3};

/// Points and velocities of a chain whose first point is fixed; the other points have equal masses.
#[derive(Clone)]
pub struct Chain {
    pub position: Vec<DVec3>,
    pub velocity: Vec<DVec3>,
    length: Vec<f64>,
    gravity: DVec3,
}

impl Chain {
    /// A chain at rest through `points` under the gravity of a simulation, metres per second squared.
    pub fn new(points: &[Vec3], gravity: f64) -> Self {
        let position: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
        let mut length = vec![0.0];
        length.extend(position.windows(2).map(|w| (w[1] - w[0]).length()));
        let velocity = vec![DVec3::ZERO; position.len()];
        Self { position, velocity, length, gravity: DVec3::new(0.0, -gravity, 0.0) }
    }

    /// `a_i = g + t_(i+1) n_(i+1) - t_i n_i` with the tensions `t` (per mass) that keep every length:
    /// `n_i . (a_i - a_(i-1)) = -|v_i - v_(i-1)|^2 / l_i`.
    fn accelerations(&self, x: &[DVec3], v: &[DVec3]) -> Vec<DVec3> {
        let count = x.len();
        let mut n = vec![DVec3::ZERO; count];
        let (mut tension, mut upper) = (vec![0.0; count + 1], vec![0.0; count + 1]);
        for i in 1..count {
            n[i] = (x[i] - x[i - 1]).normalize_or_zero();
        }
        for i in 1..count {
            // Only the first point does not fall.
            let falls = if i == 1 { self.gravity.dot(n[1]) } else { 0.0 };
            let right = (v[i] - v[i - 1]).length_squared() / self.length[i] + falls;
            let diagonal = if i == 1 { 1.0 } else { 2.0 };
            let below = if i > 1 { -n[i - 1].dot(n[i]) } else { 0.0 };
            let above = if i + 1 < count { -n[i].dot(n[i + 1]) } else { 0.0 };
            let pivot = diagonal - below * upper[i - 1];
            upper[i] = above / pivot;
            tension[i] = (right - below * tension[i - 1]) / pivot;
        }
        for i in (1..count).rev() {
            tension[i] -= upper[i] * tension[i + 1];
        }
        let mut a = vec![DVec3::ZERO; count];
        for i in 1..count {
            let next = if i + 1 < count { n[i + 1] * tension[i + 1] } else { DVec3::ZERO };
            a[i] = self.gravity + next - n[i] * tension[i];
        }
        a
    }

    /// One step of `h` seconds.
    pub fn step(&mut self, h: f64) {
        let add = |x: &[DVec3], d: &[DVec3], by: f64| -> Vec<DVec3> {
            x.iter().zip(d).map(|(x, d)| *x + *d * by).collect()
        };
        let (x, v) = (self.position.clone(), self.velocity.clone());
        let a1 = self.accelerations(&x, &v);
        let (x2, v2) = (add(&x, &v, h / 2.0), add(&v, &a1, h / 2.0));
        let a2 = self.accelerations(&x2, &v2);
        let (x3, v3) = (add(&x, &v2, h / 2.0), add(&v, &a2, h / 2.0));
        let a3 = self.accelerations(&x3, &v3);
        let (x4, v4) = (add(&x, &v3, h), add(&v, &a3, h));
        let a4 = self.accelerations(&x4, &v4);
        for i in 1..x.len() {
            self.position[i] = x[i] + (v[i] + 2.0 * (v2[i] + v3[i]) + v4[i]) * (h / 6.0);
            self.velocity[i] = v[i] + (a1[i] + 2.0 * (a2[i] + a3[i]) + a4[i]) * (h / 6.0);
        }
    }

    /// Kinetic plus potential energy per mass of all points, J/kg.
    pub fn energy(&self) -> f64 {
        let free = (self.position.len() - 1) as f64;
        let each = self.position.iter().zip(&self.velocity);
        each.map(|(x, v)| 0.5 * v.length_squared() - self.gravity.dot(*x)).sum::<f64>() / free
    }

    /// The position of the last point after each of `frames` intervals of `frame_secs`, in steps of
    /// `frame_secs / steps`.
    pub fn tips(mut self, frames: u32, frame_secs: f64, steps: u32) -> Vec<DVec3> {
        (0..frames)
            .map(|_| {
                for _ in 0..steps {
                    self.step(frame_secs / f64::from(steps));
                }
                *self.position.last().expect("a chain")
            })
            .collect()
    }
}
