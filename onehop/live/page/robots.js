// Robots and what goes on between them: bodies, links, lost messages, slots, paths, what a laser sees.

const FLASH_MS = 600, MOST_FLASHES = 80, MANY = 12;
const TRAIL_SAMPLES = 80;
const FAR = 6; // pixels a metre: below it robots that keep their distance would cover each other

/** Everything that moves. scene: {frame, places, setting, palette, place, scale, chosen, flashes, samples}. */
export function drawTeam(pen, scene) {
  drawTrails(pen, scene);
  drawScan(pen, scene);
  drawFaults(pen, scene);
  drawSlots(pen, scene);
  drawRoutes(pen, scene);
  drawFlashes(pen, scene);
  for (const gone of scene.frame.gone) drawGone(pen, scene, gone);
  for (const robot of scene.frame.robots) drawRobot(pen, scene, robot);
}

function drawTrails(pen, { setting, samples, frame, place }) {
  const last = lastBefore(samples, frame.tick);
  const leaders = new Set(frame.robots.filter(leads).map((robot) => robot.id));
  setting.robots.forEach((robot, number) => {
    const isLeader = leaders.has(robot.id);
    const first = isLeader ? 0 : Math.max(0, last - TRAIL_SAMPLES);
    pen.strokeStyle = robot.colour;
    pen.globalAlpha = isLeader ? 0.6 : 0.35;
    pen.lineWidth = isLeader ? 2 : 1.2;
    pen.beginPath();
    let before = null;
    for (let row = first; row <= last; row++) {
      const at = samples[row][number + 1];
      const joined = at && before && Math.hypot(at[0] - before[0], at[1] - before[1]) < 5;
      if (joined) pen.lineTo(...place(at[0], at[1]));
      else if (at) pen.moveTo(...place(at[0], at[1]));
      before = at;
    }
    pen.stroke();
  });
  pen.globalAlpha = 1;
}

function lastBefore(samples, tick) {
  let low = 0, high = samples.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (samples[middle][0] <= tick) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Whether a robot acts as leader. */
export const leads = (robot) => robot.status && robot.status.leader === robot.id;

function drawScan(pen, { frame, setting, chosen, place, scale, places }) {
  const robot = setting.robots.find((one) => one.id === chosen);
  const at = places.get(chosen);
  if (!frame.scan || !robot || !at) return;
  const { ranges } = frame.scan;
  const wide = (robot.laser.fov_deg * Math.PI) / 180;
  const [x, y] = place(at.x, at.y);
  pen.fillStyle = pen.strokeStyle = robot.colour;
  pen.globalAlpha = 0.13;
  pen.beginPath();
  pen.moveTo(x, y);
  ranges.forEach((range, beam) => {
    const angle = at.heading - wide / 2 + (wide * beam) / Math.max(1, ranges.length - 1);
    const length = (range < 0 ? robot.laser.range : range / 100) * scale;
    pen.lineTo(x + length * Math.cos(angle), y - length * Math.sin(angle));
  });
  pen.closePath();
  pen.fill();
  pen.globalAlpha = 0.5;
  pen.lineWidth = 0.8;
  pen.stroke();
  pen.globalAlpha = 1;
}

function drawFaults(pen, { frame, place, scale, palette, places }) {
  pen.strokeStyle = pen.fillStyle = palette.bad;
  pen.lineWidth = 1.5;
  for (const [x, y, radius] of frame.jams) {
    const [px, py] = place(x, y);
    pen.globalAlpha = 0.12;
    pen.beginPath();
    pen.arc(px, py, radius * scale, 0, 7);
    pen.fill();
    pen.globalAlpha = 0.9;
    pen.setLineDash([6, 4]);
    pen.stroke();
    pen.setLineDash([]);
    label(pen, "jammed", px, py - radius * scale - 4, palette);
  }
  pen.globalAlpha = 1;
  for (const [one, other] of frame.cuts) drawCut(pen, one, other, places, place, palette);
}

/** A cut is a wall between the middles of its two sides. */
function drawCut(pen, one, other, places, place, palette) {
  const middle = (ids) => {
    const there = ids.map((id) => places.get(id)).filter(Boolean);
    if (!there.length) return null;
    const sum = there.reduce(([x, y], at) => [x + at.x, y + at.y], [0, 0]);
    return place(sum[0] / there.length, sum[1] / there.length);
  };
  const a = middle(one), b = middle(other);
  if (!a || !b) return;
  const x = (a[0] + b[0]) / 2, y = (a[1] + b[1]) / 2;
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const dx = (-(b[1] - a[1]) / length) * 34, dy = ((b[0] - a[0]) / length) * 34;
  pen.strokeStyle = palette.bad;
  pen.lineWidth = 3;
  pen.setLineDash([2, 3]);
  segment(pen, x - dx, y - dy, x + dx, y + dy);
  pen.setLineDash([]);
  label(pen, "cut", x + dx, y + dy - 5, palette);
}

function drawSlots(pen, { frame, place, places, scale, setting, palette }) {
  const colour = new Map(setting.robots.map((robot) => [robot.id, robot.colour]));
  pen.setLineDash([3, 3]);
  for (const [id, leader, x, y] of frame.slots) {
    const [px, py] = place(x, y);
    const at = places.get(leader);
    pen.globalAlpha = 0.35;
    pen.strokeStyle = palette.quiet;
    pen.lineWidth = 1;
    if (at) segment(pen, ...place(at.x, at.y), px, py);
    pen.globalAlpha = 0.9;
    pen.strokeStyle = colour.get(id) || palette.quiet;
    pen.lineWidth = 1.4;
    pen.beginPath();
    pen.arc(px, py, Math.max(6, 0.5 * scale), 0, 7);
    pen.stroke();
  }
  for (const robot of frame.robots) {
    if (!leads(robot) || robot.status.target[0] === null) continue;
    const at = places.get(robot.id);
    const [tx, ty] = place(...robot.status.target);
    pen.strokeStyle = colour.get(robot.id);
    pen.globalAlpha = 0.8;
    segment(pen, ...place(at.x, at.y), tx, ty);
    segment(pen, tx - 5, ty, tx + 5, ty);
    segment(pen, tx, ty - 5, tx, ty + 5);
  }
  pen.setLineDash([]);
  pen.globalAlpha = 1;
}

/** The way of the leader's commands, in the colour of what the last one measured. */
function drawRoutes(pen, { frame, place, places, palette }) {
  const status = new Map(frame.robots.map((robot) => [robot.id, robot.status]));
  for (const route of frame.routes) {
    const of = status.get(route[route.length - 1]);
    if (!of) continue;
    const isSilent = !(of.throughput > 0), isWeak = of.throughput < of.threshold;
    pen.strokeStyle = isSilent ? palette.bad : isWeak ? palette.fair : palette.good;
    pen.lineWidth = isSilent ? 1.6 : isWeak ? 2 : 2.6;
    pen.setLineDash(isSilent ? [2, 5] : isWeak ? [8, 5] : []);
    pen.globalAlpha = 0.85;
    for (let hop = 1; hop < route.length; hop++) {
      const from = places.get(route[hop - 1]), to = places.get(route[hop]);
      if (from && to) segment(pen, ...place(from.x, from.y), ...place(to.x, to.y));
    }
  }
  pen.setLineDash([]);
  pen.globalAlpha = 1;
}

function drawFlashes(pen, { flashes, now, place, places, palette, setting }) {
  pen.strokeStyle = palette.bad;
  pen.lineWidth = setting.robots.length > MANY ? 1 : 2.6;
  for (const flash of flashes) {
    const age = (now - flash.at) / FLASH_MS;
    const from = places.get(flash.from), to = places.get(flash.to);
    if (age > 1 || !from || !to) continue;
    pen.globalAlpha = 0.9 * (1 - age);
    const [x0, y0] = place(from.x, from.y), [x1, y1] = place(to.x, to.y);
    const part = 0.35 + 0.4 * age;
    const x = x0 + (x1 - x0) * part, y = y0 + (y1 - y0) * part;
    segment(pen, x0, y0, x, y);
    segment(pen, x - 4, y - 4, x + 4, y + 4);
    segment(pen, x - 4, y + 4, x + 4, y - 4);
  }
  pen.globalAlpha = 1;
}

/** Those of the lost messages that still show. */
export const fresh = (flashes, now) => flashes.filter((flash) => now - flash.at < FLASH_MS).slice(-MOST_FLASHES);

function drawGone(pen, { place, palette }, gone) {
  const [x, y] = place(gone.x, gone.y);
  pen.strokeStyle = palette.bad;
  pen.lineWidth = 3;
  segment(pen, x - 7, y - 7, x + 7, y + 7);
  segment(pen, x - 7, y + 7, x + 7, y - 7);
  label(pen, `${gone.id} gone: ${gone.why}`, x, y - 12, palette);
}

function drawRobot(pen, { places, place, scale, setting, palette, chosen }, robot) {
  const at = places.get(robot.id);
  const own = setting.robots.find((one) => one.id === robot.id);
  if (!at || !own) return;
  const [x, y] = place(at.x, at.y);
  const least = setting.robots.length > MANY || scale < FAR ? 6 : 9;
  const radius = Math.min(15, Math.max(least, own.radius * scale));
  const dx = Math.cos(at.heading), dy = -Math.sin(at.heading);
  pen.fillStyle = own.colour;
  pen.strokeStyle = palette.panel;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x + 2.1 * radius * dx, y + 2.1 * radius * dy);
  pen.lineTo(x - radius * dy, y + radius * dx);
  pen.lineTo(x + radius * dy, y - radius * dx);
  pen.closePath();
  pen.fill();
  pen.stroke();
  pen.beginPath();
  pen.arc(x, y, radius, 0, 7);
  pen.fill();
  pen.stroke();
  if (leads(robot)) ring(pen, x, y, radius + 4, palette.ink, 2);
  if (robot.id === chosen) ring(pen, x, y, radius + 8, palette.accent, 2.5);
  if (robot.state.length) {
    pen.setLineDash([3, 2]);
    ring(pen, x, y, radius + 6, palette.bad, 2.5);
    pen.setLineDash([]);
    label(pen, robot.state.join(", "), x, y + radius + 19, palette);
  }
  pen.fillStyle = "#fff";
  pen.strokeStyle = "rgba(0,0,0,.6)";
  pen.lineWidth = 2;
  pen.font = `700 ${Math.max(9, Math.min(14, radius * 1.15))}px system-ui, sans-serif`;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.strokeText(String(robot.id), x, y + 0.5);
  pen.fillText(String(robot.id), x, y + 0.5);
  pen.textBaseline = "alphabetic";
}

function ring(pen, x, y, radius, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 7);
  pen.stroke();
}

/** Text that can be read on any ground. */
export function label(pen, text, x, y, palette) {
  pen.font = "600 12px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.lineWidth = 3.5;
  pen.strokeStyle = palette.ground;
  pen.fillStyle = palette.ink;
  pen.strokeText(text, x, y);
  pen.fillText(text, x, y);
}

function segment(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}
