//! Loads the scene of a project. Each part is reused until its sources change.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lovelock_groom::Obstacle;
use lovelock_motion::{Collider, ColliderEdits, Face, ScalpFit};
use lovelock_project::Project;
use lovelock_project::error::{Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_style::StyleCache;

use super::control::LoadControl;
use super::hair_slot::HairSlot;
use super::head_path::HeadPath;
use super::parts::{BodyKey, BodyPart, MotionKey, MotionPart, face_notes};
use super::scalp_part::{Enlarged, ScalpPart};
use super::skin_hair_part::{SkinHairPart, mask_notes};
use super::styling::{MorphCache, MorphSource};
use super::{Scene, StyleSource, SurroundingsLoader};

/// A part and its sources.
#[derive(Debug)]
struct Kept<K, T, B = BodyPart> {
    key: K,
    /// The body that a motion, or the scalp that a hairstyle was made for.
    body: Option<Arc<B>>,
    part: Arc<T>,
}

/// The shapes that hair collides with, and those that only block the wind.
type ColliderLists = [Arc<[Collider]>; 2];

/// Loads scenes of projects. Parts whose sources have not changed are shared with the previous scene.
#[derive(Debug, Default)]
pub struct SceneLoader {
    body: Option<Kept<BodyKey, BodyPart>>,
    motion: Option<Kept<MotionKey, MotionPart>>,
    scalp: Option<Kept<ScalpFit, ScalpPart>>,
    hair: HairSlot,
    /// The second style of the morph.
    other_hair: HairSlot,
    morph: MorphCache,
    enlarged: Enlarged,
    skin_hair: SkinHairPart,
    surroundings: SurroundingsLoader,
    head_path: Option<(Arc<MotionPart>, bool, Arc<HeadPath>)>,
    colliders: Option<(Arc<BodyPart>, ColliderEdits, ColliderLists)>,
}

impl SceneLoader {
    /// A loader without cached parts.
    pub fn new() -> Self {
        Self::default()
    }

    /// The most memory of the hairstyles that are kept between two layers, bytes: those of the hair and those of its morph, each of the
    /// cut and the ties, and of the layers.
    pub const MAX_LAYER_BYTES: u64 = 4 * StyleCache::MAX_BYTES;

    /// The memory of the hairstyles that are kept between two layers, bytes.
    pub fn layer_bytes(&self) -> u64 {
        self.hair.layer_bytes() + self.other_hair.layer_bytes()
    }

    /// As [`SceneLoader::load`], without progress and cancellation.
    ///
    /// # Errors
    /// As [`SceneLoader::load`].
    pub fn load_now(
        &mut self,
        project: &Project,
        access: &Access,
    ) -> Result<(Arc<Scene>, Vec<Problem>), ProjectError> {
        let cancelled = AtomicBool::new(false);
        self.load(project, access, &mut LoadControl { cancelled: &cancelled, progress: &mut |_, _| {} })
    }

    /// Loads the scene of a project.
    ///
    /// Each part may fail on its own. The previous part is then kept, or a fallback is used (the dancer, the body's own clip, the
    /// grown hairstyle, the sky above the ground), and a problem says so.
    ///
    /// # Errors
    /// If the load is cancelled, or not even the dancer can be loaded.
    pub fn load(
        &mut self,
        project: &Project,
        access: &Access,
        control: &mut LoadControl<'_>,
    ) -> Result<(Arc<Scene>, Vec<Problem>), ProjectError> {
        let (project, mut problems) = project.sanitised();
        control.at("loading the body", 0.0)?;
        let body = self.body(&project, access, &mut problems, control)?;
        control.at("loading the motion", 0.3)?;
        let motion = self.motion(&project, access, &body, &mut problems, control)?;
        control.at("creating the hair", 0.5)?;
        let scalp = self.scalp(&body, &project.body.scalp);
        let hair_done = if project.hair.morph.to.is_some() { 0.68 } else { 0.85 };
        let hair = self.hair.load(&project.hair, access, &scalp, &mut problems, control, [0.5, hair_done])?;
        let obstacle: Arc<dyn Obstacle + Send> = scalp.obstacle.clone();
        let morph = if let Some(to) = &project.hair.morph.to {
            let part = [hair_done, 0.85];
            let to = self.other_hair.load(&to.hair, access, &scalp, &mut problems, control, part)?.style;
            Some(MorphSource { to, amount: project.hair.morph.amount })
        } else {
            self.other_hair = HairSlot::default();
            None
        };
        let styled = self.morph.of(&hair.style, morph.as_ref(), None, &*obstacle);
        let stack = project.hair.stack.clone();
        let source = StyleSource { base: hair.base, stack, obstacle, scale: scalp.scale, morph };
        control.at("loading the surroundings", 0.85)?;
        let surroundings = self.surroundings.load(&project, access, &mut problems);
        control.at("computing the path of the head", 0.9)?;
        let looping = project.motion.looping;
        let head_path = self.head_path(&body, &motion, looping);
        control.at("done", 1.0)?;

        let of_parts = [&body.notes, &scalp.notes, &motion.notes, &hair.notes].into_iter().flatten().cloned();
        let of_body = face_notes(&scalp.body, &project.body.face).into_iter().chain(mask_notes(&scalp.body));
        let notes: Vec<Problem> = of_parts.chain(of_body).chain(self.surroundings.notes()).collect();
        let [colliders, sheltering] = self.colliders(&body, &project.body.colliders);
        let scene = Scene {
            body: Arc::clone(&scalp.body),
            clips: Arc::clone(&body.clips),
            clip: motion.clip.clone(),
            face: Arc::new(Face::new(&scalp.body, &project.body.face)),
            speed: f64::from(project.motion.speed),
            looping,
            loop_blend: project.motion.loop_blend,
            colliders,
            sheltering,
            fitted: Arc::clone(&body.colliders),
            field: body.field.clone().filter(|_| project.body.colliders.field.enabled),
            field_lift_m: project.body.colliders.field.lift_m(),
            style: self.enlarged.of(&styled, scalp.scale),
            skin_hair: self.skin_hair.of(&scalp.body, project.body.brows.grooms(), scalp.scale),
            source: Arc::new(source),
            hair_scale: scalp.scale,
            usual_scalp: Arc::clone(&scalp.scalp),
            skull: scalp.skull,
            head_path,
            surroundings,
            notes: notes.into(),
        };
        Ok((Arc::new(scene), problems))
    }

    fn body(
        &mut self,
        project: &Project,
        access: &Access,
        problems: &mut Vec<Problem>,
        control: &mut LoadControl<'_>,
    ) -> Result<Arc<BodyPart>, ProjectError> {
        let wanted = BodyKey::of(&project.body, access);
        if let (Ok(key), Some(kept)) = (&wanted, &self.body)
            && kept.key == *key
        {
            return Ok(Arc::clone(&kept.part));
        }
        let loaded = match wanted {
            Ok(key) => key.load_in_steps(control)?.map(|part| (key, part)),
            Err(problem) => Err(problem),
        };
        let (key, part) = match (loaded, &self.body) {
            (Ok(loaded), _) => loaded,
            (Err(problem), Some(kept)) => {
                problems.push(problem.with_fallback("the previous body is kept"));
                return Ok(Arc::clone(&kept.part));
            }
            (Err(problem), None) => {
                problems.push(problem.with_fallback("the shipped dancer is shown instead"));
                let key = BodyKey::dancer();
                let part = key.load().map_err(ProjectError::work)?;
                (key, part)
            }
        };
        let part = Arc::new(part);
        self.body = Some(Kept { key, body: None, part: Arc::clone(&part) });
        Ok(part)
    }

    fn motion(
        &mut self,
        project: &Project,
        access: &Access,
        body: &Arc<BodyPart>,
        problems: &mut Vec<Problem>,
        control: &mut LoadControl<'_>,
    ) -> Result<Arc<MotionPart>, ProjectError> {
        // A clip belongs to the joints of one body, so a clip of another body cannot be reused.
        let kept = self.motion.take_if(|kept| kept.body.as_ref().is_some_and(|of| Arc::ptr_eq(of, body)));
        let wanted = MotionKey::of(&project.motion, access);
        if let (Ok(key), Some(kept)) = (&wanted, &kept)
            && kept.key == *key
        {
            let part = Arc::clone(&kept.part);
            self.motion =
                Some(Kept { key: key.clone(), body: Some(Arc::clone(body)), part: Arc::clone(&part) });
            return Ok(part);
        }
        let loaded = match wanted {
            Ok(key) => match key.load(body, control) {
                Ok(loaded) => loaded.map(|part| (key, Arc::new(part))),
                Err(error) => {
                    self.motion = kept;
                    return Err(error);
                }
            },
            Err(problem) => Err(problem),
        };
        let (key, part) = match (loaded, kept) {
            (Ok(loaded), _) => loaded,
            (Err(problem), Some(kept)) => {
                problems.push(problem.with_fallback("the previous motion is kept"));
                (kept.key, kept.part)
            }
            (Err(problem), None) => {
                problems.push(problem.with_fallback("the body's first clip is played instead"));
                let key = MotionKey::first_clip();
                let part = key.load(body, control)?.map_err(ProjectError::work)?;
                (key, Arc::new(part))
            }
        };
        self.motion = Some(Kept { key, body: Some(Arc::clone(body)), part: Arc::clone(&part) });
        Ok(part)
    }

    /// The scalp of a body. Changes of the fit keep the body.
    fn scalp(&mut self, body: &Arc<BodyPart>, fit: &ScalpFit) -> Arc<ScalpPart> {
        if let Some(kept) = &self.scalp
            && kept.key == *fit
            && kept.body.as_ref().is_some_and(|of| Arc::ptr_eq(of, body))
        {
            return Arc::clone(&kept.part);
        }
        let part = Arc::new(ScalpPart::new(body, fit));
        self.scalp = Some(Kept { key: fit.clone(), body: Some(Arc::clone(body)), part: Arc::clone(&part) });
        part
    }

    /// The shapes that hair collides with, as edited by the project, and those that only block the wind.
    fn colliders(&mut self, body: &Arc<BodyPart>, edits: &ColliderEdits) -> ColliderLists {
        if let Some((of, kept, met)) = &self.colliders
            && Arc::ptr_eq(of, body)
            && kept == edits
        {
            return met.clone();
        }
        let field = body.field.as_deref();
        let met = [
            edits.apply(&body.colliders, field).into(),
            edits.replaced_by_field(&body.colliders, field).into(),
        ];
        self.colliders = Some((Arc::clone(body), edits.clone(), met.clone()));
        met
    }

    fn head_path(&mut self, body: &BodyPart, motion: &Arc<MotionPart>, looping: bool) -> Arc<HeadPath> {
        if let Some((of, was_looping, path)) = &self.head_path
            && Arc::ptr_eq(of, motion)
            && *was_looping == looping
        {
            return Arc::clone(path);
        }
        let path = Arc::new(HeadPath::new(&body.body, motion.clip.as_deref(), looping));
        self.head_path = Some((Arc::clone(motion), looping, Arc::clone(&path)));
        path
    }
}
