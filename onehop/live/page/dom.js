// Elements made by hand: whatever comes from a mission goes in as text, never as markup.

/** An element with attributes and children; a string among the children is text. */
export function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "class") made.className = value;
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

export const byId = (id) => document.getElementById(id);

/** Set a text only when it differs: readers of screens are told of every change. */
export function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** The page's colours, as the style sheet has them for light or dark. */
export function colours() {
  const style = getComputedStyle(document.documentElement);
  const names = ["paper", "panel", "ink", "quiet", "line", "ground", "wall", "wall-edge", "good", "fair", "bad", "accent", "goal"];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

const sizes = new WeakMap();
const observer = new ResizeObserver((entries) => {
  for (const { target, contentRect } of entries) sizes.set(target, contentRect);
});

/** Width and height of a canvas on the screen [px], without asking for a layout at every picture. */
export function sizeOf(canvas) {
  if (!sizes.has(canvas)) {
    sizes.set(canvas, { width: canvas.clientWidth, height: canvas.clientHeight });
    observer.observe(canvas);
  }
  return sizes.get(canvas);
}

/** Fit a canvas to its place on the screen; whether its size has changed. */
export function fit(canvas) {
  const scale = Math.min(2, window.devicePixelRatio || 1);
  const size = sizeOf(canvas);
  const width = Math.max(1, Math.round(size.width * scale));
  const height = Math.max(1, Math.round(size.height * scale));
  if (canvas.width === width && canvas.height === height) return false;
  canvas.width = width;
  canvas.height = height;
  return true;
}

export const seconds = (time) => `${time.toFixed(1)} s`;
