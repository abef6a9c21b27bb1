//! Primvars: values over a shape, by the rules of `UsdGeomPrimvar`.

use crate::transform::DEEPEST;
use crate::{Layer, UsdError, Value};

/// The values of a primvar.
#[derive(Clone, Debug, PartialEq)]
pub struct Primvar {
    /// The attribute that it was read from, for messages.
    pub name: String,
    /// Its values.
    pub values: Value,
    /// Indices of the values, if it has some.
    pub indices: Option<Vec<i32>>,
    /// The interpolation that the file states.
    pub interpolation: Option<String>,
    /// How many values belong together, if the file states it.
    pub element_size: Option<usize>,
}

/// A primvar of a prim, named without `primvars:`: its own `primvars:NAME`, otherwise the attribute `NAME` if the schema has one of this
/// name, otherwise `primvars:NAME` of the nearest prim above it if that one is constant. `most` limits the length of compressed arrays.
///
/// # Errors
/// If the file contradicts itself.
pub fn primvar(
    layer: &mut dyn Layer,
    prim: usize,
    name: &str,
    most: usize,
) -> Result<Option<Primvar>, UsdError> {
    let full = format!("primvars:{name}");
    for name in [full.as_str(), name] {
        if let Some(values) = layer.attribute(prim, name, most)? {
            return read(layer, prim, name, values, most).map(Some);
        }
    }
    let mut at = layer.parent(prim);
    for _ in 0..DEEPEST {
        let Some(above) = at else { break };
        if let Some(values) = layer.attribute(above, &full, most)? {
            let found = read(layer, above, &full, values, most)?;
            // Constant is the default.
            if found.interpolation.as_deref().is_none_or(|word| word == "constant") {
                return Ok(Some(found));
            }
        }
        at = layer.parent(above);
    }
    Ok(None)
}

fn read(
    layer: &mut dyn Layer,
    prim: usize,
    name: &str,
    values: Value,
    most: usize,
) -> Result<Primvar, UsdError> {
    let indices = layer.attribute(prim, &format!("{name}:indices"), most)?.map(Value::into_ints);
    let interpolation = layer.field(prim, name, "interpolation")?;
    let interpolation = interpolation.as_ref().and_then(Value::token).map(str::to_owned);
    let size = layer.field(prim, name, "elementSize")?;
    let element_size =
        size.and_then(|size| size.numbers().first().copied()).map(|size| size.max(0.0) as usize);
    Ok(Primvar { name: name.to_owned(), values, indices, interpolation, element_size })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Source;

    const STAGE: &str = r#"#usda 1.0
def Xform "top"
{
    float[] primvars:widths = [5]
    color3f[] primvars:displayColor = [(0, 0, 1), (0, 1, 0)] (
        interpolation = "vertex"
    )
    def Xform "middle"
    {
        float[] primvars:widths = [4] (
            interpolation = "constant"
        )
        def BasisCurves "both"
        {
            float[] widths = [1]
            float[] primvars:widths = [2, 3] (
                elementSize = 2
                interpolation = "uniform"
            )
            int[] primvars:widths:indices = [1, 0, 1]
        }
        def BasisCurves "plain"
        {
            float[] widths = [1]
        }
        def BasisCurves "blocked"
        {
            float[] widths = [1]
            float[] primvars:widths = None
        }
        def BasisCurves "inherits"
        {
        }
    }
    def BasisCurves "of_top"
    {
    }
}
"#;

    #[test]
    fn primvars_win_over_attributes_and_these_over_what_is_inherited() {
        // The writer of the test may not know blocked values.
        let without_block = STAGE.replace("float[] primvars:widths = None", "");
        let data = openusd::usda::parse(&without_block).expect("a stage");
        let mut bytes = std::io::Cursor::new(Vec::new());
        openusd::usdc::CrateWriter::write(&data, &mut bytes).expect("a crate");
        let bytes = bytes.into_inner();
        for (is_crate, bytes) in [(false, STAGE.as_bytes()), (true, &bytes[..])] {
            let mut layer = crate::open("a.usd", Source::Memory(bytes), is_crate).expect("a stage");
            let mut of = |path: &str, name: &str| {
                let prim = layer.prim_at(path).expect("a prim");
                primvar(&mut *layer, prim, name, 64).expect("read")
            };
            let mut widths = |path: &str| of(path, "widths").expect("widths").values.into_floats();
            assert_eq!(widths("/top/middle/both"), [2.0, 3.0]);
            assert_eq!(widths("/top/middle/plain"), [1.0]);
            assert_eq!(widths("/top/middle/blocked"), [1.0]);
            assert_eq!(widths("/top/middle/inherits"), [4.0]);
            assert_eq!(widths("/top/of_top"), [5.0]);
            let both = of("/top/middle/both", "widths").expect("widths");
            assert_eq!(both.name, "primvars:widths");
            assert_eq!(both.indices, Some(vec![1, 0, 1]));
            assert_eq!((both.interpolation.as_deref(), both.element_size), (Some("uniform"), Some(2)));
            // Only constant values are inherited.
            assert_eq!(of("/top/of_top", "displayColor"), None);
        }
    }
}
