//! Real lines: pseudo-terminals and TCP, in real time, with simulated servos on the other end.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a line that cannot be opened is a broken test")]

use dh_drivers::clock::{Clock, RealClock, Time};
use dh_drivers::driver::Cause;
use dh_drivers::dynamixel::control_table::{MODELS, PRESENT_POSITION};
use dh_drivers::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use dh_drivers::port::{self, Exchange, Port, PortErrorKind, Recorded};
use dh_drivers::simulate::{Line, Pty, TcpLine, serve};
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Lines run in real time, and so do those who wait for them: one test at a time has the processor.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Servos on a line, in a thread, until it is dropped.
struct Served {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Served {
    fn on(mut line: impl Line + Send + 'static) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&stop);
        let run = move || {
            let servo = |id| ServoSpec { id, model: &MODELS[0], baud: 1_000_000, position: 1000.0 };
            let mut bus = SimulatedBus::new([1, 2].map(servo));
            serve(&mut bus, &mut line, &RealClock::new(), &told).unwrap();
        };
        Self { stop, thread: Some(std::thread::spawn(run)) }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn clock() -> Arc<dyn Clock> {
    Arc::new(RealClock::new())
}

/// A name that nothing else uses.
fn link(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("dh-drivers-{name}-{}", std::process::id()))
}

fn positions(bus: &mut Bus) -> Vec<i64> {
    let answers = bus.sync_read(&[1, 2], PRESENT_POSITION.address, PRESENT_POSITION.size).unwrap();
    answers.iter().map(|answer| PRESENT_POSITION.value(&answer.data).unwrap()).collect()
}

#[test]
fn a_bus_speaks_over_terminals_and_tcp() {
    let _alone = alone();
    let terminal = Pty::open(None).unwrap();
    let tcp = TcpLine::bind("127.0.0.1:0").unwrap();
    let names = [terminal.name(), tcp.name()];
    let _served = (Served::on(terminal), Served::on(tcp));
    for name in names {
        let mut bus = Bus::new(port::open(&name, 1_000_000, clock()).unwrap(), Timing::default());
        assert_eq!(bus.port().name(), name);
        for _ in 0..50 {
            assert_eq!(positions(&mut bus), [1000, 1000]);
        }
        let found = bus.scan().unwrap();
        assert_eq!(found.iter().map(|servo| servo.id).collect::<Vec<_>>(), [1, 2]);
        // Nobody of that id: the wait is what was promised, and is not spent computing.
        let start = Instant::now();
        let error = bus.ping(9).unwrap_err();
        assert!(matches!(error.cause, Cause::Silent { .. }), "{error}");
        assert!(error.to_string().starts_with(&format!("{name}, servo 9, ping: no answer in ")), "{error}");
        assert!(start.elapsed() < bus.longest(10, &[3]) + Duration::from_millis(200));
    }
}

#[test]
fn a_port_belongs_to_one_program() {
    let _alone = alone();
    let terminal = Pty::open(None).unwrap();
    let name = terminal.name();
    let _served = Served::on(terminal);
    let first = port::open(&name, 57_600, clock()).unwrap();
    let error = port::open(&name, 57_600, clock()).unwrap_err();
    assert_eq!((error.port.as_str(), &error.kind), (name.as_str(), &PortErrorKind::Busy));
    assert_eq!(error.to_string(), format!("{name} is in use by another program"));
    drop(first);
    port::open(&name, 57_600, clock()).unwrap();
    let error = port::open("/dev/there-is-no-such-port", 57_600, clock()).unwrap_err();
    assert_eq!(error.kind, PortErrorKind::Gone);
    assert_eq!(port::open("tcp:127.0.0.1:1", 1, clock()).unwrap_err().kind, PortErrorKind::Gone);
}

#[test]
fn reads_end_at_their_deadline() {
    let _alone = alone();
    let terminal = Pty::open(None).unwrap();
    let mut port = port::open(&terminal.name(), 57_600, clock()).unwrap();
    let clock = port.clock();
    let mut buffer = [0; 16];
    let deadline = clock.now() + Duration::from_millis(30);
    assert_eq!(port.read(&mut buffer, deadline).unwrap_err().kind, PortErrorKind::TimedOut);
    assert!(clock.now() >= deadline && clock.now() - deadline < Duration::from_millis(200));
    assert_eq!(port.read(&mut buffer, Time::START).unwrap_err().kind, PortErrorKind::TimedOut);
    let mut terminal = terminal;
    let mut send = |bytes| {
        terminal.send(bytes).unwrap();
        // The system carries them over when it finds the time.
        std::thread::sleep(Duration::from_millis(100));
    };
    send(b"bytes");
    assert_eq!(port.read(&mut buffer, Time::START).unwrap(), 5);
    assert_eq!(&buffer[..5], b"bytes");
    send(b"stale");
    port.discard_input().unwrap();
    assert_eq!(port.read(&mut buffer, Time::START).unwrap_err().kind, PortErrorKind::TimedOut);
    port.set_baud(3_000_000).unwrap();
    assert_eq!(port.baud(), Some(3_000_000));
}

/// The device goes and comes back under the same name: the bus says so, and goes on.
#[test]
fn a_bus_comes_back_with_its_device() {
    let _alone = alone();
    let link = link("cut");
    let first = Served::on(Pty::open(Some(&link)).unwrap());
    let name = link.to_str().unwrap();
    let mut bus = Bus::new(port::open(name, 1_000_000, clock()).unwrap(), Timing::default());
    assert_eq!(positions(&mut bus), [1000, 1000]);
    drop(first);
    for _ in 0..3 {
        let error = bus.ping(1).unwrap_err();
        assert!(matches!(error.cause, Cause::Port(ref port) if port.kind == PortErrorKind::Gone), "{error}");
        assert!(error.to_string().contains(name), "{error}");
    }
    let _second = Served::on(Pty::open(Some(&link)).unwrap());
    assert_eq!(positions(&mut bus), [1000, 1000]);
}

/// A link from before is replaced, anything else of that name is left alone.
#[test]
fn a_link_harms_nothing() {
    let _alone = alone();
    let link = link("link");
    let first = Pty::open(Some(&link)).unwrap();
    let second = Pty::open(Some(&link)).unwrap();
    assert_eq!(second.name(), link.to_str().unwrap());
    drop(first);
    assert!(link.exists(), "the link is the second's");
    drop(second);
    assert!(link.symlink_metadata().is_err());
    std::fs::write(&link, "a file").unwrap();
    assert!(Pty::open(Some(&link)).is_err());
    assert_eq!(std::fs::read_to_string(&link).unwrap(), "a file");
    std::fs::remove_file(&link).unwrap();
}

#[test]
fn a_recording_takes_only_what_it_recorded() {
    let _alone = alone();
    let exchange = Exchange { request: vec![1, 2], reply: vec![3] };
    let mut port = Recorded::new(clock(), [exchange]);
    let error = port.write_all(&[1], Time::NEVER).unwrap_err();
    assert_eq!(error.to_string(), "recording: [01] was sent, where [01, 02] is recorded");
    port.write_all(&[1, 2], Time::NEVER).unwrap();
    let mut buffer = [0; 4];
    assert_eq!((port.read(&mut buffer, Time::START).unwrap(), buffer[0], port.remaining()), (1, 3, 0));
    assert_eq!(port.read(&mut buffer, Time::START).unwrap_err().kind, PortErrorKind::TimedOut);
}

/// Who comes while a TCP line is taken is sent away at once; when it is free again, it is anybody's.
#[test]
fn a_tcp_line_has_one_end() {
    let _alone = alone();
    let line = TcpLine::bind("127.0.0.1:0").unwrap();
    let name = line.name();
    let _served = Served::on(line);
    let mut first = Bus::new(port::open(&name, 1_000_000, clock()).unwrap(), Timing::default());
    assert_eq!(positions(&mut first), [1000, 1000]);
    let mut second = Bus::new(port::open(&name, 1_000_000, clock()).unwrap(), Timing::default());
    let error = second.ping(1).unwrap_err();
    assert!(matches!(error.cause, Cause::Port(ref port) if port.kind == PortErrorKind::Gone), "{error}");
    assert_eq!(positions(&mut first), [1000, 1000]);
    drop(first);
    let deadline = Instant::now() + Duration::from_secs(5);
    while second.ping(1).is_err() {
        assert!(Instant::now() < deadline, "the line is free");
    }
}

/// Somebody who sends without end, faster than it can be read: calls end all the same.
#[test]
fn a_flood_holds_nobody_up() {
    let _alone = alone();
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let name = format!("tcp:{}", listener.local_addr().unwrap());
    let flood = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        while stream.write_all(&[0xfe; 4096]).is_ok() {}
    });
    let mut bus = Bus::new(port::open(&name, 1_000_000, clock()).unwrap(), Timing::default());
    let start = Instant::now();
    bus.ping(1).unwrap_err();
    assert!(start.elapsed() < Duration::from_secs(3), "{:?}", start.elapsed());
    drop(bus);
    flood.join().unwrap();
}
