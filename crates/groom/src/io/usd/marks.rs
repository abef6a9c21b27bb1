//! Groups of curves, and the places of their roots on a surface.

use lovelock_usd::Value;

use super::stage::Stage;
use crate::io::HairFileError;
use crate::io::marks::{Marks, per_curve};

/// Attributes with the coordinates of roots: those of Unreal's grooms, and of Blender's hair curves.
const ROOT_UVS: [&str; 2] = ["primvars:groom_root_uv", "primvars:surface_uv_coordinate"];

/// A value, and the indices into it.
type Indexed = (Value, Option<Vec<i32>>);

/// Adds those of a prim. `counts` are the numbers of control points of its curves.
pub(super) fn add(
    marks: &mut Marks,
    layer: &mut Stage<'_>,
    prim: usize,
    counts: &[usize],
) -> Result<(), HairFileError> {
    let most = counts.iter().sum::<usize>().max(1);
    let mut value = |name: &str| -> Result<Option<Indexed>, HairFileError> {
        let Some(value) = layer.attribute(prim, name, most)? else { return Ok(None) };
        let indices = layer.attribute(prim, &format!("{name}:indices"), most)?;
        Ok(Some((value, indices.map(Value::into_ints))))
    };
    let groups = value("primvars:groom_group_id")?.and_then(|(value, indices)| {
        let groups = match value {
            Value::Ints(groups) => groups,
            other => other.into_floats().into_iter().map(|group| group as i32).collect(),
        };
        per_curve(&picked(groups, indices)?, counts)
    });
    let names = value("primvars:groom_group_name")?.and_then(|(value, indices)| {
        let names = value.token().map_or_else(|| value.clone().into_tokens(), |name| vec![name.to_owned()]);
        per_curve(&picked(names, indices)?, counts)
    });
    let mut uvs = None;
    for name in ROOT_UVS {
        if let (None, Some((value, indices))) = (&uvs, value(name)?) {
            let all = value.into_vectors().iter().map(|uv| [uv.x, uv.y]).collect();
            uvs = picked(all, indices).and_then(|all| per_curve(&all, counts));
        }
    }
    marks.add(counts.len(), groups, names, uvs);
    Ok(())
}

/// The values at the indices, if there are any.
fn picked<T: Clone>(values: Vec<T>, indices: Option<Vec<i32>>) -> Option<Vec<T>> {
    let Some(indices) = indices else { return Some(values) };
    indices.iter().map(|&index| values.get(usize::try_from(index).ok()?).cloned()).collect()
}
