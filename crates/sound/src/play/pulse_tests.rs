//! A server of sound that closes and comes back.

use std::io::{BufReader, Cursor, Read};
use std::os::unix::net::UnixListener;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::SystemTime;

use lovelock_testkit::wait::{HANG, wait_until};
use pulseaudio::protocol::{
    AuthReply, Command, CreatePlaybackStreamReply, MAX_VERSION, PlaybackLatency, ProtocolError,
    SetClientNameReply, read_descriptor, write_ack_message, write_reply_message,
};

use super::*;
use crate::sound::Sound;

/// Serves one client at a socket until it has been asked for the time `asked` times, then closes everything. Adds the bytes of sound that
/// it gets to `got`.
fn serve(socket: PathBuf, asked: u32, got: Arc<AtomicU64>) -> JoinHandle<()> {
    let listener = UnixListener::bind(&socket).expect("a socket");
    let thread = std::thread::Builder::new().name("a sound server".to_owned()).spawn(move || {
        let (stream, _) = listener.accept().expect("a client");
        let _ = converse(&stream, asked, &got);
        std::fs::remove_file(&socket).expect("the socket");
    });
    thread.expect("a thread")
}

fn converse(stream: &UnixStream, mut asked: u32, got: &AtomicU64) -> Result<(), ProtocolError> {
    let (mut from, mut to) = (BufReader::new(stream), stream);
    let mut played = 0;
    while asked > 0 {
        let head = read_descriptor(&mut from)?;
        let mut payload = vec![0; head.length as usize];
        from.read_exact(&mut payload)?;
        if head.channel != u32::MAX {
            played += u64::from(head.length);
            got.fetch_add(u64::from(head.length), Ordering::Relaxed);
            continue;
        }
        let (number, command) = Command::read_tag_prefixed(&mut Cursor::new(&payload), MAX_VERSION)?;
        match command {
            Command::Auth(_) => {
                let reply = AuthReply { version: MAX_VERSION, ..AuthReply::default() };
                write_reply_message(&mut to, number, &reply, MAX_VERSION)?;
            }
            Command::SetClientName(_) => {
                write_reply_message(&mut to, number, &SetClientNameReply { client_id: 1 }, MAX_VERSION)?;
            }
            Command::CreatePlaybackStream(parameters) => {
                let reply = CreatePlaybackStreamReply {
                    channel: 7,
                    sample_spec: parameters.sample_spec,
                    channel_map: parameters.channel_map,
                    buffer_attr: parameters.buffer_attr,
                    requested_bytes: 4800 * FRAME,
                    sink_name: Some(c"sink".to_owned()),
                    ..CreatePlaybackStreamReply::default()
                };
                write_reply_message(&mut to, number, &reply, MAX_VERSION)?;
            }
            Command::GetPlaybackLatency(_) => {
                asked -= 1;
                let reply = PlaybackLatency {
                    sink_usec: 0,
                    source_usec: 0,
                    playing: true,
                    local_time: SystemTime::UNIX_EPOCH,
                    remote_time: SystemTime::UNIX_EPOCH,
                    write_offset: played as i64,
                    read_offset: played as i64,
                    underrun_for: 0,
                    playing_for: 0,
                };
                write_reply_message(&mut to, number, &reply, MAX_VERSION)?;
            }
            _ => write_ack_message(&mut to, number)?,
        }
    }
    Ok(())
}

#[test]
fn a_server_that_closes_is_found_again_when_it_comes_back() {
    let dir = tempfile::tempdir().expect("a folder");
    let socket = dir.path().join("server");
    let (mixer, heard) = (Arc::new(Mixer::new(Arc::new(Sound::default()))), SharedHeard::default());
    heard.want(true);
    let (at, looks) = (socket.clone(), Arc::new(AtomicU64::new(0)));
    let patience = Patience { reopened: Duration::from_millis(100), answered: ANSWERED };
    let counted = Arc::clone(&looks);
    let find = move || {
        counted.fetch_add(1, Ordering::Relaxed);
        Some(at.clone())
    };
    let _output = Output::at(find, patience, &mixer, &heard);
    // There is none at first.
    wait_until("no server", || heard.failure().is_some_and(|why| why.contains("does not answer")));
    for round in 1..=2 {
        let (before, got) = (mixer.written() as f64, Arc::new(AtomicU64::new(0)));
        let server = serve(socket.clone(), 3, Arc::clone(&got));
        wait_until("a server", || heard.failure().is_none() && heard.frame(0.0).is_some());
        // What is heard is counted on from what was played before.
        wait_until("the sound", || heard.frame(0.0).is_some_and(|frame| frame == before + 4800.0));
        assert_eq!(got.load(Ordering::Relaxed), u64::from(4800 * FRAME));
        assert_eq!(mixer.written(), 4800 * round);
        server.join().expect("a server");
        wait_until("its loss", || heard.failure().is_some() && heard.frame(0.0).is_none());
    }
    // The control: while nothing plays, nobody looks for a server, except for a look that has begun. A slow machine sees less of it.
    let last = looks.load(Ordering::Relaxed);
    wait_until("further looks", || looks.load(Ordering::Relaxed) > last + 1);
    heard.want(false);
    let last = looks.load(Ordering::Relaxed);
    std::thread::sleep(Duration::from_millis(400));
    assert!(heard.failure().is_some() && looks.load(Ordering::Relaxed) <= last + 1);
    let server = serve(socket.clone(), 3, Arc::new(AtomicU64::new(0)));
    heard.want(true);
    wait_until("a server", || heard.failure().is_none());
    server.join().expect("a server");
}

#[test]
fn a_server_that_stops_to_answer_is_lost() {
    let dir = tempfile::tempdir().expect("a folder");
    let socket = dir.path().join("server");
    let (mixer, heard) = (Arc::new(Mixer::new(Arc::new(Sound::default()))), SharedHeard::default());
    heard.want(true);
    let listener = UnixListener::bind(&socket).expect("a socket");
    let (until_dropped, stopped) = sync_channel::<()>(0);
    let got = Arc::new(AtomicU64::new(0));
    let server = std::thread::Builder::new().name("a stopped server".to_owned()).spawn(move || {
        let (mut stream, _) = listener.accept().expect("a client");
        // It answers once and then keeps the connection without a word.
        let _ = converse(&stream, 1, &got);
        let _ = stopped.recv();
        // The client has shut the connection down, so that its thread does not wait for ever.
        stream.set_read_timeout(Some(HANG)).expect("a time");
        let ended = std::io::copy(&mut stream, &mut std::io::sink());
        ended.err().is_none_or(|error| error.kind() == std::io::ErrorKind::ConnectionReset)
    });
    let server = server.expect("a thread");
    let patience = Patience { reopened: Duration::from_millis(100), answered: Duration::from_secs(2) };
    let output = Output::at(move || Some(socket.clone()), patience, &mixer, &heard);
    wait_until("a server, the control", || heard.frame(0.0).is_some() && heard.failure().is_none());
    wait_until("its loss", || heard.failure().is_some_and(|why| why.contains("no answer within 2 s")));
    assert!(heard.frame(0.0).is_none());
    drop((output, until_dropped));
    assert!(server.join().expect("a server"), "the connection is shut down");
}
