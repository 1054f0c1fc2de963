// One log on the page: its map, robots, charts and events, drawn from what the server sends.

import { Again } from "./again.js";
import { Camera } from "./camera.js";
import { Cards } from "./cards.js";
import { Charts } from "./charts.js";
import { colours, el, fit, put, sizeOf } from "./dom.js";
import { Events } from "./events.js";
import { Feed } from "./feed.js";
import { drawGround, filledPicture } from "./ground.js";
import { Plans } from "./plans.js";
import { drawTeam, fresh, leads } from "./robots.js";
import { HINTS, TOOLS, Tools } from "./tools.js";

const CARDS_MS = 200, JUMP_M = 5;

export class View {
  /** page: {seek(time), explain(view, event), tell(text, isBad), changed(view)}. */
  constructor(number, page) {
    this.number = number;
    this.page = page;
    this.setting = this.frame = this.before = this.hand = null;
    this.state = { state: "starting", last_tick: -1, words: "", reading: 1 };
    this.places = new Map();
    this.flashes = [];
    this.chosen = 0;
    this.logs = 0;
    this.isFresh = this.isLost = false;
    this.difference = undefined;
    this.orders = 0;
    this.arrival = this.interval = this.cardsDue = 0;
    this.camera = new Camera();
    this.cards = new Cards((id) => this.choose(id === this.chosen ? 0 : id), (fault) => this.order(fault));
    this.charts = new Charts((time) => page.seek(time));
    this.events = new Events((event) => page.explain(this, event));
    this.again = new Again((fault) => this.order(fault), (text, isBad) => page.tell(text, isBad));
    this.plans = new Plans((request) => this.feed.say(request));
    this.plansWanted = null;
    this.build();
    this.tools = new Tools(this.canvas, this);
    this.feed = new Feed(number, (message) => this.take(message), (isLost) => page.lost(this, isLost));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.repaint());
    this.repaint();
  }

  build() {
    this.title = el("div", { class: "view-title", hidden: true });
    this.now = el("p", { class: "now", "aria-live": "off" });
    this.canvas = el("canvas", { tabindex: 0, role: "img", "aria-label": "Map with the robots" });
    this.hint = el("div", { class: "hint", hidden: true });
    this.toolButtons = new Map(Object.entries(TOOLS).map(([tool, name]) => [
      tool, el("button", { type: "button", "aria-pressed": "false", onclick: () => this.pick(tool) }, name),
    ]));
    const healing = el("button", { type: "button", title: "End every fault that lasts", onclick: () => this.order({ kind: "heal" }) }, "Heal all");
    const lasting = el("input", { type: "number", min: 0, step: 1, placeholder: "always", "aria-label": "How long stop, hold, cut and jam last, seconds" });
    lasting.addEventListener("input", () => (this.tools.duration = Number(lasting.value) || 0));
    this.handTools = [...[...this.toolButtons.values()].slice(1), healing];
    this.lastingLabel = el("label", { title: "How long cut, jam, stop and hold last; empty: until healed" }, "for", lasting, "s");
    const camera = (mode, name) => el("button", { type: "button", onclick: () => (this.camera.mode = mode) }, name);
    this.cameras = new Map([["team", camera("team", "Team")], ["map", camera("map", "Whole map")]]);
    this.planning = el("button", { type: "button", title: "What the leader has planned (M)", onclick: () => this.showPlans(!this.showsPlans) }, "Road map");
    const tools = el("div", { class: "tools", role: "toolbar", "aria-label": "Map" },
      el("span", { class: "cameras" }, ...this.cameras.values(), this.planning),
      ...this.toolButtons.values(), healing, this.lastingLabel);
    this.map = el("div", { class: "map" }, this.canvas, tools, this.hint);
    this.side = el("div", { class: "side" }, this.cards.element, this.events.element,
      el("div", {}, this.again.element, this.again.numbers));
    this.element = el("section", { class: "view", "aria-label": `Mission ${this.number + 1}` }, this.title, this.now,
      el("div", { class: "body" }, this.map, this.side, this.charts.element));
    this.pick("choose");
  }

  repaint() {
    this.palette = colours();
    this.picture = this.setting ? filledPicture(this.setting.filled, this.palette.wall) : null;
    this.charts.isDirty = true;
  }

  /** Whether road maps are shown: unless somebody says otherwise, where no lock-step has to wait for them. */
  get showsPlans() {
    return this.plansWanted ?? !(this.hand && this.hand.holds && this.hand.is_paced);
  }

  showPlans(are) {
    this.plansWanted = are;
    this.cardsDue = 0;
  }

  /** Whether what is done here does something to a mission. */
  get may() {
    return Boolean(this.hand && this.hand.yours && this.hand.holds && this.page.isNow());
  }

  take(message) {
    if (message.kind === "news") this.takeNews(message);
    else if (message.kind === "answer") this.page.tell(message.words, !message.done);
    else if (message.kind === "refused") this.page.tell(message.words, true);
    else if (message.kind === "road map") this.plans.take(message);
    else if (message.kind === "explained") this.page.explained(message);
    else if (message.kind === "hello") this.begin(message);
    this.page.changed(this);
  }

  /** The line is new: everything comes again. */
  begin(hello) {
    this.logs = hello.logs;
    put(this.title, hello.name);
    this.title.hidden = hello.logs < 2;
    this.isFresh = !this.frame;
    this.frame = this.before = null;
    this.plans.begin();
    this.charts.samples = [];
    this.charts.isDirty = true;
    this.events.clear();
  }

  takeNews(news) {
    if (news.setting) {
      this.setting = news.setting;
      this.period = news.setting.period_s;
      this.camera.begin(news.setting.bounds);
      this.cards.begin(news.setting.robots);
      this.charts.robots = news.setting.robots;
      this.colours = new Map(news.setting.robots.map((robot) => [robot.id, robot.colour]));
      this.charts.period = this.period;
      this.element.classList.toggle("many", this.cards.areMany);
      this.repaint();
    }
    if (news.state) this.state = { ...news.state, told: true };
    if (news.hand) this.hand = news.hand;
    if (news.difference !== undefined) this.difference = news.difference;
    if (news.again) this.again.show(news.again);
    if (news.names) this.charts.rename(news.names);
    if (news.samples) this.charts.add(news.samples);
    if (news.events) {
      this.events.take(news.events);
      this.charts.marks = this.events.events.filter((event) => event.weight > 1).map((event) => event.at);
      this.charts.isDirty = true;
    }
    if (news.frame) this.takeFrame(news.frame);
  }

  takeFrame(frame) {
    const now = performance.now();
    this.interval = Math.min(250, 0.8 * this.interval + 0.2 * (now - this.arrival));
    this.arrival = now;
    const isNext = this.frame && frame.tick > this.frame.tick && (frame.tick - this.frame.tick) * this.period < 2;
    this.before = isNext ? new Map(this.places) : null;
    this.frame = frame;
    for (const [from, to] of frame.lost) this.flashes.push({ from, to, at: now });
    for (const robot of frame.robots) {
      if (robot.status && robot.status.leader !== robot.id) this.charts.threshold = robot.status.threshold;
    }
    put(this.now, frame.now.join(" "));
  }

  choose(id) {
    this.chosen = this.charts.chosen = id;
    this.charts.isDirty = true;
    this.cardsDue = 0;
  }

  pick(tool) {
    this.tools?.pick(tool);
    this.onTool(tool);
  }

  onTool(tool = "choose") {
    for (const [name, button] of this.toolButtons) button.setAttribute("aria-pressed", String(name === tool));
    put(this.hint, HINTS[tool]);
    this.hint.hidden = !HINTS[tool];
  }

  tell(text, isBad) {
    this.page.tell(text, isBad);
  }

  order(fault) {
    if (!this.may) {
      this.page.tell("There is nothing here that it could be done to now.", true);
      return;
    }
    const lasts = ["stop", "hold"].includes(fault.kind) && this.tools.duration > 0 && !fault.duration_s;
    const whole = lasts ? { ...fault, duration_s: this.tools.duration } : fault;
    this.page.tell(`${fault.kind} \u2026`);
    this.feed.say({ kind: "order", number: ++this.orders, fault: whole });
  }

  /** Where each robot is drawn: between its last two places, so that it moves smoothly. */
  movePlaces(now) {
    const part = Math.min(1, (now - this.arrival) / Math.max(16, this.interval));
    const places = new Map();
    for (const robot of this.frame.robots) {
      const from = this.before?.get(robot.id);
      if (!from || Math.hypot(robot.x - from.x, robot.y - from.y) > JUMP_M) {
        places.set(robot.id, robot);
        continue;
      }
      const turn = Math.atan2(Math.sin(robot.heading - from.heading), Math.cos(robot.heading - from.heading));
      places.set(robot.id, {
        id: robot.id,
        x: from.x + (robot.x - from.x) * part,
        y: from.y + (robot.y - from.y) * part,
        heading: from.heading + turn * part,
      });
    }
    this.places = places;
  }

  draw(now) {
    fit(this.canvas);
    const pen = this.canvas.getContext("2d");
    const { width, height } = sizeOf(this.canvas);
    const scale = this.canvas.width / Math.max(1, width);
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    if (!this.setting) return;
    if (this.frame) this.movePlaces(now);
    this.camera.follow([...this.places.values()], width, height);
    const place = (x, y) => this.camera.toScreen(x, y);
    drawGround(pen, this.setting, this.picture, place, this.camera.scale, this.palette);
    if (this.frame) {
      this.flashes = fresh(this.flashes, now);
      if (this.showsPlans) this.drawPlans(pen, place, now);
      drawTeam(pen, {
        frame: this.frame, places: this.places, setting: this.setting, palette: this.palette, place, now,
        scale: this.camera.scale, chosen: this.chosen, flashes: this.flashes, samples: this.charts.samples,
      });
    }
    this.tools.draw(pen, this.palette);
    if (this.camera.mode !== "map") this.drawOverview(pen, width, height);
    this.charts.draw(this.time);
    if (now >= this.cardsDue) this.showRest(now);
  }

  drawPlans(pen, place, now) {
    const leaders = this.frame.robots.filter(leads).map((robot) => robot.id);
    this.plans.want(leaders, this.frame.tick, now);
    this.plans.draw(pen, leaders, this.frame.tick, this.colours, place);
  }

  showRest(now) {
    this.cardsDue = now + CARDS_MS;
    this.planning.setAttribute("aria-pressed", String(this.showsPlans));
    const isLog = !this.hand;
    for (const [mode, button] of this.cameras) button.setAttribute("aria-pressed", String(mode === this.camera.mode));
    for (const button of this.handTools) {
      button.hidden = isLog;
      button.disabled = !this.may;
    }
    this.toolButtons.get("choose").hidden = this.lastingLabel.hidden = this.again.numbers.hidden = isLog;
    this.again.numbers.setEnabled(this.may);
    this.events.show(this.time);
    if (this.frame) this.cards.show(this.frame, this.chosen, this.may, isLog);
  }

  /** The whole ground small in a corner, with what is on the screen as a frame. */
  drawOverview(pen, width, height) {
    const [x0, y0, x1, y1] = this.setting.bounds;
    const wide = x1 - x0, high = y1 - y0;
    const scale = Math.min(150 / wide, 150 / high, (0.34 * height) / high);
    const left = width - wide * scale - 10, top = height - high * scale - 10;
    const place = (x, y) => [left + (x - x0) * scale, top + (y1 - y) * scale];
    pen.save();
    pen.fillStyle = this.palette.panel;
    pen.globalAlpha = 0.94;
    pen.fillRect(left - 4, top - 4, wide * scale + 8, high * scale + 8);
    pen.globalAlpha = 1;
    pen.strokeStyle = this.palette.line;
    pen.strokeRect(left - 4, top - 4, wide * scale + 8, high * scale + 8);
    drawGround(pen, this.setting, this.picture, place, scale, this.palette);
    for (const robot of this.setting.robots) {
      const at = this.places.get(robot.id);
      if (!at) continue;
      pen.fillStyle = robot.colour;
      pen.beginPath();
      pen.arc(...place(at.x, at.y), 2.6, 0, 7);
      pen.fill();
    }
    const [ax, ay] = place(...this.camera.toGround(0, 0));
    const [bx, by] = place(...this.camera.toGround(width, height));
    pen.beginPath();
    pen.rect(left - 3, top - 3, wide * scale + 6, high * scale + 6);
    pen.clip();
    pen.strokeStyle = this.palette.accent;
    pen.lineWidth = 1.5;
    pen.strokeRect(ax, ay, bx - ax, by - ay);
    pen.restore();
  }

  /** The time that is shown [s]. */
  get time() {
    return this.frame ? this.frame.time_s : 0;
  }

  get end() {
    return Math.max(0, this.state.last_tick) * (this.period || 0);
  }
}
