// Which part of the ground is on the screen: the whole map, the team wherever it is, or where a hand put it.

const LEAST_SPAN = 26, MARGIN = 1.5, CALM = 0.12;

export class Camera {
  constructor() {
    this.mode = "map";
    this.bounds = [0, 0, 1, 1];
    this.x = this.y = 0.5;
    this.scale = 1;
    this.width = this.height = 1;
  }

  begin(bounds) {
    this.bounds = bounds;
    const [x0, y0, x1, y1] = bounds;
    this.mode = Math.max(x1 - x0, y1 - y0) > 2 * LEAST_SPAN ? "team" : "map";
    this.isNew = true;
  }

  /** robots: places to keep in sight. width, height: of the screen [px]. */
  follow(robots, width, height) {
    this.width = width;
    this.height = height;
    const aim = this.mode === "free" ? null : this.aim(robots);
    if (!aim) return;
    const calm = this.isNew ? 1 : CALM;
    this.isNew = false;
    this.x += (aim.x - this.x) * calm;
    this.y += (aim.y - this.y) * calm;
    this.scale *= (aim.scale / this.scale) ** calm;
  }

  aim(robots) {
    let [x0, y0, x1, y1] = this.bounds;
    let least = 0, margin = 1.04;
    if (this.mode === "team" && robots.length) {
      const xs = robots.map((robot) => robot.x), ys = robots.map((robot) => robot.y);
      [x0, y0, x1, y1] = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
      least = LEAST_SPAN;
      margin = MARGIN;
    }
    const wide = Math.max(least, (x1 - x0) * margin), high = Math.max(least, (y1 - y0) * margin);
    return { x: (x0 + x1) / 2, y: (y0 + y1) / 2, scale: Math.min(this.width / wide, this.height / high) };
  }

  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  toGround(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }

  pan(dx, dy) {
    this.mode = "free";
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  zoom(factor, px, py) {
    const [x, y] = this.toGround(px, py);
    this.mode = "free";
    this.scale = Math.min(200, Math.max(0.2, this.scale * factor));
    const [nx, ny] = this.toGround(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
}
