// The map, drawn once into a picture of its own for each place of the camera, and as a small overview.

/** What a map file fills, as a small picture; null for a map of polygons. */
export function filledPicture(filled, colour) {
  if (!filled) return null;
  const canvas = document.createElement("canvas");
  canvas.width = filled.columns;
  canvas.height = filled.rows;
  const pen = canvas.getContext("2d");
  pen.fillStyle = colour;
  const bytes = Uint8Array.from(atob(filled.bits), (one) => one.charCodeAt(0));
  const stride = Math.ceil(filled.columns / 8);
  for (let row = 0; row < filled.rows; row++) {
    for (let column = 0; column < filled.columns; column++) {
      if (bytes[row * stride + (column >> 3)] & (128 >> (column & 7))) {
        pen.fillRect(column, filled.rows - 1 - row, 1, 1);
      }
    }
  }
  return canvas;
}

/** Draw walls and goal. place: (x, y) [m] -> pixels; scale: pixels a metre. */
export function drawGround(pen, setting, picture, place, scale, palette) {
  pen.fillStyle = palette.wall;
  if (picture) {
    const { cell, columns, rows } = setting.filled;
    const [left, top] = place(setting.bounds[0], setting.bounds[1] + rows * cell);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(picture, left, top, columns * cell * scale, rows * cell * scale);
  }
  for (const polygon of setting.obstacles) {
    pen.beginPath();
    for (const [x, y] of polygon) pen.lineTo(...place(x, y));
    pen.closePath();
    pen.fill();
  }
  pen.strokeStyle = palette["wall-edge"];
  pen.lineWidth = 1.2;
  pen.beginPath();
  for (const [x0, y0, x1, y1] of setting.walls) {
    pen.moveTo(...place(x0, y0));
    pen.lineTo(...place(x1, y1));
  }
  pen.stroke();
  drawGoal(pen, setting.goal, place, scale, palette);
}

function drawGoal(pen, goal, place, scale, palette) {
  const [x, y] = place(goal.x, goal.y);
  pen.strokeStyle = palette.ink;
  pen.fillStyle = palette.goal;
  pen.lineWidth = 1.2;
  pen.beginPath();
  pen.arc(x, y, Math.max(2, goal.tolerance * scale), 0, 7);
  pen.stroke();
  const size = Math.min(13, Math.max(5, 2.2 * scale));
  pen.beginPath();
  for (let tip = 0; tip < 10; tip++) {
    const radius = tip % 2 ? size * 0.45 : size, angle = (tip * Math.PI) / 5 - Math.PI / 2;
    pen.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
  }
  pen.closePath();
  pen.fill();
  pen.stroke();
}
