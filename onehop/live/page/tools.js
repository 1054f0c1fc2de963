// What a pointer on the map does: choose a robot, move the map, or draw a fault.

import { label } from "./robots.js";

const NEAR_PX = 20;

export const TOOLS = {
  choose: "Look",
  kidnap: "Kidnap",
  cut: "Cut",
  jam: "Jam",
};

export const HINTS = {
  choose: "",
  kidnap: "Drag a robot to where it is to be.",
  cut: "Draw a line: no message passes from one side of it to the other.",
  jam: "Draw a disc of noise: press in its middle and pull.",
};

export class Tools {
  /** view: has camera, places, chosen; choose(id), order(fault), tell(text, isBad). */
  constructor(canvas, view) {
    this.canvas = canvas;
    this.view = view;
    this.tool = "choose";
    this.duration = 0;
    this.drag = null;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", () => (this.drag = null));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  pick(tool) {
    this.tool = tool;
    this.drag = null;
    this.canvas.style.cursor = tool === "choose" ? "default" : "crosshair";
  }

  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  robotAt(px, py) {
    let nearest = 0, least = NEAR_PX;
    for (const [id, at] of this.view.places) {
      const [x, y] = this.view.camera.toScreen(at.x, at.y);
      const away = Math.hypot(x - px, y - py);
      if (away < least) [nearest, least] = [id, away];
    }
    return nearest;
  }

  down(event) {
    const [px, py] = this.place(event);
    const robot = this.robotAt(px, py);
    this.canvas.setPointerCapture(event.pointerId);
    this.drag = { from: [px, py], to: [px, py], robot, moved: false };
    if (this.tool === "kidnap" && !robot) {
      this.drag = null;
      this.view.tell("Begin on a robot.", true);
    }
  }

  move(event) {
    if (!this.drag) return;
    const [px, py] = this.place(event);
    const [bx, by] = this.drag.to;
    this.drag.to = [px, py];
    this.drag.moved ||= Math.hypot(px - this.drag.from[0], py - this.drag.from[1]) > 4;
    if (this.tool === "choose" && this.drag.moved) this.view.camera.pan(px - bx, py - by);
  }

  up() {
    const drag = this.drag;
    this.drag = null;
    if (!drag) return;
    if (this.tool === "choose") {
      if (!drag.moved) this.view.choose(drag.robot);
    } else if (drag.moved) this.finish(drag);
  }

  wheel(event) {
    event.preventDefault();
    this.view.camera.zoom(Math.exp(-event.deltaY * 0.0015), ...this.place(event));
  }

  finish(drag) {
    const { camera } = this.view;
    const from = camera.toGround(...drag.from), to = camera.toGround(...drag.to);
    const lasting = this.duration > 0 ? { duration_s: this.duration } : {};
    if (this.tool === "kidnap") {
      this.view.order({ kind: "kidnap", robots: [drag.robot], x: tenth(to[0]), y: tenth(to[1]) });
    } else if (this.tool === "jam") {
      const radius = tenth(Math.hypot(to[0] - from[0], to[1] - from[1]));
      this.view.order({ kind: "jam", x: tenth(from[0]), y: tenth(from[1]), radius, ...lasting });
    } else {
      const [robots, others] = this.sides(from, to);
      if (!robots.length || !others.length) this.view.tell("All robots are on one side of the line.", true);
      else this.view.order({ kind: "cut", robots, others, ...lasting });
    }
    this.pick("choose");
    this.view.onTool();
  }

  /** Robots on either side of a line. */
  sides([x0, y0], [x1, y1]) {
    const sides = [[], []];
    for (const [id, at] of this.view.places) {
      sides[(x1 - x0) * (at.y - y0) - (y1 - y0) * (at.x - x0) > 0 ? 0 : 1].push(id);
    }
    return sides.map((ids) => ids.sort((a, b) => a - b));
  }

  /** What is being drawn. */
  draw(pen, palette) {
    const drag = this.drag;
    if (!drag || !drag.moved || this.tool === "choose") return;
    const [x0, y0] = drag.from, [x1, y1] = drag.to;
    pen.strokeStyle = pen.fillStyle = palette.bad;
    pen.lineWidth = 2.5;
    pen.setLineDash([7, 4]);
    pen.beginPath();
    if (this.tool === "jam") pen.arc(x0, y0, Math.hypot(x1 - x0, y1 - y0), 0, 7);
    else {
      const far = this.tool === "cut" ? 4000 / (Math.hypot(x1 - x0, y1 - y0) || 1) : 0;
      pen.moveTo(x0 - (x1 - x0) * far, y0 - (y1 - y0) * far);
      pen.lineTo(x1 + (x1 - x0) * far, y1 + (y1 - y0) * far);
    }
    pen.stroke();
    pen.setLineDash([]);
    const { camera } = this.view;
    const ground = camera.toGround(x1, y1);
    const from = camera.toGround(x0, y0);
    const [one, other] = this.tool === "cut" ? this.sides(from, ground) : [[], []];
    const text = {
      kidnap: `robot ${drag.robot} to (${tenth(ground[0])}, ${tenth(ground[1])})`,
      jam: `${tenth(Math.hypot(ground[0] - from[0], ground[1] - from[1]))} m`,
      cut: `${one.join(" ") || "nobody"} from ${other.join(" ") || "nobody"}`,
    }[this.tool];
    label(pen, text, x1, y1 - 12, palette);
  }
}

const tenth = (value) => Math.round(10 * value) / 10;
