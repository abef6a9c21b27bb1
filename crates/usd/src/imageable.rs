//! Which prims are drawn: visibility and purpose, by the rules of `UsdGeomImageable`.

use crate::transform::DEEPEST;
use crate::{Layer, UsdError, Value};

/// Why a prim is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undrawn {
    /// It or a prim above it is invisible.
    Invisible,
    /// Its purpose, or that of the nearest prim above it that states one, is `guide` or `proxy`: it stands for other prims.
    StandIn,
    /// It is below a `PointInstancer`, which draws copies of it in other places.
    Prototype,
}

/// Why a prim is not drawn; `None` for a prim that is. Animated visibility is that at the time that is set, otherwise at the start of
/// the stage; if the stage states none, at `start`, otherwise at its first sample.
///
/// # Errors
/// If the file contradicts itself.
pub fn undrawn(layer: &mut dyn Layer, prim: usize, start: Option<f64>) -> Result<Option<Undrawn>, UsdError> {
    let mut time = layer.time();
    if time.is_none() {
        let stated = layer.metadata("startTimeCode")?;
        time = stated.and_then(|value| value.numbers().first().copied()).or(start);
    }
    let (mut purpose, mut purpose_is_visible) = (None, None);
    let (mut invisible, mut is_prototype) = (false, false);
    let mut at = Some(prim);
    for _ in 0..DEEPEST {
        let Some(prim) = at else { break };
        is_prototype |= layer.kind(prim)?.as_deref() == Some("PointInstancer");
        invisible |= own_or_inherited(layer, prim, "visibility", time)?.as_deref() == Some("invisible");
        if purpose.is_none() {
            purpose = own_or_inherited(layer, prim, "purpose", time)?;
        }
        // `UsdGeomVisibilityAPI`: the visibility of one purpose below a prim.
        if let Some(purpose @ ("render" | "proxy" | "guide")) = purpose.as_deref()
            && purpose_is_visible.is_none()
        {
            let own = own_or_inherited(layer, prim, &format!("{purpose}Visibility"), time)?;
            purpose_is_visible = own.filter(|word| word != "inherited").map(|word| word != "invisible");
        }
        at = layer.parent(prim);
    }
    Ok(match purpose.as_deref() {
        _ if invisible => Some(Undrawn::Invisible),
        Some("guide" | "proxy") => Some(Undrawn::StandIn),
        Some("render") if purpose_is_visible == Some(false) => Some(Undrawn::Invisible),
        _ if is_prototype => Some(Undrawn::Prototype),
        _ => None,
    })
}

/// Whether the visibility of a prim or of one above it is animated.
///
/// # Errors
/// If the file contradicts itself.
pub fn visibility_changes(layer: &mut dyn Layer, prim: usize) -> Result<bool, UsdError> {
    let mut at = Some(prim);
    for _ in 0..DEEPEST {
        let Some(prim) = at else { break };
        let first = layer.sample(prim, "visibility", 0, 1)?;
        for sample in 1..layer.sample_times(prim, "visibility")?.len() {
            if layer.sample(prim, "visibility", sample, 1)? != first {
                return Ok(true);
            }
        }
        at = layer.parent(prim);
    }
    Ok(false)
}

/// The most prims that are asked for one attribute.
const MAX_BASES: usize = 64;

/// A token of a prim, otherwise of what it inherits or specializes within the file, at a time code.
fn own_or_inherited(
    layer: &mut dyn Layer,
    prim: usize,
    name: &str,
    time: Option<f64>,
) -> Result<Option<String>, UsdError> {
    let mut open = vec![prim];
    for _ in 0..MAX_BASES {
        let Some(prim) = open.pop() else { break };
        if let Some(token) = token_at(layer, prim, name, time)? {
            return Ok(Some(token));
        }
        open.extend(layer.bases(prim)?.into_iter().take(MAX_BASES).rev());
    }
    Ok(None)
}

/// A token at a time code, without interpolation.
fn token_at(
    layer: &mut dyn Layer,
    prim: usize,
    name: &str,
    time: Option<f64>,
) -> Result<Option<String>, UsdError> {
    let sample = match time {
        Some(time) => layer.around(prim, name, time)?.before,
        None => 0,
    };
    let value = match layer.sample(prim, name, sample, 1)? {
        Some(value) => Some(value),
        None => layer.default_value(prim, name, 1)?,
    };
    Ok(value.as_ref().and_then(Value::token).map(str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Source;

    /// One prim for each rule, named after what is found.
    const STAGE: &str = r#"#usda 1.0
(
    startTimeCode = 10
)
def Xform "shown"
{
    def Mesh "drawn_a"
    {
    }
    def Mesh "invisible_a"
    {
        token visibility = "invisible"
    }
    def Mesh "stand_in_a"
    {
        uniform token purpose = "proxy"
    }
    def Mesh "drawn_b"
    {
        uniform token purpose = "render"
    }
    def Mesh "invisible_d"
    {
        token visibility.timeSamples = { 0: "inherited", 10: "invisible", 20: "inherited" }
    }
    def Mesh "drawn_d"
    {
        token visibility = "invisible"
        token visibility.timeSamples = { 0: "invisible", 10: "inherited", 20: "invisible" }
    }
}
def Xform "hidden"
{
    token visibility = "invisible"
    def Xform "between"
    {
        def Mesh "invisible_b"
        {
            token visibility = "inherited"
        }
    }
}
def Xform "guides"
{
    uniform token purpose = "guide"
    def Mesh "stand_in_b"
    {
    }
    def Mesh "drawn_c"
    {
        uniform token purpose = "default"
    }
    def Xform "again"
    {
        token visibility = "invisible"
        def Mesh "invisible_c"
        {
        }
    }
}
def Xform "no_render"
{
    uniform token renderVisibility = "invisible"
    def Mesh "invisible_e"
    {
        uniform token purpose = "render"
    }
    def Mesh "drawn_e"
    {
    }
}
class Xform "_guide"
{
    uniform token purpose = "guide"
}
class Xform "_unseen" (
    specializes = </_guide>
)
{
    token visibility = "invisible"
}
def Mesh "stand_in_e" (
    inherits = </_guide>
)
{
}
def Xform "carries" (
    inherits = </_unseen>
)
{
    def Mesh "invisible_f"
    {
    }
}
def Mesh "drawn_f" (
    prepend specializes = </_guide>
)
{
    uniform token purpose = "default"
}
def PointInstancer "many"
{
    rel prototypes = </many/one/prototype_a>
    def Xform "one"
    {
        def Mesh "prototype_a"
        {
        }
    }
}
class Xform "template"
{
    def Mesh "gone_a"
    {
    }
}
def Mesh "gone_b" (
    active = false
)
{
}
over "else"
{
    def Mesh "gone_c"
    {
    }
}
"#;

    #[test]
    fn prims_are_drawn_by_the_rules_of_visibility_and_purpose() {
        let data = openusd::usda::parse(STAGE).expect("a stage");
        let mut bytes = std::io::Cursor::new(Vec::new());
        openusd::usdc::CrateWriter::write(&data, &mut bytes).expect("a crate");
        let bytes = bytes.into_inner();
        for (is_crate, bytes) in [(false, STAGE.as_bytes()), (true, &bytes[..])] {
            let mut layer = crate::open("a.usd", Source::Memory(bytes), is_crate).expect("a stage");
            let prims = layer.prims(&["Mesh"]).expect("prims");
            assert_eq!((prims.len(), layer.undefined(&["Mesh"]).expect("a number")), (16, 3));
            assert_eq!(layer.arcs(), ["inherited classes", "specialized prims"]);
            for (prim, _) in prims {
                let path = layer.path(prim);
                // The writer of the test stores tokens of time samples as strings, which no reader needs.
                if is_crate && path.ends_with("_d") {
                    continue;
                }
                let found = match undrawn(&mut *layer, prim, None).expect("known") {
                    None => "/drawn",
                    Some(Undrawn::Invisible) => "/invisible",
                    Some(Undrawn::StandIn) => "/stand_in",
                    Some(Undrawn::Prototype) => "/prototype",
                };
                assert!(path.contains(found), "{path}: {found}");
                let changes = visibility_changes(&mut *layer, prim).expect("known");
                assert_eq!(changes, path.ends_with("_d"), "{path}");
            }
        }
    }

    #[test]
    fn visibility_is_that_of_the_time_that_is_set() {
        let mut layer = crate::open("a.usd", Source::Memory(STAGE.as_bytes()), false).expect("a stage");
        let prim = layer.prim_at("/shown/invisible_d").expect("a prim");
        for (time, wanted) in [(0.0, None), (15.0, Some(Undrawn::Invisible)), (25.0, None)] {
            layer.set_time(time);
            assert_eq!(undrawn(&mut *layer, prim, None).expect("known"), wanted, "{time}");
        }
        // Without a start of the stage: the start that the caller knows.
        let text = STAGE.replace("startTimeCode = 10", "endTimeCode = 20");
        let mut layer = crate::open("a.usd", Source::Memory(text.as_bytes()), false).expect("a stage");
        assert_eq!(undrawn(&mut *layer, prim, None).expect("known"), None);
        assert_eq!(undrawn(&mut *layer, prim, Some(10.0)).expect("known"), Some(Undrawn::Invisible));
    }
}
