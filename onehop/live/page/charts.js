// Four strips of numbers over time, one line a robot. Drawn anew only when there is something new.

import { colours, el, fit, put, seconds, sizeOf } from "./dom.js";

const KINDS = [
  { name: "throughput", unit: "kbit/s", place: 2, hint: "measured on each command; dashed: threshold" },
  { name: "SNR", unit: "dB", place: 3, hint: "of the leader's last message" },
  { name: "k_rho", unit: "1/s", place: 4, hint: "gain: how eagerly it drives to its slot" },
  { name: "error", unit: "m", place: 5, hint: "distance to its slot" },
];
const BOTTOM = 14, LEFT = 34;

export class Charts {
  /** seek: called with a time [s] when somebody points at one. */
  constructor(seek) {
    this.samples = [];
    this.robots = [];
    this.period = 0.05;
    this.threshold = 0;
    this.chosen = 0;
    this.isDirty = true;
    this.marks = [];
    this.panels = KINDS.map((kind) => {
      const canvas = el("canvas", { role: "img", "aria-label": `${kind.name} of each robot over time` });
      const cursor = el("div", { class: "cursor" });
      const name = el("b", {}, kind.name), unit = el("span", { class: "quiet" }, kind.unit);
      const title = el("h3", { title: kind.hint }, name, " ", unit);
      canvas.addEventListener("pointerdown", (event) => seek(this.timeAt(canvas, event)));
      return { kind, canvas, cursor, name, unit, element: el("div", { class: "chart" }, title, canvas, cursor) };
    });
    this.element = el("div", { class: "charts" }, ...this.panels.map((panel) => panel.element));
  }

  get end() {
    return this.samples.length ? Math.max(10, this.samples[this.samples.length - 1][0] * this.period) : 10;
  }

  /** Chart what programs show of themselves instead of what a team does. */
  rename(names) {
    this.panels.forEach((panel, number) => {
      panel.kind = { name: names[number] || "", unit: "", place: KINDS[number].place };
      put(panel.name, panel.kind.name);
      put(panel.unit, "");
      panel.name.parentElement.title = "";
      panel.element.hidden = !names[number];
    });
    this.isDirty = true;
  }

  timeAt(canvas, event) {
    const box = canvas.getBoundingClientRect();
    const part = (event.clientX - box.left - LEFT) / Math.max(1, box.width - LEFT - 4);
    return Math.min(1, Math.max(0, part)) * this.end;
  }

  add(samples) {
    for (const sample of samples) this.samples.push(sample);
    this.isDirty = true;
  }

  /** now: the time that is shown [s]. */
  draw(now) {
    for (const panel of this.panels) if (fit(panel.canvas)) this.isDirty = true;
    if (this.isDirty) {
      const palette = colours();
      for (const panel of this.panels) this.drawOne(panel, palette);
      this.isDirty = false;
    }
    for (const { canvas, cursor } of this.panels) {
      const at = LEFT + (Math.min(now, this.end) / this.end) * (sizeOf(canvas).width - LEFT - 4);
      cursor.style.transform = `translateX(${at.toFixed(1)}px)`;
    }
  }

  drawOne({ kind, canvas }, palette) {
    const pen = canvas.getContext("2d");
    const { width, height } = sizeOf(canvas);
    const scale = canvas.width / Math.max(1, width);
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    const step = Math.max(1, Math.floor(this.samples.length / Math.max(60, width)));
    let low = Infinity, high = -Infinity;
    for (let row = 0; row < this.samples.length; row += step) {
      for (let place = 1; place < this.samples[row].length; place++) {
        const value = this.samples[row][place]?.[kind.place];
        if (value === null || value === undefined) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    if (kind.name !== "SNR") low = Math.min(low, 0);
    if (!(high > low)) [low, high] = [Math.min(low, 0) || 0, (Number.isFinite(high) ? high : 0) + 1];
    const x = (time) => LEFT + (time / this.end) * (width - LEFT - 4);
    const y = (value) => height - BOTTOM - ((value - low) / (high - low)) * (height - BOTTOM - 6);
    pen.font = "10.5px system-ui, sans-serif";
    pen.fillStyle = palette.quiet;
    pen.textAlign = "right";
    for (const value of [low, high]) pen.fillText(short(value), LEFT - 4, y(value) + (value === high ? 7 : 0));
    pen.textAlign = "left";
    pen.fillText("0", LEFT, height - 3);
    pen.textAlign = "right";
    pen.fillText(seconds(this.end), width - 4, height - 3);
    pen.strokeStyle = palette.line;
    pen.lineWidth = 1;
    line(pen, LEFT, height - BOTTOM + 0.5, width - 4, height - BOTTOM + 0.5);
    pen.globalAlpha = 0.55;
    pen.strokeStyle = palette.bad;
    pen.setLineDash([2, 3]);
    for (const time of this.marks) line(pen, x(time), 4, x(time), height - BOTTOM);
    pen.globalAlpha = 1;
    if (kind.name === "throughput" && this.threshold > 0 && this.threshold / 1e3 < high) {
      pen.strokeStyle = palette.ink;
      pen.setLineDash([5, 4]);
      line(pen, LEFT, y(this.threshold / 1e3), width - 4, y(this.threshold / 1e3));
    }
    pen.setLineDash([]);
    this.robots.forEach((robot, number) => {
      pen.strokeStyle = robot.colour;
      pen.globalAlpha = this.chosen && this.chosen !== robot.id ? 0.22 : 0.95;
      pen.lineWidth = this.chosen === robot.id ? 2 : 1.25;
      this.trace(pen, number + 1, kind.place, step, x, y);
    });
    pen.globalAlpha = 1;
  }

  trace(pen, column, place, step, x, y) {
    pen.beginPath();
    let isDown = false;
    for (let row = 0; row < this.samples.length; row += step) {
      const value = this.samples[row][column]?.[place];
      if (value === null || value === undefined) {
        isDown = false;
        continue;
      }
      const at = x(this.samples[row][0] * this.period);
      if (isDown) pen.lineTo(at, y(value));
      else pen.moveTo(at, y(value));
      isDown = true;
    }
    pen.stroke();
  }
}

function line(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

const short = (value) => (Math.abs(value) >= 100 ? value.toFixed(0) : value.toFixed(1).replace(/\.0$/, ""));
