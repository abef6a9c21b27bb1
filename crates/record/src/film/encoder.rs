//! The H.264 encoder, with settings for films rather than for video calls.

use super::FilmSettings;
use crate::FrameRate;
use crate::dither::Dither;
use crate::mp4::{AvcConfig, append_sample};
use crate::yuv::Planes;
use openh264::OpenH264API;
use openh264::encoder::{
    BitRate, Complexity, Encoder, EncoderConfig, FrameRate as Hertz, IntraFramePeriod, QpRange,
    RateControlMode, TransferCharacteristics, VuiConfig,
};

/// Seconds between key frames. A player decodes at most this much to show any one frame.
const KEY_FRAME_SECS: f64 = 1.0;

/// Encodes images as samples of an MP4 file.
pub(super) struct FrameEncoder {
    encoder: Encoder,
    planes: Planes,
    stream: Vec<u8>,
    sample: Vec<u8>,
    config: AvcConfig,
}

impl FrameEncoder {
    pub(super) fn new(
        settings: FilmSettings,
        rate: FrameRate,
        dither: Dither,
    ) -> Result<Self, openh264::Error> {
        let FilmSettings { width, height, quality, .. } = settings;
        let fps = rate.as_f64();
        let quantiser = quality.quantiser();
        let pixels_per_second = f64::from(width * height) * fps;
        let config = EncoderConfig::new()
            // This mode changes the quantiser within its range and never skips a frame. With a range of one value all frames
            // have the same quality. The bit rate then decides only the level that the stream declares, so it is about what
            // moving hair needs (measured: 0.48 bits per pixel at quantiser 20, doubling every six).
            .rate_control_mode(RateControlMode::Bufferbased)
            .qp(QpRange::new(quantiser, quantiser))
            .bitrate(BitRate::from_bps(
                (pixels_per_second * 0.48 * f64::exp2((20.0 - f64::from(quantiser)) / 6.0)).min(200e6) as u32,
            ))
            .max_frame_rate(Hertz::from_hz(fps as f32))
            .intra_frame_period(IntraFramePeriod::from_num_frames((fps * KEY_FRAME_SECS).round() as u32))
            .complexity(Complexity::Medium)
            .skip_frames(false)
            // These save bits by coarser frames at cuts and leave ghosts of thin hair in areas with little motion.
            .scene_change_detect(false)
            .background_detection(false)
            .adaptive_quantization(false)
            // One thread, so that the same images give the same bytes on every machine.
            .num_threads(1)
            .vui(VuiConfig::bt709().transfer_characteristics(TransferCharacteristics::Srgb));
        Ok(Self {
            encoder: Encoder::with_api_config(OpenH264API::from_source(), config)?,
            planes: Planes::new(width as usize, height as usize, dither),
            stream: Vec::new(),
            sample: Vec::new(),
            config: AvcConfig::default(),
        })
    }

    /// Encodes one image. Returns the sample and whether it is a key frame.
    pub(super) fn encode(&mut self, rgba: &[u8]) -> Result<(&[u8], bool), openh264::Error> {
        self.planes.read_rgba(rgba);
        self.stream.clear();
        self.encoder.encode(&self.planes)?.write_vec(&mut self.stream);
        self.sample.clear();
        let key = append_sample(&self.stream, &mut self.sample, &mut self.config);
        Ok((&self.sample, key))
    }

    /// The parameter sets; available after the first frame.
    pub(super) fn config(&self) -> &AvcConfig {
        &self.config
    }
}
