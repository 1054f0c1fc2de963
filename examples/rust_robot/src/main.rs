//! The robot of simple_robot.py in Rust: one process of a mission, by docs/wire.md alone.
//!
//! `onehop run` starts it with `--mission PREFIX --lifeline FD --id ROBOT --connect ENDPOINT` and its
//! password in ONEHOP_PASSWORD.

mod bus;
mod simple;

use std::error::Error;
use std::process::exit;

use bus::Bus;
use simple::Simple;

pub type Fallible<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Exit status of a robot whose world has gone, and of one whose program has failed.
const WORLD_IS_GONE: i32 = 3;
const PROGRAM_FAILED: i32 = 4;

fn main() {
    match run() {
        Ok(status) => exit(status),
        Err(error) => {
            eprintln!("{error}");
            exit(1)
        }
    }
}

fn run() -> Fallible<i32> {
    unsafe { libc::signal(libc::SIGINT, libc::SIG_IGN) }; // Ctrl-C is for whoever started the mission
    let (mission, endpoint) = (option("--mission")?, option("--connect")?);
    let name = format!("robot-{}", option("--id")?);
    let password = std::env::var("ONEHOP_PASSWORD")?;
    let mut bus = Bus::open(&mission, &name, &endpoint, &password)?;
    let mut robot = Simple::new(&bus.briefing()?)?;
    bus.announce()?;
    while let Some((what, data)) = bus.receive() {
        match what.as_str() {
            "percept" => match robot.step(&data) {
                Ok(action) => bus.say("out", &action)?,
                Err(error) => {
                    eprintln!("{error}");
                    bus.say("failed", error.to_string().as_bytes())?;
                    bus.close()?;
                    return Ok(PROGRAM_FAILED);
                }
            },
            "stop" | "wake" => bus.say("awake", b"")?,
            "kill" => unsafe {
                libc::kill(libc::getpid(), libc::SIGKILL);
            },
            "end" => {
                bus.close()?;
                return Ok(0);
            }
            _ => {}
        }
    }
    Ok(WORLD_IS_GONE)
}

/// The word after an option of the command line.
fn option(name: &str) -> Fallible<String> {
    let mut words = std::env::args().skip_while(|word| word != name);
    words.next();
    words
        .next()
        .ok_or_else(|| format!("{name} is missing").into())
}
