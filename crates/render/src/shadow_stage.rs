//! The shadow methods of one frame: one map a light, asked once a strand point and once a vertex of the body.

use glam::{Mat4, Vec3};
use lovelock_groom::Strands;
use lovelock_shadow::{ColumnMap, CpuShadow, LightFrame, ShadowError, ShadowInput, ShadowMethod, cpu_shadow};

use crate::{FrameInput, Light, MAX_LIGHTS};

/// The shadow of every light, kept from frame to frame.
#[derive(Default)]
pub(crate) struct ShadowStage {
    method: Option<ShadowMethod>,
    lights: Vec<LightShadow>,
    /// Four 8-bit transmittances a strand point, the first light in the lowest byte.
    pub at_points: Vec<u32>,
    /// The same for each vertex of the body.
    pub at_vertices: Vec<u32>,
    /// What all hair lets through, a light; for the ground.
    pub columns: Vec<Option<ColumnMap>>,
    /// Mean transmittance of the first light over the strands' points.
    pub mean: f32,
    /// Bytes of all maps.
    pub bytes: u64,
    vertices: [Vec<f32>; 3],
}

struct LightShadow {
    frame: LightFrame,
    shadow: Box<dyn CpuShadow + Send + Sync>,
    values: Vec<f32>,
}

impl std::fmt::Debug for ShadowStage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ShadowStage")
            .field("method", &self.method)
            .field("lights", &self.lights.len())
            .finish_non_exhaustive()
    }
}

impl ShadowStage {
    /// Builds the maps and looks them up everywhere that they are needed.
    ///
    /// # Errors
    /// The map would need more memory than its limit.
    pub fn run(&mut self, input: &FrameInput) -> Result<(), ShadowError> {
        let lights: Vec<Light> =
            input.lights.iter().filter(|light| light.enabled).take(MAX_LIGHTS).map(Light::clamped).collect();
        if self.method != Some(input.shadow.method) {
            self.lights.clear();
            self.method = Some(input.shadow.method);
        }
        self.lights.truncate(lights.len());
        let empty: &[Vec3] = &[];
        let positions = input.body.map_or(empty, |(_, skin)| &skin.positions[..]);
        for (axis, values) in self.vertices.iter_mut().enumerate() {
            values.clear();
            values.extend(positions.iter().map(|p| p[axis]));
        }
        self.at_points.clear();
        self.at_points.resize(input.strands.points(), u32::MAX);
        self.at_vertices.clear();
        self.at_vertices.resize(positions.len(), u32::MAX);
        self.columns.clear();
        self.bytes = 0;
        self.mean = 1.0;
        for (k, light) in lights.iter().enumerate() {
            if k == self.lights.len() {
                self.lights.push(LightShadow {
                    frame: LightFrame::new(light.direction),
                    shadow: cpu_shadow(input.shadow.method),
                    values: Vec::new(),
                });
            }
            let this = &mut self.lights[k];
            // Carried along rather than made anew, so that the map does not roll while the light is dragged.
            this.frame = this.frame.transported(light.direction);
            let strand_width = input.look.shadow_width(input.style.strands.count());
            this.shadow.build(
                &ShadowInput {
                    strands: input.strands,
                    strand_width,
                    light: this.frame,
                    anchor: input.world_from_head.translation.into(),
                },
                input.shadow,
            )?;
            let Strands { x, y, z, .. } = input.strands;
            this.values.resize(x.len(), 1.0);
            this.shadow.transmittance_at(x, y, z, &mut this.values);
            if k == 0 && !this.values.is_empty() {
                let sum: f64 = this.values.iter().map(|&t| f64::from(t)).sum();
                self.mean = (sum / this.values.len() as f64) as f32;
            }
            pack(&this.values, k, &mut self.at_points);
            let [vx, vy, vz] = &self.vertices;
            this.values.resize(vx.len(), 1.0);
            this.shadow.transmittance_at(vx, vy, vz, &mut this.values);
            pack(&this.values, k, &mut self.at_vertices);
            self.columns.push(this.shadow.column_map());
            self.bytes += this.shadow.report().memory_bytes;
        }
        Ok(())
    }

    /// Carries world space to the texture of light `k`'s column map; far outside where it has none.
    pub fn columns_from_world(&self, k: usize) -> Mat4 {
        const OUTSIDE: Mat4 = Mat4::from_cols_array(&[
            0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 1.0,
        ]);
        self.columns.get(k).and_then(Option::as_ref).map_or(OUTSIDE, |map| map.uv_from_world)
    }
}

/// Writes byte `k` of each packed value.
fn pack(values: &[f32], k: usize, packed: &mut [u32]) {
    let shift = 8 * k as u32;
    for (word, &value) in packed.iter_mut().zip(values) {
        let byte = (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
        *word = (*word & !(0xff << shift)) | (byte << shift);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_writes_one_byte_and_keeps_the_others() {
        let mut packed = [u32::MAX; 3];
        pack(&[0.0, 0.5, f32::NAN], 1, &mut packed);
        assert_eq!(packed, [0xffff_00ff, 0xffff_80ff, 0xffff_00ff]);
    }
}
