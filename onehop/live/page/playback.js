// The time that is shown: the newest moment of a mission, or any moment of a log, played at any speed.

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50];
const OF_A_LOG = SPEEDS.indexOf(5);

export class Playback {
  constructor() {
    this.isNow = false;
    this.time = 0;
    this.isPlaying = true;
    this.speed = OF_A_LOG;
    this.last = performance.now();
  }

  get factor() {
    return SPEEDS[this.speed];
  }

  /** One picture later. end: of what is there [s]. */
  advance(now, end) {
    const passed = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    if (this.isNow || !this.isPlaying) return;
    this.time = Math.min(end, this.time + passed * this.factor);
  }

  /** Begin at a moment, and stay there. */
  open(time) {
    this.isNow = this.isPlaying = false;
    this.time = time;
  }

  seek(time, end) {
    this.isNow = false;
    this.time = Math.min(end, Math.max(0, time));
  }

  change(by) {
    this.speed = Math.min(SPEEDS.length - 1, Math.max(0, this.speed + by));
  }
}
