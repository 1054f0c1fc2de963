// The line to the server: asks for a frame, and asks again when the one before is there. So a slow page gets
// fewer frames, and nobody waits for it. Comes back by itself when the line is lost.

const AGAIN_MS = [300, 1000, 2000, 4000];

export class Feed {
  /** number: of the log. heard: takes every message. lost: told whether the line is there. */
  constructor(number, heard, lost) {
    this.number = number;
    this.heard = heard;
    this.lost = lost;
    this.tries = 0;
    this.asked = false;
    this.open();
  }

  open() {
    const token = new URLSearchParams(location.search).get("token") || "";
    const line = new WebSocket(`ws://${location.host}/feed/${this.number}?token=${encodeURIComponent(token)}`);
    this.line = line;
    this.asked = false;
    line.onmessage = (event) => {
      const message = JSON.parse(event.data);
      if (message.kind === "hello") {
        this.tries = 0;
        this.lost(false);
      }
      if (message.kind === "news") this.asked = false;
      this.heard(message);
    };
    line.onclose = () => {
      this.lost(true);
      setTimeout(() => this.open(), AGAIN_MS[Math.min(this.tries++, AGAIN_MS.length - 1)]);
    };
  }

  /**
   * Ask for a frame unless one has been asked for. tick: -1 for the newest.
   * What was asked for and comes only when there is something new gives way to another moment.
   */
  want(tick, since, robot) {
    const waits = this.askedTick === -1 || this.askedTick === this.askedSince;
    if (this.asked && !(waits && tick !== this.askedTick)) return;
    this.asked = this.say({ kind: "want", tick, since, robot });
    this.askedTick = tick;
    this.askedSince = since;
  }

  say(request) {
    if (this.line.readyState !== WebSocket.OPEN) return false;
    this.line.send(JSON.stringify(request));
    return true;
  }
}
