//! The state of a scene while its directives are read.

use lovelock_base::numbers::{number, numbers_of};
use lovelock_base::words::counted;
use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use glam::{DMat4, DVec3, Vec3};

use super::curve::Parameters;
use super::tokens::{Token, Tokens};
use crate::io::HairFileError;
use crate::io::file::{Hidden, MAX_COPIED_POINTS, RawHair};
use crate::io::source::open_beside;

/// The most open blocks, named coordinate systems, objects and included files. Real scenes have a few hundred.
const MAX_BLOCKS: usize = 10_000;
const MAX_INCLUDES: usize = 4096;
const DEEPEST_INCLUDE: usize = 32;
/// The most points of all polylines.
const MAX_POINTS: usize = 1 << 28;

/// Strands with their widths.
#[derive(Default)]
struct Strands {
    counts: Vec<u32>,
    points: Vec<Vec3>,
    widths: Vec<f32>,
    /// Whether each strand is invisible.
    hidden: Vec<bool>,
}

/// What applies to the shapes that follow, until the block ends.
#[derive(Clone)]
struct State {
    transform: DMat4,
    /// The parameters of shapes that state none of their own (`Attribute "shape"`).
    defaults: Rc<Parameters>,
}

/// A file that is being read.
struct Frame<'a> {
    name: String,
    tokens: Tokens<'a>,
    /// The state and the number of open blocks to return to at its end (`Import`).
    restore: Option<(State, usize)>,
}

/// Reads the directives of a scene.
pub(super) struct Scene<'a> {
    name: &'a str,
    folder: Option<PathBuf>,
    files: Vec<Frame<'a>>,
    includes: usize,
    state: State,
    /// The states before the open blocks.
    blocks: Vec<State>,
    systems: HashMap<Vec<u8>, DMat4>,
    /// Whether transforms apply to the start of the shutter's time, at which the scene is taken.
    is_active: bool,
    strands: Strands,
    objects: HashMap<Vec<u8>, Strands>,
    /// The object that is being defined, with its name.
    object: Option<(Vec<u8>, Strands)>,
    copied: usize,
    has_widths: bool,
    unfit: u64,
    notes: Vec<String>,
}

impl<'a> Scene<'a> {
    pub(super) fn new(name: &'a str, folder: Option<PathBuf>) -> Self {
        Self {
            name,
            folder,
            files: Vec::new(),
            includes: 0,
            state: State { transform: DMat4::IDENTITY, defaults: Rc::default() },
            blocks: Vec::new(),
            systems: HashMap::new(),
            is_active: true,
            strands: Strands::default(),
            objects: HashMap::new(),
            object: None,
            copied: 0,
            has_widths: false,
            unfit: 0,
            notes: Vec::new(),
        }
    }

    /// Reads a whole scene.
    pub(super) fn read(mut self, reader: Box<dyn BufRead + 'a>) -> Result<RawHair, HairFileError> {
        self.open(self.name.to_owned(), reader, None)?;
        let mut parameters = Parameters::default();
        loop {
            let Some(token) = self.next()? else {
                let Some(frame) = self.files.pop() else { break };
                if let Some((state, blocks)) = frame.restore {
                    self.state = state;
                    self.blocks.truncate(blocks);
                }
                continue;
            };
            // Parameters of directives that are not looked at are skipped word by word.
            if token == Token::Word {
                self.directive(&mut parameters)?;
            }
        }
        if self.unfit > 0 {
            let curves = counted(self.unfit, "curve", "curves");
            self.notes.push(format!(
                "Left out {curves} whose number of control points does not fit the degree and basis."
            ));
        }
        if self.strands.counts.is_empty() {
            let found = match self.unfit {
                0 => "no curve".to_owned(),
                unfit => {
                    let curves = counted(unfit, "curve", "curves");
                    format!("{curves}, none of which has a fitting number of points")
                }
            };
            let wanted = "a directive `Shape \"curve\"` with points".to_owned();
            return Err(HairFileError::Malformed { name: self.name.to_owned(), offset: 0, found, wanted });
        }
        let mut raw = RawHair::new(self.strands.counts, self.strands.points);
        raw.thickness = Some(self.strands.widths).filter(|_| self.has_widths);
        if self.unfit > 0 {
            raw.dropped.insert("unfit_curves".to_owned(), self.unfit);
        }
        raw.notes = self.notes;
        if self.strands.hidden.contains(&true) {
            let mark = |&is_hidden: &bool| is_hidden.then_some(Hidden::Invisible);
            raw.hidden = self.strands.hidden.iter().map(mark).collect();
        }
        Ok(raw)
    }

    fn open(
        &mut self,
        name: String,
        reader: Box<dyn BufRead + 'a>,
        restore: Option<(State, usize)>,
    ) -> Result<(), HairFileError> {
        let tokens =
            Tokens::new(reader).map_err(|source| HairFileError::Io { name: name.clone(), source })?;
        self.files.push(Frame { name, tokens, restore });
        Ok(())
    }

    /// The next token of the innermost file; `None` at its end.
    fn next(&mut self) -> Result<Option<Token>, HairFileError> {
        let Some(frame) = self.files.last_mut() else { return Ok(None) };
        frame.tokens.next().map_err(|source| HairFileError::Io { name: frame.name.clone(), source })
    }

    fn text(&self) -> &[u8] {
        self.files.last().map_or(&[], |frame| frame.tokens.text())
    }

    fn number(&self) -> Option<f32> {
        self.files.last().and_then(|frame| frame.tokens.number())
    }

    fn put_back(&mut self, token: Token) {
        if let Some(frame) = self.files.last_mut() {
            frame.tokens.put_back(token);
        }
    }

    fn malformed(&self, wanted: &str) -> HairFileError {
        let (name, offset) =
            self.files.last().map_or((self.name, 0), |frame| (frame.name.as_str(), frame.tokens.start()));
        let text: String = String::from_utf8_lossy(self.text()).chars().take(40).collect();
        HairFileError::Malformed {
            name: name.to_owned(),
            offset,
            found: format!("`{}`", text.escape_debug()),
            wanted: wanted.to_owned(),
        }
    }

    fn directive(&mut self, parameters: &mut Parameters) -> Result<(), HairFileError> {
        let identity = DMat4::IDENTITY;
        match self.text() {
            b"Shape" => return self.shape(parameters),
            b"AttributeBegin" | b"TransformBegin" => self.begin()?,
            b"AttributeEnd" | b"TransformEnd" => self.end(),
            b"Attribute" => self.attribute(parameters)?,
            b"WorldBegin" => self.state.transform = identity,
            b"Identity" => self.set(identity),
            b"Translate" => {
                let by = self.numbers::<3>("three numbers after Translate")?;
                self.set(self.state.transform * DMat4::from_translation(DVec3::from(by)));
            }
            b"Scale" => {
                let by = self.numbers::<3>("three numbers after Scale")?;
                self.set(self.state.transform * DMat4::from_scale(DVec3::from(by)));
            }
            b"Rotate" => {
                let [degrees, x, y, z] = self.numbers::<4>("an angle and an axis after Rotate")?;
                let axis = DVec3::new(x, y, z).try_normalize().unwrap_or(DVec3::X);
                self.set(self.state.transform * DMat4::from_axis_angle(axis, degrees.to_radians()));
            }
            b"LookAt" => {
                let n = self.numbers::<9>("nine numbers after LookAt")?;
                let [eye, look, up] = [0, 3, 6].map(|k| DVec3::new(n[k], n[k + 1], n[k + 2]));
                self.set(self.state.transform * look_at(eye, look, up));
            }
            b"Transform" => {
                let matrix = self.numbers::<16>("sixteen numbers after Transform")?;
                self.set(DMat4::from_cols_array(&matrix));
            }
            b"ConcatTransform" => {
                let matrix = self.numbers::<16>("sixteen numbers after ConcatTransform")?;
                self.set(self.state.transform * DMat4::from_cols_array(&matrix));
            }
            b"CoordinateSystem" => {
                let name = self.quoted("a name in quotes after CoordinateSystem")?;
                if self.systems.len() >= MAX_BLOCKS {
                    return Err(self.malformed("at most 10000 coordinate systems"));
                }
                self.systems.insert(name, self.state.transform);
            }
            b"CoordSysTransform" => {
                let name = self.quoted("a name in quotes after CoordSysTransform")?;
                if let Some(&transform) = self.systems.get(&name) {
                    self.set(transform);
                }
            }
            b"ActiveTransform" => {
                self.next()?;
                self.is_active = self.text() != b"EndTime";
            }
            b"ObjectBegin" => {
                let name = self.quoted("a name in quotes after ObjectBegin")?;
                self.begin()?;
                self.end_object()?;
                self.object = Some((name, Strands::default()));
            }
            b"ObjectEnd" => {
                self.end_object()?;
                self.end();
            }
            b"ObjectInstance" => {
                let name = self.quoted("a name in quotes after ObjectInstance")?;
                self.instance(&name)?;
            }
            b"Include" => self.include(false)?,
            b"Import" => self.include(true)?,
            _ => {}
        }
        Ok(())
    }

    fn set(&mut self, transform: DMat4) {
        if self.is_active {
            self.state.transform = transform;
        }
    }

    fn begin(&mut self) -> Result<(), HairFileError> {
        if self.blocks.len() >= MAX_BLOCKS {
            return Err(self.malformed("at most 10000 open blocks"));
        }
        self.blocks.push(self.state.clone());
        Ok(())
    }

    fn end(&mut self) {
        if let Some(state) = self.blocks.pop() {
            self.state = state;
        }
    }

    /// Sets the defaults of what follows in its block. Those of anything but shapes are of no use here.
    fn attribute(&mut self, parameters: &mut Parameters) -> Result<(), HairFileError> {
        let target = self.quoted("a target in quotes after Attribute, such as \"shape\"")?;
        self.parameters(parameters)?;
        if target == b"shape" {
            self.state.defaults = Rc::new(parameters.clone());
        }
        Ok(())
    }

    /// The `N` numbers after a directive, with or without brackets.
    fn numbers<const N: usize>(&mut self, wanted: &str) -> Result<[f64; N], HairFileError> {
        let mut numbers = [0.0; N];
        let mut bracket = false;
        for number in &mut numbers {
            let mut token = self.next()?;
            if token == Some(Token::Open) && !bracket {
                bracket = true;
                token = self.next()?;
            }
            let read = self.number().filter(|value| token == Some(Token::Word) && value.is_finite());
            *number = f64::from(read.ok_or_else(|| self.malformed(wanted))?);
        }
        if bracket && self.next()? != Some(Token::Close) {
            return Err(self.malformed(wanted));
        }
        Ok(numbers)
    }

    fn quoted(&mut self, wanted: &str) -> Result<Vec<u8>, HairFileError> {
        match self.next()? {
            Some(Token::Quoted) => Ok(self.text().to_vec()),
            _ => Err(self.malformed(wanted)),
        }
    }

    fn shape(&mut self, parameters: &mut Parameters) -> Result<(), HairFileError> {
        if self.next()? != Some(Token::Quoted) {
            return Err(self.malformed("the kind of a shape in quotes"));
        }
        if self.text() != b"curve" {
            return Ok(());
        }
        self.parameters(parameters)?;
        let strands = self.object.as_mut().map_or(&mut self.strands, |(_, strands)| strands);
        let first = strands.points.len();
        let Some(count) = parameters.polyline(&mut strands.points, &mut strands.widths) else {
            self.unfit += 1;
            return Ok(());
        };
        strands.counts.push(count);
        strands.hidden.push(parameters.is_invisible());
        let transform = self.state.transform;
        let scale = transform.determinant().abs().cbrt() as f32;
        for point in &mut strands.points[first..] {
            *point = transform.transform_point3(point.as_dvec3()).as_vec3();
        }
        strands.widths[first..].iter_mut().for_each(|width| *width *= scale);
        let points = strands.points.len();
        self.has_widths |= parameters.has_width();
        if points > MAX_POINTS { Err(self.malformed("268435456 points at most")) } else { Ok(()) }
    }

    /// The parameters after the kind of a curve: a declaration in quotes, then a value or values in brackets.
    fn parameters(&mut self, into: &mut Parameters) -> Result<(), HairFileError> {
        into.reset(&self.state.defaults);
        loop {
            match self.next()? {
                Some(Token::Quoted) => {}
                Some(token) => {
                    self.put_back(token);
                    return Ok(());
                }
                None => return Ok(()),
            }
            let mut words = self.text().split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            let (kind, name) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
            let what = match (kind, name) {
                (b"point" | b"point3", b"P") => What::Points,
                (b"float", b"width") => What::Width,
                (b"float", b"width0") => What::Width0,
                (b"float", b"width1") => What::Width1,
                (b"integer", b"degree") => What::Degree,
                (b"string", b"basis") => What::Basis,
                (b"float", b"alpha") => What::Alpha,
                _ => What::Other,
            };
            if matches!(what, What::Points) {
                into.points.clear();
            }
            let mut token = self.next()?;
            let in_brackets = token == Some(Token::Open);
            if in_brackets {
                token = self.next()?;
            }
            while let Some(found) = token.filter(|&token| token != Token::Close) {
                self.value(what, found, into);
                if !in_brackets {
                    break;
                }
                token = self.next()?;
            }
            if token.is_none() {
                return Err(self.malformed("the values of a parameter: the file is truncated"));
            }
        }
    }

    fn value(&self, what: What, token: Token, into: &mut Parameters) {
        let value = || self.number().filter(|_| token == Token::Word);
        match what {
            What::Points => {
                let word = std::str::from_utf8(self.text()).unwrap_or_default();
                let before = into.points.len();
                let values = numbers_of(word).map(number).take_while(Option::is_some);
                into.points.extend(values.flatten().map(|value| value as f32));
                let parts = numbers_of(word).count();
                into.is_broken |= token != Token::Word || parts == 0 || into.points.len() - before != parts;
            }
            What::Alpha => into.alpha = value(),
            What::Width => into.width = value(),
            What::Width0 => into.width0 = value(),
            What::Width1 => into.width1 = value(),
            What::Degree => {
                into.degree = value();
                into.is_broken |= into.degree.is_none();
            }
            What::Basis => match self.text() {
                b"bezier" => into.is_bspline = false,
                b"bspline" => into.is_bspline = true,
                _ => into.is_broken = true,
            },
            What::Other => {}
        }
    }

    fn end_object(&mut self) -> Result<(), HairFileError> {
        if let Some((name, strands)) = self.object.take() {
            if self.objects.len() >= MAX_BLOCKS {
                return Err(self.malformed("at most 10000 objects"));
            }
            self.objects.insert(name, strands);
        }
        Ok(())
    }

    /// Adds the strands of an object. Where they were defined, its own transform has been applied.
    fn instance(&mut self, name: &[u8]) -> Result<(), HairFileError> {
        let Some(object) = self.objects.get(name) else {
            let name: String = String::from_utf8_lossy(name).chars().take(80).collect();
            self.note(format!("The object `{}` is not defined.", name.escape_debug()));
            return Ok(());
        };
        self.copied += object.points.len();
        if self.copied > MAX_COPIED_POINTS {
            return Err(self.malformed("at most 33554432 points of repeated objects"));
        }
        let transform = self.state.transform;
        let scale = transform.determinant().abs().cbrt() as f32;
        self.strands.counts.extend(&object.counts);
        self.strands.hidden.extend(&object.hidden);
        self.strands.widths.extend(object.widths.iter().map(|width| width * scale));
        let place = |point: &Vec3| transform.transform_point3(point.as_dvec3()).as_vec3();
        self.strands.points.extend(object.points.iter().map(place));
        Ok(())
    }

    /// Opens the file after `Include` or `Import`. One that cannot be opened is left out with a note.
    fn include(&mut self, alone: bool) -> Result<(), HairFileError> {
        let name = self.quoted("the name of a file in quotes")?;
        let name = String::from_utf8_lossy(&name).into_owned();
        let short: String = name.chars().take(80).collect::<String>().escape_debug().collect();
        self.includes += 1;
        if self.includes > MAX_INCLUDES || self.files.len() >= DEEPEST_INCLUDE {
            return Err(self.malformed("4096 included files at most, 32 within each other"));
        }
        match open_beside(self.folder.as_deref(), Path::new(&name)) {
            Ok(file) => {
                let restore = alone.then(|| (self.state.clone(), self.blocks.len()));
                self.open(name, Box::new(BufReader::with_capacity(1 << 18, file)), restore)?;
            }
            Err(why) => self.note(format!("The included file `{short}` was left out: {why}.")),
        }
        Ok(())
    }

    /// Adds a note, up to a number that somebody may read.
    fn note(&mut self, note: String) {
        if self.notes.len() < 20 {
            self.notes.push(note);
        }
    }
}

/// A parameter of a curve.
#[derive(Clone, Copy)]
enum What {
    Points,
    Width,
    Width0,
    Width1,
    Degree,
    Basis,
    Alpha,
    Other,
}

/// pbrt's `LookAt`: from the world to a camera that looks along +Z, left-handed.
fn look_at(eye: DVec3, look: DVec3, up: DVec3) -> DMat4 {
    let forward = (look - eye).try_normalize().unwrap_or(DVec3::Z);
    let right = up.cross(forward).try_normalize().unwrap_or(DVec3::X);
    let up = forward.cross(right);
    let camera = DMat4::from_cols(right.extend(0.0), up.extend(0.0), forward.extend(0.0), eye.extend(1.0));
    camera.inverse()
}
