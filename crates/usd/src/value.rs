//! Values of attributes that curves, meshes, skeletons and transforms have.

use glam::{DQuat, Quat, Vec3};

/// A value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A token.
    Token(String),
    /// An array of tokens.
    Tokens(Vec<String>),
    /// A boolean.
    Bool(bool),
    /// An array of integers.
    Ints(Vec<i32>),
    /// One number, or the components of one vector, quaternion (w first) or matrix (row after row).
    Numbers(Vec<f64>),
    /// An array of numbers.
    Floats(Vec<f32>),
    /// An array of vectors of three, or of two, whose third component is 0.
    Vectors(Vec<Vec3>),
    /// An array of quaternions, the real part first.
    Quaternions(Vec<[f32; 4]>),
    /// An array of matrices of 4 by 4, row after row.
    Matrices(Vec<[f64; 16]>),
}

impl Value {
    /// The token; `None` for another value.
    pub fn token(&self) -> Option<&str> {
        match self {
            Self::Token(token) => Some(token),
            _ => None,
        }
    }

    /// The numbers of one number, vector, quaternion or matrix; empty for another value.
    pub fn numbers(&self) -> &[f64] {
        match self {
            Self::Numbers(numbers) => numbers,
            _ => &[],
        }
    }

    /// The tokens; empty for another value.
    pub fn into_tokens(self) -> Vec<String> {
        match self {
            Self::Tokens(tokens) => tokens,
            _ => Vec::new(),
        }
    }

    /// The integers; empty for another value.
    pub fn into_ints(self) -> Vec<i32> {
        match self {
            Self::Ints(ints) => ints,
            _ => Vec::new(),
        }
    }

    /// The numbers of an array, or of one number or vector; empty for another value.
    pub fn into_floats(self) -> Vec<f32> {
        match self {
            Self::Floats(floats) => floats,
            Self::Numbers(numbers) => numbers.into_iter().map(|number| number as f32).collect(),
            _ => Vec::new(),
        }
    }

    /// The quaternions, the real part first; empty for another value.
    pub fn into_quaternions(self) -> Vec<[f32; 4]> {
        match self {
            Self::Quaternions(quaternions) => quaternions,
            _ => Vec::new(),
        }
    }

    /// The matrices, row after row; empty for another value.
    pub fn into_matrices(self) -> Vec<[f64; 16]> {
        match self {
            Self::Matrices(matrices) => matrices,
            _ => Vec::new(),
        }
    }

    /// Vectors, or numbers repeated in each component of a vector.
    pub fn into_vectors(self) -> Vec<Vec3> {
        match self {
            Self::Vectors(vectors) => vectors,
            Self::Floats(floats) => floats.into_iter().map(Vec3::splat).collect(),
            Self::Numbers(numbers) => match numbers[..] {
                [one] => vec![Vec3::splat(one as f32)],
                [x, y, z] => vec![Vec3::new(x as f32, y as f32, z as f32)],
                _ => Vec::new(),
            },
            _ => Vec::new(),
        }
    }
}

impl Value {
    /// Whether values between two samples of its type lie between them.
    pub(crate) fn interpolates(&self) -> bool {
        !matches!(self, Self::Token(_) | Self::Tokens(_) | Self::Bool(_) | Self::Ints(_))
    }

    /// The value at part `t` of the way to another one; itself where the other has another type or length.
    pub(crate) fn toward(mut self, next: &Self, t: f64) -> Self {
        let lerp = |a: f64, b: f64| a + (b - a) * t;
        match (&mut self, next) {
            // Of single values only quaternions have four numbers.
            (Self::Numbers(from), Self::Numbers(to))
                if let (&[w, x, y, z], &[v, a, b, c]) = (&from[..], &to[..]) =>
            {
                let turned = between(DQuat::from_xyzw(x, y, z, w), DQuat::from_xyzw(a, b, c, v), t);
                if let Some(turn) = turned {
                    *from = vec![turn.w, turn.x, turn.y, turn.z];
                }
            }
            (Self::Numbers(from), Self::Numbers(to)) if from.len() == to.len() => {
                from.iter_mut().zip(to).for_each(|(a, b)| *a = lerp(*a, *b));
            }
            (Self::Floats(from), Self::Floats(to)) if from.len() == to.len() => {
                from.iter_mut().zip(to).for_each(|(a, b)| *a = lerp(f64::from(*a), f64::from(*b)) as f32);
            }
            (Self::Vectors(from), Self::Vectors(to)) if from.len() == to.len() => {
                from.iter_mut().zip(to).for_each(|(a, b)| *a += (*b - *a) * t as f32);
            }
            (Self::Quaternions(from), Self::Quaternions(to)) if from.len() == to.len() => {
                let turn = |[w, x, y, z]: [f32; 4]| Quat::from_xyzw(x, y, z, w).as_dquat();
                for (a, b) in from.iter_mut().zip(to) {
                    if let Some(turn) = between(turn(*a), turn(*b), t) {
                        *a = [turn.w, turn.x, turn.y, turn.z].map(|part| part as f32);
                    }
                }
            }
            (Self::Matrices(from), Self::Matrices(to)) if from.len() == to.len() => {
                let numbers = from.as_flattened_mut().iter_mut().zip(to.as_flattened());
                numbers.for_each(|(a, b)| *a = lerp(*a, *b));
            }
            _ => {}
        }
        self
    }
}

/// The rotation at part `t` of the shorter way from one to another; `None` for quaternions without a direction.
fn between(from: DQuat, to: DQuat, t: f64) -> Option<DQuat> {
    let unit = |q: DQuat| {
        let length = q.length();
        (length.is_finite() && length > 1e-9).then(|| q / length)
    };
    Some(unit(from)?.slerp(unit(to)?, t))
}

/// Converts a half-precision number (IEEE 754 binary16).
pub(crate) fn half(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f32::from(bits & 0x3ff));
    match exponent {
        0 => sign * fraction * 2_f32.powi(-24),
        31 if fraction == 0.0 => sign * f32::INFINITY,
        31 => f32::NAN,
        _ => sign * (1.0 + fraction / 1024.0) * 2_f32.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn half_precision_numbers_are_converted() {
        for (bits, value) in [
            (0, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x3555, 0.333_251_95),
            (0x7bff, 65504.0),
            (1, 5.960_464_5e-8),
        ] {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan() && half(0xfc00) == f32::NEG_INFINITY);
    }
}
