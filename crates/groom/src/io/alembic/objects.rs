//! The objects of an archive that are curves, with the transforms above them.

use std::sync::Arc;

use lovelock_alembic::{AlembicError, Archive, Compound, Object, Pod, Property, metadata_value};

use super::refused;

/// The deepest nesting of objects.
const DEEPEST: usize = 128;

/// The schemas of curves and of transforms.
const CURVES: &str = "AbcGeom_Curve_v2";
const TRANSFORM: &str = "AbcGeom_Xform_v3";

/// Names of parameters that give curves their colour, the first one that is there.
const COLOURS: [&str; 6] = ["groom_color", "Cd", "displayColor", "Cs", "color", "rgb"];

/// Names of parameters with the coordinates of roots on their surface.
const ROOT_UVS: [&str; 2] = ["groom_root_uv", "surface_uv_coordinate"];
/// Names of parameters that give curves their width.
const WIDTHS: [&str; 2] = ["groom_width", "width"];

/// An object of curves.
pub(super) struct CurveObject {
    /// Its path, for messages.
    pub(super) path: String,
    pub(super) points: Property,
    pub(super) counts: Property,
    pub(super) basis: Option<Property>,
    pub(super) knots: Option<Property>,
    pub(super) width: Option<Parameter>,
    pub(super) colour: Option<Parameter>,
    pub(super) guides: Option<Property>,
    /// The number and the name of the group of each curve.
    pub(super) groups: Option<Parameter>,
    pub(super) group_names: Option<Parameter>,
    /// The coordinates of each root on its surface.
    pub(super) root_uvs: Option<Parameter>,
    /// The transforms above it, innermost first.
    pub(super) above: Option<Arc<Ancestor>>,
    /// Its own visibility and that of the objects above it, innermost first.
    pub(super) visibility: Option<Arc<Visibility>>,
}

/// The visibility (`visible`) of an object, and of the nearest one above it that has one.
pub(super) struct Visibility {
    pub(super) own: Property,
    pub(super) above: Option<Arc<Visibility>>,
}

/// A parameter of geometry.
pub(super) struct Parameter {
    pub(super) name: String,
    pub(super) values: Property,
    /// Indices of `values`.
    pub(super) indices: Option<Property>,
    /// The name of its interpolation as in USD.
    pub(super) scope: Option<&'static str>,
}

/// A transform and those above it.
pub(super) struct Ancestor {
    pub(super) inherits: Option<Property>,
    pub(super) operations: Option<Property>,
    pub(super) values: Option<Property>,
    pub(super) above: Option<Arc<Ancestor>>,
}

impl CurveObject {
    /// Number of control points of each curve.
    pub(super) fn counts(&self, archive: &mut Archive<'_>, secs: f64) -> Result<Vec<usize>, AlembicError> {
        if self.counts.samples == 0 {
            return Err(refused(self, "nVertices without samples", "the number of points of each curve"));
        }
        let (sample, ..) = archive.times(&self.counts).around(secs, self.counts.samples);
        let mut counts = Vec::new();
        let mut wrong = None;
        archive.vectors(&self.counts, sample, &mut |[count]: [f32; 1]| {
            if count < 0.0 {
                wrong = Some(count);
            }
            counts.push(count as usize);
        })?;
        match wrong {
            Some(count) => Err(refused(self, format!("a curve of {count} points"), "no negative number")),
            None => Ok(counts),
        }
    }

    /// Whether the curves are invisible at a time, and whether that may change: the nearest object that does not defer to the one
    /// above it decides, as in the Alembic library.
    pub(super) fn is_invisible(
        &self,
        archive: &mut Archive<'_>,
        secs: f64,
    ) -> Result<(bool, bool), AlembicError> {
        let mut changes = false;
        let mut at = self.visibility.as_ref();
        while let Some(Visibility { own, above }) = at.map(Arc::as_ref) {
            changes |= !own.is_constant();
            let (sample, ..) = archive.times(own).around(secs, own.samples);
            match archive.few(own, sample, 1)?.first() {
                Some(&0.0) => return Ok((true, changes)),
                Some(&value) if value > 0.0 => return Ok((false, changes)),
                // -1: deferred.
                _ => at = above.as_ref(),
            }
        }
        Ok((false, changes))
    }
}

/// An object whose content is still to be visited.
struct Waiting {
    object: Object,
    path: String,
    above: Option<Arc<Ancestor>>,
    visibility: Option<Arc<Visibility>>,
    depth: usize,
}

/// Gives every object of curves to `take`, in the order of the archive.
pub(super) fn visit(
    archive: &mut Archive<'_>,
    take: &mut dyn FnMut(&mut Archive<'_>, CurveObject) -> Result<(), AlembicError>,
) -> Result<(), AlembicError> {
    let top = Waiting { object: archive.top(), path: String::new(), above: None, visibility: None, depth: 0 };
    let mut waiting = vec![top];
    while let Some(Waiting { object, path, above, visibility, depth }) = waiting.pop() {
        if depth > DEEPEST {
            return Err(AlembicError::Malformed {
                offset: 0,
                found: format!("{path}: objects nested more than {DEEPEST} times"),
                wanted: "fewer",
            });
        }
        let properties = archive.properties(&object)?;
        let visible = properties.get("visible").filter(|own| own.samples > 0 && own.ty.pod.bytes() > 0);
        let visibility = match visible {
            Some(own) => Some(Arc::new(Visibility { own: own.clone(), above: visibility })),
            None => visibility,
        };
        let above = if object.has_schema(TRANSFORM) {
            let transform = schema(archive, &properties, ".xform")?;
            let get = |name| transform.get(name).cloned();
            Some(Arc::new(Ancestor {
                inherits: get(".inherits"),
                operations: get(".ops"),
                values: get(".vals"),
                above,
            }))
        } else {
            above
        };
        if object.has_schema(CURVES)
            && let Some(curves) = curves(archive, &properties, &path, above.clone(), visibility.clone())?
        {
            take(archive, curves)?;
        }
        for child in archive.children(&object)?.into_iter().rev() {
            let path = format!("{path}/{}", child.name);
            waiting.push(Waiting {
                object: child,
                path,
                above: above.clone(),
                visibility: visibility.clone(),
                depth: depth + 1,
            });
        }
    }
    Ok(())
}

fn schema(archive: &mut Archive<'_>, properties: &Compound, name: &str) -> Result<Compound, AlembicError> {
    match properties.get(name) {
        Some(property) => archive.compound(property),
        None => Ok(Compound::default()),
    }
}

fn curves(
    archive: &mut Archive<'_>,
    properties: &Compound,
    path: &str,
    above: Option<Arc<Ancestor>>,
    visibility: Option<Arc<Visibility>>,
) -> Result<Option<CurveObject>, AlembicError> {
    let geometry = schema(archive, properties, ".geom")?;
    let (Some(points), Some(counts)) = (geometry.get("P"), geometry.get("nVertices")) else {
        return Ok(None);
    };
    let parameters = match geometry.get(".arbGeomParams") {
        Some(property) => archive.compound(property)?,
        None => Compound::default(),
    };
    let colour = COLOURS.iter().find_map(|name| parameters.get(name));
    // The schema's own width comes before parameters that anybody may add.
    let width = geometry.get("width").or_else(|| WIDTHS.iter().find_map(|name| parameters.get(name)));
    Ok(Some(CurveObject {
        path: path.to_owned(),
        points: points.clone(),
        counts: counts.clone(),
        basis: geometry.get("curveBasisAndType").cloned(),
        knots: geometry.get(".knots").cloned(),
        width: values(archive, width)?,
        colour: values(archive, colour)?,
        groups: values(archive, parameters.get("groom_group_id"))?,
        group_names: match parameters.get("groom_group_name") {
            Some(property) => texts(archive, property)?,
            None => None,
        },
        root_uvs: match ROOT_UVS.iter().find_map(|name| parameters.get(name)) {
            Some(property) => values(archive, Some(property))?.filter(|uvs| uvs.values.ty.extent >= 2),
            None => None,
        },
        guides: parameters.get("groom_guide").filter(|guides| guides.ty.pod.bytes() > 0).cloned(),
        above,
        visibility,
    }))
}

/// A parameter of numbers.
fn values(archive: &mut Archive<'_>, property: Option<&Property>) -> Result<Option<Parameter>, AlembicError> {
    let Some(property) = property else { return Ok(None) };
    Ok(parameter(archive, property)?.filter(|parameter| parameter.values.ty.pod.bytes() > 0))
}

/// A parameter of texts.
fn texts(archive: &mut Archive<'_>, property: &Property) -> Result<Option<Parameter>, AlembicError> {
    Ok(parameter(archive, property)?.filter(|parameter| parameter.values.ty.pod == Pod::String))
}

/// A parameter as values, or as values and indices.
fn parameter(archive: &mut Archive<'_>, property: &Property) -> Result<Option<Parameter>, AlembicError> {
    let scope = match metadata_value(&property.metadata, "geoScope") {
        Some("con") => Some("constant"),
        Some("uni") => Some("uniform"),
        Some("var" | "fvr") => Some("varying"),
        Some("vtx") => Some("vertex"),
        _ => None,
    };
    let inner = archive.compound(property)?;
    let values = inner.get(".vals").unwrap_or(property);
    if values.samples == 0 {
        return Ok(None);
    }
    let indices = inner.get(".indices").filter(|indices| indices.samples > 0).cloned();
    Ok(Some(Parameter { name: property.name.clone(), values: values.clone(), indices, scope }))
}
