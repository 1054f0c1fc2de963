// What has happened, in the words of the report. Each line leads to the moment, and to why.

import { el, seconds } from "./dom.js";

const FRESH_MS = 6000;

export class Events {
  /** go: called with the event that somebody points at. */
  constructor(go) {
    this.go = go;
    this.events = [];
    this.first = null;
    this.rows = [];
    this.element = el("ol", { class: "events", "aria-label": "What has happened", tabindex: 0 });
  }

  /** From an event on, these are the events. */
  take({ from, events }) {
    const isNew = this.events.length > 0;
    this.events = this.events.slice(0, from).concat(
      events.map(([at, weight, text, robot]) => ({ at, weight, text, robot })),
    );
    this.fill(isNew ? from : Infinity, this.first ? 0 : from);
  }

  /** Everything comes again. */
  clear() {
    this.events = [];
    this.fill(Infinity);
  }

  /** Mark a moment that is no event of the mission. */
  mark(event) {
    this.first = event;
    this.fill(Infinity);
  }

  /** Rows before `kept` stay as they are: a team in trouble has hundreds. */
  fill(freshFrom, kept = 0) {
    const isAtEnd = this.element.scrollTop + this.element.clientHeight > this.element.scrollHeight - 30;
    const told = [...this.events];
    if (this.first) told.splice(told.filter((event) => event.at <= this.first.at).length, 0, this.first);
    const rows = told.slice(kept).map((event, place) => {
      const number = kept + place;
      const button = el(
        "button",
        { type: "button", class: `w${event.weight}${event === this.first ? " first" : ""}`, onclick: () => this.go(event) },
        el("time", {}, seconds(event.at)),
        el("span", {}, event.text),
      );
      if (number >= freshFrom) {
        button.classList.add("fresh");
        setTimeout(() => button.classList.remove("fresh"), FRESH_MS);
      }
      return { event, button };
    });
    for (const { button } of this.rows.slice(kept)) button.parentElement.remove();
    this.rows = this.rows.slice(0, kept).concat(rows);
    this.element.append(...rows.map(({ button }) => el("li", {}, button)));
    if (isAtEnd) this.element.scrollTop = this.element.scrollHeight;
    this.shown = -1;
  }

  /** now: the time that is shown [s]; what is later is faint. */
  show(now) {
    const before = this.rows.filter(({ event }) => event.at <= now + 1e-6).length;
    if (before === this.shown) return;
    this.rows.forEach(({ button }, number) => {
      const isLater = number >= before;
      if (button.classList.contains("later") !== isLater) button.classList.toggle("later", isLater);
    });
    this.shown = before;
    const row = this.rows[before - 1]?.button.parentElement;
    if (row && before < this.rows.length) this.element.scrollTop = row.offsetTop - this.element.clientHeight / 2;
    else this.element.scrollTop = this.element.scrollHeight;
  }
}
