//! The session on the bus: connection, briefing, presence, and messages with their parts put together.

use std::sync::mpsc::{channel, Receiver, Sender};
use std::time::{Duration, Instant};

use rmpv::Value;
use sha2::{Digest, Sha256};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::qos::CongestionControl;
use zenoh::query::ConsolidationMode;
use zenoh::sample::SampleKind;
use zenoh::{Config, Session, Wait};

use crate::simple::decoded;
use crate::Fallible;

const PART_BYTES: usize = 48_000;
const BRIEFING: Duration = Duration::from_secs(30);
const REUNION: Duration = Duration::from_secs(10);

const WORLD_IS_THERE: &str = "world is there";
const WORLD_IS_GONE: &str = "world is gone";

type Message = (String, Vec<u8>);

pub struct Bus {
    session: Session,
    mission: String,
    name: String,
    queue: Receiver<Message>,
    parts: Vec<u8>,
    will_be_stopped: bool,
    _subscribers: [Subscriber<()>; 2],
    token: Option<LivelinessToken>,
}

impl Bus {
    pub fn open(mission: &str, name: &str, endpoint: &str, password: &str) -> Fallible<Bus> {
        let digest = Sha256::digest(password.as_bytes());
        let hexadecimal: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        let mut config = Config::default();
        for (key, value) in [
            ("mode", "\"client\"".to_string()),
            ("connect/endpoints", format!("[{endpoint:?}]")),
            ("connect/timeout_ms", "300000".to_string()),
            ("connect/exit_on_failure", "true".to_string()),
            ("listen/endpoints", "[]".to_string()),
            ("scouting/multicast/enabled", "false".to_string()),
            ("transport/unicast/qos/enabled", "false".to_string()),
            ("transport/unicast/lowlatency", "true".to_string()),
            (
                "transport/auth/usrpwd",
                format!("{{user: {name:?}, password: {password:?}}}"),
            ),
            ("id", format!("\"1{}\"", &hexadecimal[..31])),
        ] {
            config.insert_json5(key, &value)?;
        }
        let session = zenoh::open(config).wait()?;
        let (sender, queue) = channel();
        let heard = listen(&session, &format!("{mission}/to/{name}/**"), sender.clone())?;
        let world = watch(&session, &format!("{mission}/alive/world"), sender)?;
        Ok(Bus {
            session,
            mission: mission.to_string(),
            name: name.to_string(),
            queue,
            parts: Vec::new(),
            will_be_stopped: false,
            _subscribers: [heard, world],
            token: None,
        })
    }

    /// Put a message on a key of this robot's; what is too long for its link goes in parts.
    pub fn say(&self, what: &str, mut data: &[u8]) -> Fallible<()> {
        while data.len() > PART_BYTES {
            let (part, rest) = data.split_at(PART_BYTES);
            self.put("part", part)?;
            data = rest;
        }
        self.put(what, data)
    }

    fn put(&self, what: &str, data: &[u8]) -> Fallible<()> {
        self.session
            .put(format!("{}/from/{}/{what}", self.mission, self.name), data)
            .express(true)
            .congestion_control(CongestionControl::Block)
            .wait()
    }

    /// Asked for until it is given.
    pub fn briefing(&self) -> Fallible<Value> {
        let deadline = Instant::now() + BRIEFING;
        while Instant::now() < deadline {
            self.say("arrival", b"")?;
            let replies = self
                .session
                .get(format!("{}/config/{}", self.mission, self.name))
                .consolidation(ConsolidationMode::None)
                .timeout(Duration::from_secs(2))
                .wait()?;
            let mut answer = Vec::new();
            while let Ok(reply) = replies.recv() {
                if let Ok(sample) = reply.result() {
                    answer.extend_from_slice(&sample.payload().to_bytes());
                    if sample.attachment().is_none() {
                        return decoded(&answer); // those with one are followed by more
                    }
                }
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Err("the world gave no briefing".into())
    }

    /// Last of all: who sees the token may send at once.
    pub fn announce(&mut self) -> Fallible<()> {
        let key = format!("{}/alive/{}", self.mission, self.name);
        self.token = Some(self.session.liveliness().declare_token(key).wait()?);
        Ok(())
    }

    /// The next message for this robot; None when the world has gone.
    pub fn receive(&mut self) -> Option<Message> {
        while let Ok((what, mut data)) = self.queue.recv() {
            if what == "part" {
                self.parts.append(&mut data);
                continue;
            }
            if what == WORLD_IS_GONE && !(self.will_be_stopped && self.world_comes_back()) {
                return None;
            }
            if what != WORLD_IS_GONE && what != WORLD_IS_THERE {
                match what.as_str() {
                    "stop" | "wake" => self.will_be_stopped = true,
                    "percept" => self.will_be_stopped = false,
                    _ => {}
                }
                let mut whole = std::mem::take(&mut self.parts);
                whole.append(&mut data);
                return Some((what, whole));
            }
        }
        None
    }

    /// A process that was stopped for long has lost its session; Zenoh opens it again.
    fn world_comes_back(&mut self) -> bool {
        let deadline = Instant::now() + REUNION;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.queue.recv_timeout(left) {
                Ok((what, _)) if what == WORLD_IS_THERE => return true,
                Ok(_) => {}
                Err(_) => return false,
            }
        }
    }

    pub fn close(self) -> Fallible<()> {
        self.session.close().wait()
    }
}

fn listen(session: &Session, key: &str, queue: Sender<Message>) -> Fallible<Subscriber<()>> {
    session
        .declare_subscriber(key)
        .callback(move |sample| {
            let key = sample.key_expr().as_str();
            let what = key.rsplit('/').next().unwrap_or_default().to_string();
            let _ = queue.send((what, sample.payload().to_bytes().into_owned()));
        })
        .wait()
}

fn watch(session: &Session, key: &str, queue: Sender<Message>) -> Fallible<Subscriber<()>> {
    session
        .liveliness()
        .declare_subscriber(key)
        .history(true)
        .callback(move |sample| {
            let is_there = sample.kind() == SampleKind::Put;
            let what = if is_there {
                WORLD_IS_THERE
            } else {
                WORLD_IS_GONE
            };
            let _ = queue.send((what.to_string(), Vec::new()));
        })
        .wait()
}
