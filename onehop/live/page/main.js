// The page: one view a log, one time for all of them, and the buttons.

import { byId, el, fit, put, seconds } from "./dom.js";
import { Playback, SPEEDS } from "./playback.js";
import { View } from "./view.js";

const FULL_SPEED = SPEEDS.length;
const RATE_MS = 1000;

const views = [];
const playback = new Playback();
const measured = { frames: 0, spent: 0, since: performance.now(), tick: -1 };
let logs = 0;
let pace = FULL_SPEED;
let marksOf = "";
let difference = null;

const page = {
  isNow: () => playback.isNow,
  seek,
  tell,
  explain,
  explained,
  changed,
  lost,
};

function begin() {
  addView(0);
  requestAnimationFrame(draw);
  byId("slider").addEventListener("input", () => seek(Number(byId("slider").value) * period()));
  for (const [id, act] of Object.entries({
    pause, step, slower: () => change(-1), faster: () => change(1), previous: () => jump(-1), next: () => jump(1),
    "to-now": () => (playback.isNow = true), "take-over": () => views[0].feed.say({ kind: "take over" }),
    "why-close": () => (byId("why").hidden = true), help,
  })) byId(id).addEventListener("click", act);
  document.addEventListener("keydown", onKey);
  fillLegend();
}

function addView(number) {
  const view = new View(number, page);
  views.push(view);
  byId("views").append(view.element);
}

/** What came from the server may change what the page is. */
function changed(view) {
  const { setting, hand, state } = view;
  if (setting && view === views[0]) {
    put(byId("title"), `${setting.name} \u00b7 seed ${setting.seed}`);
    document.title = `${setting.name} - Onehop`;
  }
  if (view.logs > logs) {
    logs = view.logs;
    for (let number = views.length; number < logs; number++) addView(number);
    document.body.classList.toggle("two", logs > 1);
  }
  if (view.isFresh && state.told) {
    view.isFresh = false;
    const at = Number.parseFloat(new URLSearchParams(location.search).get("at") ?? "");
    if (at >= 0) playback.open(at);
    else playback.isNow = Boolean(hand) || state.state === "running" || state.state === "starting";
  }
  if (view.difference !== undefined && view.difference !== difference) {
    difference = view.difference;
    marksOf = "";
  }
  if (difference && difference.at !== null && view.events.first?.text !== difference.words) {
    view.events.mark({ at: difference.at, weight: 2, text: difference.words, robot: 0 });
  }
}

function lost(view, isLost) {
  view.isLost = isLost;
}

const period = () => views[0].period || 0.05;
const end = () => Math.max(...views.map((view) => view.end));
const isMission = () => Boolean(views[0].hand);
/** Whether the buttons of time are those of the mission, or of what is shown of it. */
const holdsMission = () => playback.isNow && isMission() && views[0].hand.holds && views[0].hand.is_paced;

function seek(time) {
  playback.seek(time, end());
}

function tell(text, isBad = false) {
  put(byId("told"), text);
  byId("told").classList.toggle("bad", isBad);
}

function explain(view, event) {
  if (!playback.isNow || !isMission()) {
    playback.isPlaying = false;
    seek(event.at);
  }
  const robot = event.robot || view.chosen;
  if (!robot) return;
  view.choose(robot);
  askWhy(view, robot, event.at);
}

function askWhy(view, robot, time) {
  put(byId("why-title"), `Why robot ${robot} did that, at ${seconds(time)}`);
  put(byId("why-lines"), "reading the log \u2026");
  byId("why").hidden = false;
  view.feed.say({ kind: "explain", robot, at_s: Math.max(time, period()) });
}

function explained(message) {
  put(byId("why-lines"), message.lines.join("\n"));
  byId("why-lines").scrollTop = 0;
}

function pause() {
  if (holdsMission()) setPace(!views[0].hand.paused, 0);
  else if (playback.isNow) {
    playback.isPlaying = true;
    seek(0);
  } else if (isAtEnd()) {
    playback.isPlaying = true;
    seek(0);
  } else playback.isPlaying = !playback.isPlaying;
}

const isAtEnd = () => !playback.isNow && playback.time >= end() - period() / 2;

function step() {
  if (holdsMission()) setPace(true, views[0].hand.paused ? 1 : 0);
  else {
    playback.isPlaying = false;
    seek(playback.time + period());
  }
}

function change(by) {
  if (!holdsMission()) return playback.change(by);
  pace = Math.min(FULL_SPEED, Math.max(0, pace + by));
  return setPace(views[0].hand.paused, 0);
}

function setPace(paused, steps) {
  if (!views[0].hand.yours) return tell("Somebody else has the buttons.", true);
  const ticks = pace === FULL_SPEED ? 0 : SPEEDS[pace] / period();
  return views[0].feed.say({ kind: "pace", ticks_per_s: ticks, paused, steps });
}

/** To the next event, or the one before, that is more than a detail. */
function jump(by) {
  const now = playback.isNow ? views[0].time : playback.time;
  const times = views.flatMap((view) => view.events.rows.map(({ event }) => event))
    .filter((event) => event.weight > 0).map((event) => event.at).sort((a, b) => a - b);
  const there = by > 0 ? times.find((time) => time > now + 0.026) : times.findLast((time) => time < now - 0.026);
  if (there === undefined) return tell(by > 0 ? "No later event." : "No earlier event.");
  playback.isPlaying = false;
  return seek(there);
}

function help() {
  const legend = byId("legend");
  legend.hidden = !legend.hidden;
  byId("help").setAttribute("aria-expanded", String(!legend.hidden));
}

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName)) return;
  const isButton = /^(BUTTON|SUMMARY)$/.test(event.target.tagName);
  const acts = { ".": step, "-": () => change(-1), "+": () => change(1), "=": () => change(1), ArrowLeft: () => jump(-1),
    ArrowRight: () => jump(1), "?": help, Escape: () => { byId("why").hidden = true; views.forEach((view) => view.pick("choose")); },
    m: () => views.forEach((view) => view.showPlans(!view.showsPlans)),
    w: () => { const view = views.find((one) => one.chosen); if (view) askWhy(view, view.chosen, view.time); } };
  if (!isButton) acts[" "] = pause;
  const act = acts[event.key];
  if (act) {
    event.preventDefault();
    act();
  } else if (/^[1-9]$/.test(event.key)) views.forEach((view) => view.choose(Number(event.key)));
}

function draw(now) {
  requestAnimationFrame(draw);
  const begun = performance.now();
  playback.advance(now, end());
  for (const view of views) {
    const tick = playback.isNow ? -1 : Math.round(playback.time / period());
    view.feed.want(tick, view.frame ? view.frame.tick : -1, view.chosen);
    view.draw(now);
  }
  showTime();
  measured.frames++;
  measured.spent += performance.now() - begun;
  if (now - measured.since > RATE_MS) measure(now);
}

/** How many pictures a second this page draws, what one costs, and how fast the mission goes. */
function measure(now) {
  const passed = (now - measured.since) / 1000;
  const tick = views[0].frame ? views[0].frame.tick : -1;
  document.documentElement.dataset.fps = (measured.frames / passed).toFixed(1);
  document.documentElement.dataset.drawMs = (measured.spent / measured.frames).toFixed(2);
  const rate = ((tick - measured.tick) * period()) / passed;
  const moves = measured.tick >= 0 && tick > measured.tick && playback.isNow && views[0].state.state === "running";
  put(byId("rate"), moves ? `${rate < 10 ? rate.toFixed(1) : rate.toFixed(0)}\u00d7 real time` : "");
  Object.assign(measured, { frames: 0, spent: 0, since: now, tick });
}

function showTime() {
  const view = views[0];
  const last = Math.max(0, ...views.map((one) => one.state.last_tick));
  const slider = byId("slider");
  slider.max = String(last);
  const shown = playback.isNow ? Math.max(0, view.frame ? view.frame.tick : 0) : Math.round(playback.time / period());
  if (document.activeElement !== slider || playback.isNow || playback.isPlaying) slider.value = String(shown);
  slider.setAttribute("aria-valuetext", seconds(shown * period()));
  put(byId("clock"), seconds(shown * period()));
  showState(view);
  const mission = holdsMission();
  const paused = mission ? view.hand.paused : !playback.isPlaying;
  put(byId("pause"), (playback.isNow && !mission) || isAtEnd() ? "Play it again" : paused ? "Go on" : "Pause");
  byId("step").disabled = byId("slower").disabled = byId("faster").disabled = playback.isNow && !mission;
  const atPace = mission && view.hand.ticks_per_s > 0 ? view.hand.ticks_per_s * period() : 0;
  put(byId("speed"), mission ? (atPace ? `${+atPace.toFixed(2)}\u00d7` : "full speed") : `${playback.factor}\u00d7`);
  byId("to-now").hidden = playback.isNow || (!isMission() && view.state.state !== "running");
  drawMarks(last);
}

function showState(view) {
  const { state, outcome, words, reading } = view.state;
  const chip = byId("state");
  const paused = view.hand?.holds && view.hand.paused;
  const [text, kind] = view.isLost ? ["connection lost", "bad"]
    : state === "running" ? (paused ? ["paused", "fair"] : ["running", "good"])
    : state === "ended" ? [outcome || "ended", outcome === "arrived" ? "good" : "bad"]
    : state === "torn" ? ["torn log", "fair"]
    : state === "broken" ? ["damaged log", "bad"] : ["starting", "fair"];
  put(chip, text);
  chip.className = `chip ${kind}`;
  const banner = byId("banner");
  const isOver = isMission() && !view.hand.holds && state === "ended";
  const said = view.isLost ? "The connection is lost: the page tries again. What you see is the last that came."
    : isOver ? `The mission has ended. ${words}` : reading < 1 ? `Reading the log: ${Math.round(100 * reading)} %.`
    : differs() || words;
  put(banner, said);
  banner.hidden = !said;
  banner.classList.toggle("bad", Boolean(view.isLost) || state === "broken");
  const hand = view.hand;
  byId("take-over").hidden = !hand || hand.yours || !hand.holds;
  put(byId("watching"), hand && hand.viewers > 1 ? `${hand.viewers} look on; ${hand.yours ? "you have" : "somebody else has"} the buttons` : "");
}

const differs = () => (difference ? difference.words : "");

/** Events on the slider, and where two logs begin to differ. */
function drawMarks(last) {
  const canvas = byId("marks");
  const { palette } = views[0];
  const state = `${last} ${views.map((view) => `${view.events.rows.length}`)} ${difference?.at} ${palette.bad}`;
  if (!fit(canvas) && state === marksOf) return;
  marksOf = state;
  const pen = canvas.getContext("2d");
  pen.clearRect(0, 0, canvas.width, canvas.height);
  const whole = Math.max(1, last) * period();
  for (const view of views) {
    for (const { event } of view.events.rows) {
      if (event.weight < 1) continue;
      pen.fillStyle = event.weight > 1 ? palette.bad : palette.quiet;
      pen.globalAlpha = event.weight > 1 ? 0.9 : 0.5;
      pen.fillRect((event.at / whole) * canvas.width - 1, event.weight > 1 ? 0 : canvas.height / 2, 2, canvas.height);
    }
  }
  pen.globalAlpha = 1;
  if (difference && difference.at !== null) {
    pen.fillStyle = palette.accent;
    pen.fillRect((difference.at / whole) * canvas.width - 2, 0, 4, canvas.height);
  }
}

function fillLegend() {
  byId("legend").append(
    el("p", {}, "A team of robots drives to the star, on ground that nobody knows. One leads and finds the way; the others " +
      "keep a formation around it, and steer by the measured throughput of their radio link: when it drops, they hurry. " +
      "Nothing passes between them but by that radio."),
    el("ul", {},
      ...["Disc with a nose: a robot, its number, and where it heads. A ring in ink: it leads.",
        "Line from the leader: the way of its commands. Solid: the link is good. Long dashes: below the threshold. Dots: the last command was missed.",
        "Red stroke with a cross: a message that was lost.",
        "Dashed circle: the slot where a robot belongs. Dashed cross: what the leader drives to.",
        "Fine net: the leader's road map, points that it tried and ways between them; thick line: the way that it took.",
        "Red cross: a robot that is gone. Dashed red ring: a fault is in force on it.",
        "Point at a robot for what its laser sees; press W for why it does what it does.",
        "Point at an event for why it happened. Everything done here is a fault in the log, at an exact tick: \u201cRun it again\u201d has the command.",
        "Keys: space pause, . step, + \u2212 speed, \u2190 \u2192 events, 1-9 robot, W why, M road map, Esc close, ? this text."].map((text) => el("li", {}, text))));
}

begin();
