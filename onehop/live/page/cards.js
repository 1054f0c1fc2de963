// One card a robot: what it is, how its link is, and the buttons that do something to it.

import { el, put } from "./dom.js";

const MANY = 12;

export class Cards {
  /** choose: called with a robot's id. order: with a fault. */
  constructor(choose, order) {
    this.choose = choose;
    this.order = order;
    this.cards = new Map();
    this.element = el("div", { class: "cards", role: "group", "aria-label": "Robots" });
  }

  get areMany() {
    return this.cards.size > MANY;
  }

  begin(robots) {
    this.cards.clear();
    this.element.replaceChildren();
    for (const robot of robots) this.cards.set(robot.id, this.makeCard(robot));
  }

  makeCard(robot) {
    const number = el("b", {}, String(robot.id));
    const role = el("span", { class: "mode" });
    const badge = el("span", { class: "badge" });
    const meter = el("meter", { min: 0, max: 1, "aria-label": `throughput of robot ${robot.id}` });
    const facts = {
      link: el("span", { title: "throughput that its last command measured" }),
      gain: el("span", { title: "gain: how eagerly it drives to its slot [1/s]" }),
      error: el("span", { title: "distance to its slot; of a leader to the goal" }),
    };
    const hands = ["kill", "stop", "hold", "restart"].map((kind) => {
      const button = el("button", { type: "button" }, kind);
      button.addEventListener("click", (event) => {
        event.stopPropagation();
        const asked = button.textContent;
        this.order(asked === "heal" ? { kind: "heal", robots: [robot.id] } : { kind: asked, robots: [robot.id] });
      });
      return button;
    });
    const card = el(
      "div",
      { class: "card", tabindex: 0, role: "button", "aria-label": `robot ${robot.id}` },
      el("div", { class: "head" }, number, role, badge),
      meter,
      el("div", { class: "facts" }, facts.link, facts.gain, facts.error),
      el("div", { class: "hands" }, ...hands),
    );
    card.style.setProperty("--own", robot.colour);
    card.addEventListener("click", () => this.choose(robot.id));
    card.addEventListener("keydown", (event) => {
      if (event.target === card && event.key === "Enter") this.choose(robot.id);
    });
    this.element.append(card);
    return { card, role, badge, meter, facts, hands };
  }

  /** frame: that is shown. may: whether its buttons do anything. */
  show(frame, chosen, may, isLog) {
    const present = new Map(frame.robots.map((robot) => [robot.id, robot]));
    const gone = new Map(frame.gone.map((robot) => [robot.id, robot]));
    for (const [id, card] of this.cards) {
      const robot = present.get(id);
      card.card.classList.toggle("chosen", id === chosen);
      card.card.setAttribute("aria-pressed", String(id === chosen));
      card.card.classList.toggle("gone", !robot);
      card.hands[0].parentElement.hidden = isLog;
      if (robot) this.showPresent(card, robot);
      else this.showGone(card, gone.get(id));
      this.showHands(card, robot, gone.has(id), may);
    }
  }

  showPresent(card, robot) {
    const status = robot.status;
    const leads = status && status.leader === robot.id;
    let role = status ? status.mode : "no team";
    if (leads) role = `\u2605 leader, epoch ${status.epoch}`;
    else if (status && status.leader) role = `${status.mode} (leader ${status.leader})`;
    put(card.role, role);
    card.role.title = role;
    put(card.badge, robot.state.join(", "));
    card.card.setAttribute("aria-description", `at ${robot.x.toFixed(1)}, ${robot.y.toFixed(1)} m`);
    const follows = status && !leads && status.throughput !== null && status.throughput >= 0;
    card.meter.style.visibility = follows ? "visible" : "hidden";
    if (follows) {
      const full = Math.max(1, 1.6 * status.threshold);
      card.meter.low = status.threshold / full;
      card.meter.high = status.threshold / full;
      card.meter.optimum = 1;
      card.meter.value = Math.min(1, status.throughput / full);
      put(card.facts.link, `${(status.throughput / 1e6).toFixed(2)} Mb/s`);
      card.facts.link.className = status.throughput < status.threshold ? "weak" : "";
      put(card.facts.gain, `k\u03c1 ${status.k_rho?.toFixed(1)}`);
      put(card.facts.error, `${status.error?.toFixed(1)} m`);
      return;
    }
    const values = Object.entries(robot.values || {}).slice(0, 2);
    put(card.facts.link, leads ? status.shape : values[0] ? named(values[0]) : "");
    put(card.facts.gain, leads ? "" : values[1] ? named(values[1]) : "");
    put(card.facts.error, leads && status.error !== null ? `${status.error.toFixed(0)} m to go` : "");
    card.facts.link.className = "";
  }

  showGone(card, gone) {
    put(card.role, gone ? `gone: ${gone.why}` : "not there yet");
    card.role.title = card.role.textContent;
    put(card.badge, "");
    card.meter.style.visibility = "hidden";
    for (const fact of Object.values(card.facts)) put(fact, "");
  }

  showHands(card, robot, isGone, may) {
    const [kill, stop, hold, restart] = card.hands;
    const stopped = robot?.state.includes("stopped"), held = robot?.state.includes("held");
    put(stop, stopped ? "continue" : "stop");
    put(hold, held ? "heal" : "hold");
    for (const button of [kill, stop]) button.disabled = !may || !robot;
    hold.disabled = !may || !(robot || isGone);
    restart.disabled = !may || !(robot || isGone);
  }
}

const named = ([name, value]) => `${name} ${value === null ? "-" : value.toFixed(1)}`;
