//! Damaged stages give values or an error, never a panic.

use lovelock_testkit::fuzz::damaged;
use lovelock_usd::{Source, UsdError, Value, open, own_transform, to_stage, transform_times};

use crate::many_prims::crate_of;

/// Prims with every type of value, samples over time, targets and transforms.
const STAGE: &str = r#"#usda 1.0
(
    defaultPrim = "w"
    metersPerUnit = 0.01
    upAxis = "Z"
)
def Xform "w"
{
    double3 xformOp:translate = (1, 2, 3)
    float3 xformOp:rotateXYZ = (10, 20, 30)
    float3 xformOp:scale.timeSamples = {
        0: (1, 1, 1),
        2.5: (2, 2, 2),
    }
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]

    def BasisCurves "a" (
        active = true
    )
    {
        uniform token type = "linear"
        int[] curveVertexCounts = [2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3]
        point3f[] points.timeSamples = {
            1: [(0, 0, 1), (0, 0, 2), (1, 0, 0)],
            4: [(1, 0, 1), (1, 0, 2), (1, 0, 3)],
        }
        float[] widths = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17] (
            interpolation = "vertex"
        )
        double[] knots = [0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5]
        half[] small = [1, 2, 3]
        quatf[] turns = [(1, 0, 0, 0), (0.7, 0, 0, 0.7)]
        matrix4d[] binds = [((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (3, 4, 5, 1))]
        bool shown = true
        rel skel:skeleton = </w/b>
    }

    over "b"
    {
        uniform token[] joints = ["hips", "hips/head"]
        matrix4d xformOp:transform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (3, 4, 5, 1))
        uniform token[] xformOpOrder = ["!resetXformStack!", "!invert!xformOp:transform"]
    }
}
"#;

const ATTRIBUTES: [&str; 12] = [
    "type",
    "curveVertexCounts",
    "points",
    "widths",
    "knots",
    "small",
    "turns",
    "binds",
    "shown",
    "joints",
    "xformOpOrder",
    "missing",
];

/// Reads all that a stage holds. Returns how many values that was.
fn read_all(bytes: &[u8], is_crate: bool) -> Result<usize, UsdError> {
    let mut layer = open("a.usd", Source::Memory(bytes), is_crate)?;
    let layer = &mut *layer;
    let mut values = 0;
    let mut count = |value: Option<Value>| {
        values += value.map_or(0, |value| value.into_floats().len() + 1);
    };
    let mut prims: Vec<usize> =
        layer.prims(&["Xform", "BasisCurves"])?.into_iter().map(|(prim, _)| prim).collect();
    prims.truncate(64);
    prims.extend(["/w/b", "/w", "/", "", "w/a", "/w/a/b"].iter().filter_map(|path| layer.prim_at(path)));
    for time in [None, Some(-1.0), Some(2.5), Some(f64::NAN)] {
        if let Some(time) = time {
            layer.set_time(time);
        }
        for &prim in &prims {
            // A damaged name may hold any sign, so that the path says nothing of the depth. Parents must come to an end.
            let depth = std::iter::successors(Some(prim), |&p| layer.parent(p)).take(1 << 16).count();
            assert!(depth < 1 << 16, "{}", layer.path(prim));
            for name in ATTRIBUTES {
                count(layer.attribute(prim, name, 1 << 12)?);
                count(layer.field(prim, name, "interpolation")?);
                for sample in 0..layer.sample_times(prim, name)?.len().min(4) {
                    count(layer.sample(prim, name, sample, 1 << 12)?);
                }
            }
            layer.targets(prim, "skel:skeleton")?;
            transform_times(layer, prim)?;
            assert!(to_stage(layer, prim)?.is_finite());
            own_transform(layer, prim)?;
        }
    }
    for name in ["metersPerUnit", "upAxis", "defaultPrim"] {
        count(layer.metadata(name)?);
    }
    layer.arcs();
    Ok(values)
}

fn reads(bytes: &[u8], is_crate: bool) -> bool {
    match read_all(bytes, is_crate) {
        Ok(values) => {
            assert!(values <= 1 << 22, "{values} values of {} bytes", bytes.len());
            true
        }
        Err(error) => {
            assert!(!error.to_string().contains('\n'), "{error}");
            false
        }
    }
}

#[test]
fn damaged_stage_text() {
    damaged("stage text", &[STAGE.into()], 1000, |bytes| reads(bytes, false));
}

#[test]
fn damaged_stage_crate() {
    damaged("stage crate", &[crate_of(STAGE)], 3000, |bytes| reads(bytes, true));
}
