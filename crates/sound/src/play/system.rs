//! The device on Windows and macOS.

use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};

use super::SharedHeard;
use super::mixer::Mixer;

/// The thread that holds the device, which may not change threads. Dropping it ends the thread.
pub(super) struct Output {
    _until_dropped: Option<SyncSender<()>>,
}

impl Output {
    pub(super) fn open(mixer: &Arc<Mixer>, heard: &SharedHeard) -> Self {
        let (sender, ended) = sync_channel::<()>(1);
        let (mixer, on_thread) = (Arc::clone(mixer), heard.clone());
        let thread = std::thread::Builder::new().name("lovelock sound".to_owned()).spawn(move || {
            match connect(&mixer, &on_thread) {
                // The stream plays until it is dropped.
                Ok(_stream) => drop(ended.recv()),
                Err(error) => on_thread.fail(silent(&error)),
            }
        });
        if let Err(error) = &thread {
            heard.fail(format!("The sound is silent: its thread could not start ({error})."));
        }
        Self { _until_dropped: thread.is_ok().then_some(sender) }
    }
}

fn silent(error: &impl std::fmt::Display) -> String {
    format!("The sound is silent: this computer's sound device cannot be used ({error}).")
}

fn connect(mixer: &Arc<Mixer>, heard: &SharedHeard) -> Result<cpal::Stream, String> {
    let device = cpal::default_host().default_output_device().ok_or("there is none")?;
    let config = device.default_output_config().map_err(|error| error.to_string())?.config();
    mixer.set_out_rate(config.sample_rate);
    let channels = usize::from(config.channels).max(1);
    let (mixer, on_error, heard) = (Arc::clone(mixer), heard.clone(), heard.clone());
    let mut samples = Vec::new();
    let fill = move |out: &mut [f32], info: &cpal::OutputCallbackInfo| {
        let time = info.timestamp();
        let latency = time.playback.duration_since(time.callback).as_secs_f64();
        heard.report(mixer.written() as f64 - latency * mixer.out_rate());
        samples.resize(out.len() / channels * 2, 0.0_f32);
        mixer.fill(&mut samples);
        for (out, stereo) in out.chunks_exact_mut(channels).zip(samples.chunks_exact(2)) {
            match out {
                [mono] => *mono = 0.5 * (stereo[0] + stereo[1]),
                [left, right, rest @ ..] => {
                    (*left, *right) = (stereo[0], stereo[1]);
                    rest.fill(0.0);
                }
                [] => {}
            }
        }
    };
    let failed = move |error: cpal::Error| on_error.fail(silent(&error));
    let stream = device.build_output_stream(config, fill, failed, None).map_err(|error| error.to_string())?;
    stream.play().map_err(|error| error.to_string())?;
    Ok(stream)
}
