//! The device on Linux: the sound server, `PulseAudio` or `PipeWire`, by its own protocol over a socket. No library of the system is needed, so
//! the program also builds and starts on computers without any sound.

use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;

use pulseaudio::protocol::stream::{BufferAttr, StreamFlags};
use pulseaudio::protocol::{self, ChannelMap, ChannelVolume, PlaybackStreamParams, SampleFormat, SampleSpec};
use pulseaudio::{AsPlaybackSource, Client, PlaybackStream};

use super::SharedHeard;
use super::mixer::Mixer;
use crate::sound::RATE;

/// Time from a sample to its sound that is asked for, milliseconds. A pause is heard that much later.
const LATENCY_MS: u32 = 60;
/// Bytes of a frame: two floats.
const FRAME: u32 = 8;
/// How often the server is asked what is heard.
const ASKED: Duration = Duration::from_millis(200);
/// How often a lost server is looked for.
const REOPENED: Duration = Duration::from_secs(2);

/// The longest time that a server may take to greet.
const GREETING: Duration = Duration::from_secs(5);

/// The thread that plays. Dropping it ends the thread.
pub(super) struct Output {
    _until_dropped: Option<SyncSender<()>>,
}

impl Output {
    pub(super) fn open(mixer: &Arc<Mixer>, heard: &SharedHeard) -> Self {
        Self::at(pulseaudio::socket_path_from_env, REOPENED, mixer, heard)
    }

    /// Plays through the server of a socket. A server that is lost is looked for again every `reopened` while something plays.
    fn at(
        socket: impl Fn() -> Option<PathBuf> + Send + 'static,
        reopened: Duration,
        mixer: &Arc<Mixer>,
        heard: &SharedHeard,
    ) -> Self {
        let (sender, ended) = sync_channel(1);
        let (mixer, on_thread) = (Arc::clone(mixer), heard.clone());
        let thread = std::thread::Builder::new().name("lovelock sound".to_owned()).spawn(move || {
            on_thread.keep_open(&ended, reopened, || {
                let error = play(socket().as_deref(), &mixer, &on_thread, &ended)?;
                Some(format!("The sound is silent: this computer's sound server does not answer ({error})."))
            });
        });
        if let Err(error) = &thread {
            heard.fail(format!("The sound is silent: its thread could not start ({error})."));
        }
        Self { _until_dropped: thread.is_ok().then_some(sender) }
    }
}

/// Plays until the server is lost, and returns why; `None` when the player is dropped.
fn play(
    socket: Option<&Path>,
    mixer: &Arc<Mixer>,
    heard: &SharedHeard,
    ended: &Receiver<()>,
) -> Option<String> {
    // The frames of a stream are counted from its own first one.
    let first = mixer.written() as f64;
    // The client lives as long as its stream.
    let (_client, stream) = match connect(socket, mixer) {
        Ok(connected) => connected,
        Err(error) => return Some(error),
    };
    loop {
        match pollster::block_on(stream.timing_info()) {
            Ok(timing) => {
                let latency_secs = timing.sink_usec as f64 * 1e-6;
                let frame = timing.read_offset as f64 / f64::from(FRAME) - latency_secs * f64::from(RATE);
                heard.report(first + frame);
            }
            Err(error) => return Some(error.to_string()),
        }
        if ended.recv_timeout(ASKED) != Err(RecvTimeoutError::Timeout) {
            return None;
        }
    }
}

fn connect(socket: Option<&Path>, mixer: &Arc<Mixer>) -> Result<(Client, PlaybackStream), String> {
    let socket = UnixStream::connect(socket.ok_or("there is none")?).map_err(|error| error.to_string())?;
    socket.set_read_timeout(Some(GREETING)).map_err(|error| error.to_string())?;
    let cookie = pulseaudio::cookie_path_from_env().and_then(|path| std::fs::read(path).ok());
    let client = Client::new_unix(c"Lovelock", socket, cookie).map_err(|error| error.to_string())?;
    let target_length = RATE / 1000 * LATENCY_MS * FRAME;
    let parameters = PlaybackStreamParams {
        sample_spec: SampleSpec { format: SampleFormat::Float32Le, channels: 2, sample_rate: RATE },
        channel_map: ChannelMap::stereo(),
        sink_name: Some(protocol::DEFAULT_SINK.to_owned()),
        buffer_attr: BufferAttr { target_length, ..BufferAttr::default() },
        cvolume: Some(ChannelVolume::norm(2)),
        flags: StreamFlags { adjust_latency: true, ..StreamFlags::default() },
        ..PlaybackStreamParams::default()
    };
    let mixer = Arc::clone(mixer);
    let mut samples = Vec::new();
    let source = move |bytes: &mut [u8]| {
        samples.resize(bytes.len() / FRAME as usize * 2, 0.0_f32);
        mixer.fill(&mut samples);
        for (bytes, sample) in bytes.chunks_exact_mut(4).zip(&samples) {
            bytes.copy_from_slice(&sample.to_le_bytes());
        }
        samples.len() * 4
    };
    let stream = pollster::block_on(client.create_playback_stream(parameters, source.as_playback_source()));
    stream.map(|stream| (client, stream)).map_err(|error| error.to_string())
}

#[cfg(test)]
#[path = "pulse_tests.rs"]
mod tests;
