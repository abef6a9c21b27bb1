//! Transmittance of the last picture.

use glam::Vec3;
use lovelock_gpu::{GpuError, PassTimer, read_buffer, wgpu};
use lovelock_shadow::GpuTargets;

use super::GpuRenderer;
use crate::RenderError;

impl GpuRenderer {
    /// See [`Renderer::transmittance`](crate::Renderer::transmittance).
    ///
    /// # Errors
    /// As there.
    pub fn transmittance(&mut self, light: usize) -> Result<Vec<f32>, RenderError> {
        self.check_light(light)?;
        let mut words = vec![0; self.hair.drawn().point_count as usize];
        read_buffer(&self.gpu, self.hair.transmittance(), &mut words)?;
        Ok(unpack(&words, light))
    }

    /// See [`Renderer::transmittance_at`](crate::Renderer::transmittance_at).
    ///
    /// # Errors
    /// As there.
    pub fn transmittance_at(&mut self, light: usize, points: &[Vec3]) -> Result<Vec<f32>, RenderError> {
        self.check_light(light)?;
        if points.is_empty() {
            return Ok(Vec::new());
        }
        let gpu = &self.gpu;
        let bytes = points.len() as u64 * 16;
        if bytes > gpu.most_storage_bytes() || u32::try_from(points.len()).is_err() {
            let most = gpu.most_storage_bytes() / 16;
            let reason =
                format!("{} takes at most {most} points at once, not {}", gpu.info.name, points.len());
            return Err(GpuError::Input(reason).into());
        }
        let buffer = |label, size, more| {
            let usage = wgpu::BufferUsages::STORAGE | more;
            let descriptor =
                wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
            gpu.create_buffer(&descriptor)
        };
        let places: Vec<[f32; 4]> = points.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect();
        let asked = buffer("points", bytes, wgpu::BufferUsages::COPY_DST);
        gpu.upload(&asked, 0, &places);
        let out = buffer("answers", (points.len() as u64 * 4).max(16), wgpu::BufferUsages::COPY_SRC);
        let mut timer = PassTimer::default();
        let mut commands = timer.begin(gpu, "ask");
        let targets = GpuTargets {
            points: &asked,
            stride: 1,
            count: points.len() as u32,
            out: &out,
            sum: None,
            byte: None,
            projected: None,
        };
        self.shadow.look_up(light, gpu, &mut commands, &targets);
        commands.submit();
        let mut words = vec![0; points.len()];
        read_buffer(gpu, &out, &mut words)?;
        gpu.check()?;
        let answers = unpack(&words, light).into_iter().zip(points);
        Ok(answers.map(|(t, p)| if p.is_finite() { t } else { 1.0 }).collect())
    }

    fn check_light(&self, light: usize) -> Result<(), RenderError> {
        let lights = self.shadow.lights();
        if !self.is_whole {
            return Err(RenderError::NoPicture);
        }
        if light < lights { Ok(()) } else { Err(RenderError::NoLight { light, lights }) }
    }
}

/// Unpacks the transmittances of one light.
fn unpack(words: &[u32], light: usize) -> Vec<f32> {
    words.iter().map(|word| (word >> (8 * light) & 0xff) as f32 / 255.0).collect()
}
