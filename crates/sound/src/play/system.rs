//! The device on Windows and macOS.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use cpal::ErrorKind;
use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};

use super::SharedHeard;
use super::mixer::Mixer;

/// How often is looked whether the device was lost.
const ASKED: Duration = Duration::from_millis(200);
/// How often a lost device is looked for.
const REOPENED: Duration = Duration::from_secs(2);

/// The thread that holds the device, which may not change threads. Dropping it ends the thread.
pub(super) struct Output {
    _until_dropped: Option<SyncSender<()>>,
}

impl Output {
    pub(super) fn open(mixer: &Arc<Mixer>, heard: &SharedHeard) -> Self {
        let (sender, ended) = sync_channel::<()>(1);
        let (mixer, on_thread) = (Arc::clone(mixer), heard.clone());
        let thread = std::thread::Builder::new().name("lovelock sound".to_owned()).spawn(move || {
            on_thread.keep_open(&ended, REOPENED, || Some(silent(&play(&mixer, &on_thread, &ended)?)));
        });
        if let Err(error) = &thread {
            heard.fail(format!("The sound is silent: its thread could not start ({error})."));
        }
        Self { _until_dropped: thread.is_ok().then_some(sender) }
    }
}

/// Plays until the device is lost, and returns why; `None` when the player is dropped.
fn play(mixer: &Arc<Mixer>, heard: &SharedHeard, ended: &Receiver<()>) -> Option<String> {
    let lost = Arc::new(Mutex::new(None));
    // The stream plays until it is dropped.
    let _stream = match connect(mixer, heard, &lost) {
        Ok(stream) => stream,
        Err(error) => return Some(error),
    };
    while ended.recv_timeout(ASKED) == Err(RecvTimeoutError::Timeout) {
        let error = lost.lock().unwrap_or_else(PoisonError::into_inner).take();
        if error.is_some() {
            return error;
        }
    }
    None
}

fn silent(error: &impl std::fmt::Display) -> String {
    format!("The sound is silent: this computer's sound device cannot be used ({error}).")
}

fn connect(
    mixer: &Arc<Mixer>,
    heard: &SharedHeard,
    lost: &Arc<Mutex<Option<String>>>,
) -> Result<cpal::Stream, String> {
    let device = cpal::default_host().default_output_device().ok_or("there is none")?;
    let config = device.default_output_config().map_err(|error| error.to_string())?.config();
    mixer.set_out_rate(config.sample_rate);
    let channels = usize::from(config.channels).max(1);
    let (mixer, lost, heard) = (Arc::clone(mixer), Arc::clone(lost), heard.clone());
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
    let failed = move |error: cpal::Error| {
        // A gap, a thread of ordinary priority, or another way to the same device: the stream goes on.
        if matches!(error.kind(), ErrorKind::Xrun | ErrorKind::RealtimeDenied | ErrorKind::DeviceChanged) {
            return;
        }
        *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
    };
    let stream = device.build_output_stream(config, fill, failed, None).map_err(|error| error.to_string())?;
    stream.play().map_err(|error| error.to_string())?;
    Ok(stream)
}
