//! The transform of a prim in its stage.

use glam::{DMat4, DQuat, DVec3};

use crate::{Layer, UsdError, Value};

/// The deepest nesting of prims.
pub(crate) const DEEPEST: usize = 128;

/// The most transform operations of one prim.
const MAX_OPS: usize = 256;

/// Unit and axis of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageSpace {
    /// The transform from the stage to metres with Y up.
    pub metres_from_stage: DMat4,
    /// Metres per unit.
    pub metres: f64,
    /// Whether the file states its unit. A stage without one is in centimetres.
    pub is_stated: bool,
    /// Whether the file states its up axis. In a stage without one Y points up.
    pub up_is_stated: bool,
}

/// Unit and axis of a stage.
///
/// # Errors
/// If the unit is out of range.
pub fn stage_space(layer: &mut dyn Layer) -> Result<StageSpace, UsdError> {
    let stated = layer.metadata("metersPerUnit")?;
    let is_stated = stated.is_some();
    let metres = stated.map_or(0.01, |value| value.numbers().first().copied().unwrap_or(f64::NAN));
    if !(1e-9..=1e9).contains(&metres) {
        return Err(layer.malformed(format!("metersPerUnit {metres}"), "1e-9 to 1e9"));
    }
    let axis = layer.metadata("upAxis")?;
    let up_is_stated = axis.is_some();
    let z_up = axis.is_some_and(|axis| axis.token() == Some("Z"));
    let turn = if z_up { DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2) } else { DMat4::IDENTITY };
    let metres_from_stage = turn * DMat4::from_scale(DVec3::splat(metres));
    Ok(StageSpace { metres_from_stage, metres, is_stated, up_is_stated })
}

/// The transform from a prim's own space to the stage: its operations and those of all its ancestors, at their first time samples.
///
/// # Errors
/// If an operation is unknown or the result is not finite.
pub fn to_stage(layer: &mut dyn Layer, prim: usize) -> Result<DMat4, UsdError> {
    let mut transform = DMat4::IDENTITY;
    let mut at = Some(prim);
    for _ in 0..DEEPEST {
        let Some(prim) = at else { break };
        let (own, resets) = own_transform(layer, prim)?;
        transform = own * transform;
        if resets {
            break;
        }
        at = layer.parent(prim);
    }
    if !transform.is_finite() {
        return Err(
            layer.malformed(format!("{}: a transform that is not finite", layer.path(prim)), "numbers")
        );
    }
    Ok(transform)
}

/// The time codes at which the transform of a prim or of an ancestor changes.
///
/// # Errors
/// If the file contradicts itself.
pub fn transform_times(layer: &mut dyn Layer, prim: usize) -> Result<Vec<f64>, UsdError> {
    let mut times = Vec::new();
    let mut at = Some(prim);
    for _ in 0..DEEPEST {
        let Some(prim) = at else { break };
        let order = layer.attribute(prim, "xformOpOrder", MAX_OPS)?.map_or_else(Vec::new, Value::into_tokens);
        for op in order.iter().take(MAX_OPS) {
            times.extend(layer.sample_times(prim, op.strip_prefix("!invert!").unwrap_or(op))?);
        }
        at = layer.parent(prim);
    }
    Ok(times)
}

/// The transform operations of one prim, and whether they reset the transforms of its ancestors.
///
/// # Errors
/// As [`to_stage`].
pub fn own_transform(layer: &mut dyn Layer, prim: usize) -> Result<(DMat4, bool), UsdError> {
    let order = layer.attribute(prim, "xformOpOrder", MAX_OPS)?.map_or_else(Vec::new, Value::into_tokens);
    let (mut transform, mut resets) = (DMat4::IDENTITY, false);
    for op in order.iter().take(MAX_OPS) {
        if op == "!resetXformStack!" {
            (transform, resets) = (DMat4::IDENTITY, true);
            continue;
        }
        let (name, inverted) = op.strip_prefix("!invert!").map_or((op.as_str(), false), |name| (name, true));
        let Some(value) = layer.attribute(prim, name, 1)? else { continue };
        let kind = name.strip_prefix("xformOp:").unwrap_or(name).split(':').next().unwrap_or_default();
        let Some(matrix) = matrix(kind, value.numbers()) else {
            let found = format!("{}: {name} of {} numbers", layer.path(prim), value.numbers().len());
            return Err(layer.malformed(found, "a USD transform operation"));
        };
        transform *= if inverted { matrix.inverse() } else { matrix };
    }
    Ok((transform, resets))
}

/// The matrix of one operation, for column vectors; `None` for an unknown operation.
fn matrix(kind: &str, numbers: &[f64]) -> Option<DMat4> {
    Some(match (kind, numbers) {
        ("translate", &[x, y, z]) => DMat4::from_translation(DVec3::new(x, y, z)),
        ("translateX", &[x]) => DMat4::from_translation(DVec3::new(x, 0.0, 0.0)),
        ("translateY", &[y]) => DMat4::from_translation(DVec3::new(0.0, y, 0.0)),
        ("translateZ", &[z]) => DMat4::from_translation(DVec3::new(0.0, 0.0, z)),
        ("scale", &[x, y, z]) => DMat4::from_scale(DVec3::new(x, y, z)),
        ("scaleX", &[x]) => DMat4::from_scale(DVec3::new(x, 1.0, 1.0)),
        ("scaleY", &[y]) => DMat4::from_scale(DVec3::new(1.0, y, 1.0)),
        ("scaleZ", &[z]) => DMat4::from_scale(DVec3::new(1.0, 1.0, z)),
        ("rotateX", &[degrees]) => DMat4::from_rotation_x(degrees.to_radians()),
        ("rotateY", &[degrees]) => DMat4::from_rotation_y(degrees.to_radians()),
        ("rotateZ", &[degrees]) => DMat4::from_rotation_z(degrees.to_radians()),
        ("orient", &[w, x, y, z]) => DMat4::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()),
        // USD uses row vectors, so its rows are the columns here.
        ("transform", numbers) => DMat4::from_cols_array(numbers.first_chunk::<16>()?),
        (kind, &[x, y, z]) => {
            let order = kind.strip_prefix("rotate").filter(|order| order.len() == 3)?;
            // The rotation that is named first is applied first.
            order.chars().try_fold(DMat4::IDENTITY, |done, axis| {
                Some(
                    match axis {
                        'X' => DMat4::from_rotation_x(x.to_radians()),
                        'Y' => DMat4::from_rotation_y(y.to_radians()),
                        'Z' => DMat4::from_rotation_z(z.to_radians()),
                        _ => return None,
                    } * done,
                )
            })?
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_done_in_the_order_of_their_name() {
        let turned =
            |kind| matrix(kind, &[90.0, 90.0, 0.0]).expect("an operation").transform_point3(DVec3::Y);
        // X maps y to z, then Y maps z to x. In the opposite order Y leaves y, and X maps it to z.
        assert!(turned("rotateXYZ").abs_diff_eq(DVec3::X, 1e-12));
        assert!(turned("rotateYXZ").abs_diff_eq(DVec3::Z, 1e-12));
        assert_eq!(matrix("rotateXYW", &[0.0; 3]), None);
        assert_eq!(matrix("transform", &[1.0; 3]), None);
    }

    #[test]
    fn matrices_have_their_translation_in_the_last_row() {
        let rows = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, 4.0, 5.0, 1.0];
        let at = matrix("transform", &rows).expect("an operation").transform_point3(DVec3::ZERO);
        assert_eq!(at, DVec3::new(3.0, 4.0, 5.0));
    }
}
