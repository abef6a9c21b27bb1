//! The device on Linux: the sound server, `PulseAudio` or `PipeWire`, by its own protocol over a socket. No library of the system is needed, so
//! the program also builds and starts on computers without any sound.

use std::fmt::Display;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::pin::pin;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, sync_channel};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
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

/// The longest time that a server may take to greet, and to answer anything else. A server that is stopped keeps its socket open.
const ANSWERED: Duration = Duration::from_secs(5);

/// The times of a connection.
#[derive(Clone, Copy)]
struct Patience {
    /// How often a lost server is looked for.
    reopened: Duration,
    /// The longest time that it may take to answer.
    answered: Duration,
}

/// The thread that plays. Dropping it ends the thread.
pub(super) struct Output {
    _until_dropped: Option<SyncSender<()>>,
}

impl Output {
    pub(super) fn open(mixer: &Arc<Mixer>, heard: &SharedHeard) -> Self {
        let patience = Patience { reopened: REOPENED, answered: ANSWERED };
        Self::at(pulseaudio::socket_path_from_env, patience, mixer, heard)
    }

    /// Plays through the server of a socket. A server that is lost is looked for again while something plays.
    fn at(
        socket: impl Fn() -> Option<PathBuf> + Send + 'static,
        patience: Patience,
        mixer: &Arc<Mixer>,
        heard: &SharedHeard,
    ) -> Self {
        let (sender, ended) = sync_channel(1);
        let (mixer, on_thread) = (Arc::clone(mixer), heard.clone());
        let thread = std::thread::Builder::new().name("lovelock sound".to_owned()).spawn(move || {
            on_thread.keep_open(&ended, patience.reopened, || {
                let error = play(socket().as_deref(), patience.answered, &mixer, &on_thread, &ended)?;
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
    answered: Duration,
    mixer: &Arc<Mixer>,
    heard: &SharedHeard,
    ended: &Receiver<()>,
) -> Option<String> {
    // The frames of a stream are counted from its own first one.
    let first = mixer.written() as f64;
    // The client exists as long as its stream, and its thread ends when the socket is shut down, after both.
    let (_until_dropped, _client, stream) = match connect(socket, answered, mixer, ended) {
        Ok(connected) => connected,
        Err(error) => return Some(error),
    };
    loop {
        match within(answered, ended, stream.timing_info()) {
            Ok(timing) => {
                let latency_secs = timing.sink_usec as f64 * 1e-6;
                let frame = timing.read_offset as f64 / f64::from(FRAME) - latency_secs * f64::from(RATE);
                heard.report(first + frame);
            }
            Err(error) => return Some(error),
        }
        if ended.recv_timeout(ASKED) != Err(RecvTimeoutError::Timeout) {
            return None;
        }
    }
}

/// Shuts down a socket when it is dropped. The thread of its client waits for the server, also for one that never says anything again.
struct ShutDown(UnixStream);

impl Drop for ShutDown {
    fn drop(&mut self) {
        // The server may have closed it already.
        let _ = self.0.shutdown(Shutdown::Both);
    }
}

/// Wakes a thread that waits in [`within`].
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Waits for the answer of a server: at most for a time, and only until the player is dropped.
fn within<T, E: Display>(
    answered: Duration,
    ended: &Receiver<()>,
    answer: impl Future<Output = Result<T, E>>,
) -> Result<T, String> {
    let mut answer = pin!(answer);
    let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
    let mut context = Context::from_waker(&waker);
    let since = Stopwatch::start();
    loop {
        if let Poll::Ready(answer) = answer.as_mut().poll(&mut context) {
            return answer.map_err(|error| error.to_string());
        }
        if since.elapsed() >= answered {
            return Err(format!("no answer within {} s", answered.as_secs_f64()));
        }
        if ended.try_recv() != Err(TryRecvError::Empty) {
            // Nobody sees it.
            return Err("the player was closed".to_owned());
        }
        std::thread::park_timeout(ASKED.min(answered));
    }
}

fn connect(
    socket: Option<&Path>,
    answered: Duration,
    mixer: &Arc<Mixer>,
    ended: &Receiver<()>,
) -> Result<(ShutDown, Client, PlaybackStream), String> {
    let socket = UnixStream::connect(socket.ok_or("there is none")?).map_err(|error| error.to_string())?;
    socket.set_read_timeout(Some(answered)).map_err(|error| error.to_string())?;
    let until_dropped = ShutDown(socket.try_clone().map_err(|error| error.to_string())?);
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
    let opening = client.create_playback_stream(parameters, source.as_playback_source());
    let stream = within(answered, ended, opening)?;
    Ok((until_dropped, client, stream))
}

#[cfg(test)]
#[path = "pulse_tests.rs"]
mod tests;
