// What leaders have planned: road map and way. The server executes a leader again for it, so it is asked for only
// while it is shown, and not more often than people look.

const ASK_MS = 400, MOST_LEADERS = 4;

export class Plans {
  /** ask: sends a request, and says whether the line is there. */
  constructor(ask) {
    this.ask = ask;
    this.begin();
  }

  /** Nothing is known, and nothing is on its way. */
  begin() {
    this.known = new Map();
    this.asked = new Map();
    this.isWaiting = false;
    this.due = 0;
  }

  /** Ask for what one of these robots had planned by a tick: the one that was asked for longest ago. */
  want(leaders, tick, now) {
    if (this.isWaiting || now < this.due) return;
    const news = leaders.slice(0, MOST_LEADERS).filter((id) => this.asked.get(id)?.tick !== tick);
    const next = news.sort((a, b) => (this.asked.get(a)?.at ?? 0) - (this.asked.get(b)?.at ?? 0))[0];
    if (next === undefined) return;
    this.isWaiting = this.ask({ kind: "road map", robot: next, tick });
    this.asked.set(next, { tick, at: now });
    this.due = now + ASK_MS;
  }

  take(message) {
    this.isWaiting = false;
    if (message.at === undefined) this.known.delete(message.robot);
    else this.known.set(message.robot, message);
  }

  /** Draw those of the robots that lead at a tick. place: (x, y) [m] -> pixels. */
  draw(pen, leaders, tick, colours, place) {
    for (const id of leaders) {
      const plan = this.known.get(id);
      if (!plan || plan.at > tick) continue;
      pen.strokeStyle = pen.fillStyle = colours.get(id);
      pen.lineWidth = 0.8;
      pen.globalAlpha = 0.4;
      pen.beginPath();
      for (const [x0, y0, x1, y1] of plan.edges) {
        pen.moveTo(...place(x0 / 100, y0 / 100));
        pen.lineTo(...place(x1 / 100, y1 / 100));
      }
      pen.stroke();
      pen.globalAlpha = 0.7;
      for (const [x, y] of plan.points) pen.fillRect(...place(x / 100, y / 100).map((one) => one - 1), 2, 2);
      pen.globalAlpha = 1;
      pen.lineWidth = 3.2;
      pen.beginPath();
      for (const [x, y] of plan.way) pen.lineTo(...place(x / 100, y / 100));
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }
}
