// How to run this mission again with all that was done to it, and a fault by its numbers instead of by hand.

import { el, put } from "./dom.js";

const KEYS = {
  kill: ["robots"],
  stop: ["robots", "duration_s"],
  continue: ["robots"],
  restart: ["robots"],
  hold: ["robots", "duration_s"],
  kidnap: ["robots", "x", "y", "heading_deg"],
  blind: ["robots", "duration_s"],
  slow: ["robots", "delay_ticks", "duration_s"],
  cut: ["robots", "others", "duration_s"],
  corrupt: ["robots", "probability", "duration_s"],
  jam: ["x", "y", "radius", "noise_dbm", "duration_s"],
  heal: ["robots"],
};
const NAMES = {
  robots: "robots (3 or 1,4)", others: "from robots", duration_s: "for s", x: "x m", y: "y m", heading_deg: "heading \u00b0",
  delay_ticks: "ticks late", probability: "share", radius: "radius m", noise_dbm: "noise dBm",
};

export class Again {
  /** order: called with a fault. tell: with words. */
  constructor(order, tell) {
    this.text = el("textarea", { readonly: true, "aria-label": "Command that runs this mission again", spellcheck: "false" });
    this.summary = el("summary", {}, "Run it again");
    this.copy = el("button", { type: "button" }, "Copy");
    this.lines = el("button", { type: "button" }, "Copy as lines for a scenario");
    this.news = { command: "", lines: "", faults: 0 };
    this.copy.addEventListener("click", () => copied(this.text.value, this.text, tell));
    this.lines.addEventListener("click", () => copied(this.news.lines, this.text, tell));
    this.element = el("details", { class: "again" }, this.summary, this.text,
      el("div", { class: "row" }, this.copy, this.lines));
    this.numbers = numbersForm(order, tell);
  }

  show(news) {
    this.news = news;
    const count = news.faults ? ` with its ${news.faults} fault${news.faults > 1 ? "s" : ""}` : "";
    put(this.summary, `Run it again${count}`);
    this.text.value = news.command || news.lines || "No faults: the scenario as it is.";
    this.lines.hidden = !news.lines || !news.command;
  }
}

async function copied(text, area, tell) {
  try {
    await navigator.clipboard.writeText(text);
    tell("Copied.");
  } catch {
    area.value = text; // without a secure context there is no clipboard: then it is at least marked
    area.select();
    tell("Press Ctrl-C to copy it.");
  }
}

function numbersForm(order, tell) {
  const kind = el("select", { "aria-label": "Kind of fault" }, ...Object.keys(KEYS).map((one) => el("option", {}, one)));
  const fields = new Map(Object.entries(NAMES).map(([key, name]) => {
    const input = el("input", { inputmode: key === "robots" || key === "others" ? "text" : "decimal" });
    return [key, { input, label: el("label", {}, name, input) }];
  }));
  const button = el("button", { type: "submit" }, "Do it");
  const form = el("form", { class: "numbers" }, kind, ...[...fields.values()].map(({ label }) => label), button);
  const settle = () => fields.forEach(({ label }, key) => (label.hidden = !KEYS[kind.value].includes(key)));
  kind.addEventListener("change", settle);
  settle();
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const fault = { kind: kind.value };
    for (const key of KEYS[kind.value]) {
      const text = fields.get(key).input.value.trim();
      if (!text) continue;
      const numbers = text.split(/[\s,]+/).map(Number);
      if (numbers.some(Number.isNaN)) return tell(`${NAMES[key]}: ${text} is no number`, true);
      fault[key] = key === "robots" || key === "others" ? numbers : numbers[0];
    }
    return order(fault);
  });
  const element = el("details", { class: "again" }, el("summary", {}, "A fault by its numbers"), form);
  element.setEnabled = (may) => (button.disabled = !may);
  return element;
}
