//! What simple_robot.py does, operation by operation, and its messages in msgpack.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use rmp::encode::{
    write_array_len, write_bin, write_f64, write_map_len, write_nil, write_str, write_uint,
};
use rmpv::Value;

use crate::Fallible;

const WIRE_VERSION: u64 = 3;

pub struct Simple {
    robot: u64,
    incarnation: u64,
    goal: (f64, f64),
    speed: f64,
    heard: BTreeMap<u64, (f64, f64)>,
    has_arrived: bool,
}

impl Simple {
    pub fn new(briefing: &Value) -> Fallible<Simple> {
        let goal = field(briefing, "goal")?;
        Ok(Simple {
            robot: whole(field(briefing, "robot")?)?,
            incarnation: whole(field(briefing, "incarnation")?)?,
            goal: (number(field(goal, "x")?)?, number(field(goal, "y")?)?),
            speed: field(field(briefing, "parameters")?, "speed").map_or(Ok(0.5), number)?,
            heard: BTreeMap::new(),
            has_arrived: false,
        })
    }

    /// The action for a percept, both as they are on the wire.
    pub fn step(&mut self, percept: &[u8]) -> Fallible<Vec<u8>> {
        let percept = rmpv::decode::read_value(&mut &percept[..])?;
        let messages = list(at(&percept, 1)?)?;
        let observation = decoded(bytes(at(&messages[0], 1)?)?)?;
        let inbox = decoded(bytes(at(&messages[1], 1)?)?)?;
        for message in list(field(&inbox, "receptions")?)? {
            let payload = bytes(field(message, "payload")?)?;
            if payload.len() == 16 {
                let x = f64::from_le_bytes(payload[..8].try_into()?);
                let y = f64::from_le_bytes(payload[8..].try_into()?);
                self.heard.insert(whole(field(message, "source")?)?, (x, y));
            }
        }
        let tick = whole(field(&observation, "tick")?)?;
        let pose = field(&observation, "pose")?;
        let (x, y) = (number(field(pose, "x")?)?, number(field(pose, "y")?)?);
        let heading = number(field(pose, "heading")?)?;
        let (goal_x, goal_y) = self.goal;
        let (dx, dy) = (goal_x - x, goal_y - y);
        let distance = (dx * dx + dy * dy).sqrt();
        let away = |&&(x, y): &&(f64, f64)| {
            ((goal_x - x) * (goal_x - x) + (goal_y - y) * (goal_y - y)).sqrt() < distance
        };
        let nearer = self.heard.values().filter(away).count() as f64;
        let (mut v, mut w, mut arrives) = (0.0, 0.0, false);
        if self.has_arrived || distance < 0.4 + 0.6 * nearer {
            arrives = !self.has_arrived;
            self.has_arrived = true;
        } else {
            let (s, c) = (sine(heading), cosine(heading));
            let (ahead, left) = ((c * dx + s * dy) / distance, (c * dy - s * dx) / distance);
            let scan = bytes(field(&observation, "scan")?)?;
            let beams = scan.len() / 4;
            let third = beams / 6;
            let nearest = scan[4 * third..4 * (beams - third)]
                .chunks_exact(4)
                .map(|range| f32::from_le_bytes(range.try_into().expect("four bytes")))
                .fold(f32::INFINITY, f32::min);
            let near = (f64::from(nearest) - 0.4).clamp(0.0, 1.0);
            v = self.speed * ahead.max(0.0) * near;
            w = if ahead > 0.0 { 2.0 * left } else { 1.0 };
        }
        let speaks = tick % 20 == self.robot % 20;
        let mut out = Vec::new();
        write_map_len(&mut out, 10)?;
        write_key_and_whole(&mut out, "v", WIRE_VERSION)?;
        write_key_and_whole(&mut out, "tick", tick)?;
        write_key_and_whole(&mut out, "incarnation", self.incarnation)?;
        write_str(&mut out, "twist")?;
        write_map_len(&mut out, 2)?;
        write_key_and_number(&mut out, "v", v)?;
        write_key_and_number(&mut out, "w", w)?;
        write_str(&mut out, "outbox")?;
        write_array_len(&mut out, speaks.into())?;
        if speaks {
            write_map_len(&mut out, 4)?;
            write_key_and_whole(&mut out, "destination", 0)?;
            write_str(&mut out, "payload")?;
            write_bin(&mut out, &[x.to_le_bytes(), y.to_le_bytes()].concat())?;
            write_key_and_whole(&mut out, "msdu_bytes", 16)?;
            write_key_and_whole(&mut out, "lifetime_ns", 0)?;
        }
        write_key_and_number(&mut out, "speed", v.abs())?;
        write_key_and_number(&mut out, "remaining_distance", distance)?;
        write_str(&mut out, "status")?;
        write_nil(&mut out)?;
        write_str(&mut out, "notes")?;
        write_array_len(&mut out, arrives.into())?;
        if arrives {
            write_map_len(&mut out, 2)?;
            write_str(&mut out, "kind")?;
            write_str(&mut out, "arrived")?;
            write_str(&mut out, "data")?;
            write_map_len(&mut out, 1)?;
            write_key_and_number(&mut out, "distance", distance)?;
        }
        write_str(&mut out, "values")?;
        write_map_len(&mut out, 2)?;
        write_key_and_number(&mut out, "to_goal", distance)?;
        write_key_and_number(&mut out, "heard", self.heard.len() as f64)?;
        Ok(out)
    }
}

fn sine(angle: f64) -> f64 {
    let arc = 4.0 / PI * angle - 4.0 / (PI * PI) * angle * angle.abs();
    0.775 * arc + 0.225 * arc * arc.abs()
}

fn cosine(angle: f64) -> f64 {
    sine(if angle <= PI / 2.0 {
        angle + PI / 2.0
    } else {
        angle - 3.0 * PI / 2.0
    })
}

/// A wire message as a map; one of another version of the wire is refused.
pub fn decoded(data: &[u8]) -> Fallible<Value> {
    let message = rmpv::decode::read_value(&mut &data[..])?;
    match whole(field(&message, "v")?)? {
        WIRE_VERSION => Ok(message),
        other => {
            Err(format!("version {other} of the wire; this robot speaks {WIRE_VERSION}").into())
        }
    }
}

fn field<'a>(map: &'a Value, name: &str) -> Fallible<&'a Value> {
    let fields = map.as_map().ok_or("no map")?;
    let found = fields.iter().find(|(key, _)| key.as_str() == Some(name));
    found
        .map(|(_, value)| value)
        .ok_or_else(|| format!("no field {name}").into())
}

fn at(value: &Value, place: usize) -> Fallible<&Value> {
    list(value)?
        .get(place)
        .ok_or_else(|| "a list that is too short".into())
}

fn list(value: &Value) -> Fallible<&Vec<Value>> {
    value.as_array().ok_or_else(|| "no list".into())
}

fn bytes(value: &Value) -> Fallible<&[u8]> {
    value.as_slice().ok_or_else(|| "no bytes".into())
}

fn whole(value: &Value) -> Fallible<u64> {
    value.as_u64().ok_or_else(|| "no whole number".into())
}

fn number(value: &Value) -> Fallible<f64> {
    value.as_f64().ok_or_else(|| "no number".into())
}

fn write_key_and_whole(out: &mut Vec<u8>, key: &str, value: u64) -> Fallible<()> {
    write_str(out, key)?;
    write_uint(out, value)?;
    Ok(())
}

fn write_key_and_number(out: &mut Vec<u8>, key: &str, value: f64) -> Fallible<()> {
    write_str(out, key)?;
    write_f64(out, value)?;
    Ok(())
}
