//! The maps of area lights on the GPU: those of each light's samples, and the mean of what is looked up in them.

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Commands, Gpu, GpuError, Kernel, ShaderPart, ShaderSource, wgpu};

use super::LightArea;
use crate::gpu::{Buffer, wgsl};
use crate::{
    GpuColumns, GpuList, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, LightFrame, ShadowMethod,
    ShadowReport, ShadowSettings, SharedList,
};

const AVERAGE: ShaderPart = wgsl!("area/", "average.wgsl");
/// The name of the pass in statistics.
const AVERAGE_PASS: &str = "shadow/average";

/// Twin of `Average` in average.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct AverageUniform {
    count: u32,
    slot: u32,
    samples: u32,
    sample: u32,
    sums: u32,
}

fn source() -> ShaderSource {
    ShaderSource::new(&[AVERAGE])
}

/// The shaders that no method has, with their labels.
pub(crate) fn average_shaders() -> Vec<(String, ShaderSource)> {
    vec![(AVERAGE_PASS.to_owned(), source())]
}

/// Makes the maps of a method for lights without an area.
type Make = fn(ShadowMethod, &Gpu) -> Result<Box<dyn GpuShadow>, GpuError>;

/// A method on the GPU, for lights with hard and with soft shadows.
#[derive(Debug)]
pub(crate) struct GpuSoftMaps {
    method: ShadowMethod,
    make: Make,
    /// The maps of lights with hard shadows.
    hard: Box<dyn GpuShadow>,
    /// Whether there are any.
    has_hard: bool,
    /// Those of each light with soft shadows.
    soft: Vec<Option<Box<Soft>>>,
    average: Option<Average>,
}

/// The maps of the samples of a light, in slots that count from 0.
#[derive(Debug)]
struct Soft {
    maps: Box<dyn GpuShadow>,
    samples: u32,
}

/// The mean of transmittances.
#[derive(Debug)]
struct Average {
    kernel: Kernel,
    /// Transmittance in one sample, and the total of all, per point.
    found: Buffer,
    totals: Buffer,
    /// Bound where no sum is wanted.
    no_sum: Buffer,
}

impl Average {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let mut no_sum = Buffer::new(gpu, "no sum");
        no_sum.fit(gpu, 4);
        Ok(Self {
            kernel: Kernel::new(gpu, AVERAGE_PASS, &source(), "add_sample")?,
            found: Buffer::new(gpu, "transmittance of a sample"),
            totals: Buffer::new(gpu, "transmittance of samples"),
            no_sum,
        })
    }

    /// Encodes looking up the targets in all samples of a light, whose slot in pictures is `slot`.
    fn look_up(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        (slot, soft): (usize, &mut Soft),
        targets: &GpuTargets,
    ) {
        let words = u64::from(targets.count).max(1);
        // They do not shrink, because points and vertices are looked up in turn.
        let words = words.max(self.found.bytes() / 4);
        self.found.fit(gpu, words);
        self.totals.fit(gpu, words);
        let slot = targets.byte.unwrap_or(slot as u32);
        let sum = targets.sum.filter(|_| slot == 0);
        for sample in 0..soft.samples {
            let one = GpuTargets { out: self.found.raw(), sum: None, byte: Some(0), ..*targets };
            soft.maps.look_up(sample as usize, gpu, commands, &one);
            let uniform = AverageUniform {
                count: targets.count,
                slot,
                samples: soft.samples,
                sample,
                sums: u32::from(sum.is_some()),
            };
            let uniform = commands.constants("average", &uniform);
            let resources = [
                (0, uniform.as_entire_binding()),
                (1, self.found.raw().as_entire_binding()),
                (2, self.totals.raw().as_entire_binding()),
                (3, targets.out.as_entire_binding()),
                (4, sum.unwrap_or(self.no_sum.raw()).as_entire_binding()),
            ];
            let group = self.kernel.bind(gpu, &resources);
            commands.compute(AVERAGE_PASS, |pass| self.kernel.run(pass, &group, u64::from(targets.count)));
        }
    }
}

impl GpuSoftMaps {
    /// Compiles the kernels of a method; its maps are empty.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: &Gpu, method: ShadowMethod, make: Make) -> Result<Self, GpuError> {
        Ok(Self { method, make, hard: make(method, gpu)?, has_hard: false, soft: Vec::new(), average: None })
    }

    fn soft(&self, slot: usize) -> Option<&Soft> {
        self.soft.get(slot)?.as_deref()
    }

    fn build_soft(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        (input, lights): (&GpuShadowInput, &[LightFrame]),
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        if self.average.is_none() {
            self.average = Some(Average::new(gpu)?);
        }
        let samples = lights.len() as u32;
        let kept = self.soft[slot].take();
        let mut soft = match kept {
            Some(kept) => kept,
            None => Box::new(Soft { maps: (self.make)(self.method, gpu)?, samples }),
        };
        if soft.samples != samples {
            // Frees the maps of samples that were removed.
            soft.maps.forget(gpu);
            soft.samples = samples;
        }
        for (at, (light, bounds)) in lights.iter().zip(input.sample_bounds).enumerate() {
            let from = GpuShadowInput {
                light: *light,
                bounds: *bounds,
                sample_bounds: &[],
                maps: input.maps.max(1).saturating_mul(samples),
                // There is room for the head of one list per light.
                shared_list: Some(SharedList { of: 0, maps: samples }),
                ..*input
            };
            soft.maps.build(at, gpu, commands, &from, settings)?;
        }
        self.soft[slot] = Some(soft);
        if self.has_hard && self.soft.iter().all(Option::is_some) {
            self.hard.forget(gpu);
            self.has_hard = false;
        }
        Ok(())
    }
}

impl GpuShadow for GpuSoftMaps {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let slots = (input.maps.max(1) as usize).max(slot + 1);
        self.soft.truncate(slots);
        self.soft.resize_with(slots, || None);
        let lights = input.light.samples(input.anchor);
        if lights.len() > 1 && input.sample_bounds.len() == lights.len() {
            return self.build_soft(slot, gpu, commands, (input, &lights), settings);
        }
        self.soft[slot] = None;
        self.has_hard = true;
        let light = LightFrame { area: LightArea::HARD, ..input.light };
        self.hard.build(slot, gpu, commands, &GpuShadowInput { light, ..*input }, settings)
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        let soft = self.soft.get_mut(slot).and_then(|soft| soft.as_deref_mut());
        match (soft, &mut self.average) {
            (Some(soft), Some(average)) => average.look_up(gpu, commands, (slot, soft), targets),
            _ => self.hard.look_up(slot, gpu, commands, targets),
        }
    }

    fn columns_size(&self, slot: usize) -> u32 {
        self.soft(slot).map_or_else(|| self.hard.columns_size(slot), |soft| soft.maps.columns_size(0))
    }

    fn column_sides(&self, slot: usize) -> usize {
        self.soft(slot).map_or_else(|| self.hard.column_sides(slot), |soft| soft.maps.column_sides(0))
    }

    fn columns(
        &mut self,
        (slot, side): (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        match self.soft.get_mut(slot).and_then(|soft| soft.as_deref_mut()) {
            Some(soft) => soft.maps.columns((0, side), gpu, commands, into),
            None => self.hard.columns((slot, side), gpu, commands, into),
        }
    }

    fn list(&self, slot: usize) -> Option<GpuList<'_>> {
        match self.soft(slot) {
            Some(soft) => soft.maps.list(0),
            None => self.hard.list(slot),
        }
    }

    fn settle(&mut self, gpu: &Gpu, heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        let is_soft = |slot: usize| self.soft.get(slot).is_some_and(Option::is_some);
        let of_hard: Vec<_> =
            heads.iter().enumerate().map(|(slot, head)| if is_soft(slot) { [0; 2] } else { *head }).collect();
        let mut again = self.hard.settle(gpu, &of_hard)?;
        for (soft, head) in self.soft.iter_mut().zip(heads) {
            if let Some(soft) = soft {
                again |= soft.maps.settle(gpu, std::slice::from_ref(head))?;
            }
        }
        Ok(again)
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.hard.forget(gpu);
        self.soft.clear();
        self.average = None;
    }

    fn report(&self, slot: usize) -> ShadowReport {
        let Some(soft) = self.soft(slot) else { return self.hard.report(slot) };
        let reports = (0..soft.samples as usize).map(|at| soft.maps.report(at));
        let sum = reports.fold(ShadowReport::default(), ShadowReport::joined);
        let own = self.average.as_ref().map_or(0, |average| average.found.bytes() + average.totals.bytes());
        ShadowReport { scratch_bytes: sum.scratch_bytes + own, ..sum }
    }

    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(soft) = self.soft(slot) else { return self.hard.map_words(slot, gpu) };
        let words = (0..soft.samples as usize).map(|at| soft.maps.map_words(at, gpu));
        Ok(words.collect::<Result<Vec<_>, _>>()?.concat())
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use lovelock_gpu::layout_in_shader;

    #[test]
    fn the_uniform_has_the_layout_of_the_shader() {
        let expected = [
            offset_of!(AverageUniform, count),
            offset_of!(AverageUniform, slot),
            offset_of!(AverageUniform, samples),
            offset_of!(AverageUniform, sample),
            offset_of!(AverageUniform, sums),
            size_of::<AverageUniform>(),
        ];
        assert_eq!(layout_in_shader(&source(), "Average"), expected);
    }
}
