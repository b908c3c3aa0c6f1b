"use strict";
// The drawing is complete as it stands. This lays plots out at the width that there is, so that their text keeps its
// size, and shows other parts of their coordinate; what a panel holds is drawn once and only its viewBox moves.
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const plots = [];

  // Round values within a range, with their texts; the same rule as in the drawing itself.
  function ticks(low, high, count) {
    const extent = high - low;
    if (!(extent > 0) || !isFinite(extent)) return [];
    const rough = extent / Math.max(count, 1);
    const power = 10 ** Math.floor(Math.log10(rough));
    const factor = rough / power;
    const step = power * (factor <= 1 ? 1 : factor <= 2 ? 2 : factor <= 5 ? 5 : 10);
    const decimals = Math.min(12, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
    const found = [];
    for (let k = Math.ceil(low / step); k <= Math.floor(high / step); k++) {
      const value = k * step;
      const plain = decimals > 5 && value !== 0 ? value.toExponential(1).replace("e-", "e−") : value.toFixed(Math.min(decimals, 5));
      const text = plain.replace(/^-(?=[0.]*$)/, "").replace("-", "−");
      found.push([value, text]);
    }
    return found;
  }

  function make(parent, name, attributes, text) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    parent.appendChild(element);
    return element;
  }

  const numbers = (text) => text.split(" ").map(Number);
  const short = (value) => Number(value.toPrecision(4)).toString().replace("-", "−");

  class Plot {
    constructor(svg) {
      this.svg = svg;
      [this.width, this.height] = numbers(svg.dataset.size);
      [this.left, this.right] = numbers(svg.dataset.margin);
      this.drawn = this.width - this.left - this.right;
      this.label = svg.dataset.label;
      this.link = svg.dataset.link;
      this.axes = svg.querySelector(".axes");
      this.cursor = svg.querySelector(".cursor");
      this.readout = svg.parentElement.querySelector(".readout");
      this.panels = [...svg.querySelectorAll(".area")].map((area) => ({
        area, x: numbers(area.dataset.x), y: numbers(area.dataset.y), label: area.dataset.label,
        top: Number(area.getAttribute("y")), height: Number(area.getAttribute("height")),
        shown: numbers(area.dataset.y),
      }));
      this.full = this.panels[0].x;
      this.view = [...this.full];
      svg.classList.add("zoomable");
      svg.setAttribute("tabindex", "0");
      this.listen();
      this.tools();
      this.layout();
    }

    // The lines of a panel as points in units of the data, read from the drawing when first needed.
    lines(panel) {
      panel.lines ??= [...panel.area.querySelectorAll("path.line")].map((path) => {
        const points = [];
        for (const [, x, y] of path.getAttribute("d").matchAll(/[ML](\S+?) ([-\d.]+)/g)) {
          points.push([
            panel.x[0] + (Number(x) / this.drawn) * (panel.x[1] - panel.x[0]),
            panel.y[1] - (Number(y) / panel.height) * (panel.y[1] - panel.y[0]),
          ]);
        }
        return { name: path.dataset.name, points };
      });
      return panel.lines;
    }

    get areaWidth() { return this.width - this.left - this.right; }

    layout() {
      const width = this.svg.clientWidth;
      if (width > 0) this.width = width;
      this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
      for (const panel of this.panels) panel.area.setAttribute("width", this.areaWidth);
      this.show(this.view);
    }

    show(view) {
      this.view = view;
      const whole = view[0] === this.full[0] && view[1] === this.full[1];
      const scale = this.drawn / (this.full[1] - this.full[0]);
      this.axes.replaceChildren();
      this.panels.forEach((panel, k) => {
        panel.shown = whole ? [...panel.y] : this.fitted(panel, view);
        const perUnit = panel.height / (panel.y[1] - panel.y[0]);
        const box = [
          (view[0] - this.full[0]) * scale, (panel.y[1] - panel.shown[1]) * perUnit,
          (view[1] - view[0]) * scale, (panel.shown[1] - panel.shown[0]) * perUnit,
        ];
        panel.area.setAttribute("viewBox", box.join(" "));
        this.drawAxes(panel, k + 1 === this.panels.length);
      });
    }

    // The vertical range of what a view shows of the lines; panels of points keep theirs.
    fitted(panel, view) {
      let low = Infinity, high = -Infinity;
      for (const { points } of this.lines(panel)) {
        for (const [x, y] of points) {
          if (x >= view[0] && x <= view[1]) { low = Math.min(low, y); high = Math.max(high, y); }
        }
      }
      if (!(high > low)) return [...panel.y];
      const room = 0.06 * (high - low);
      return [low - room, high + room];
    }

    drawAxes(panel, last) {
      const { top, height, shown } = panel, bottom = top + height, right = this.left + this.areaWidth;
      for (const [value, text] of ticks(shown[0], shown[1], Math.floor(height / 22))) {
        const y = bottom - ((value - shown[0]) / (shown[1] - shown[0])) * height;
        make(this.axes, "path", { class: Math.abs(value) < 1e-300 ? "zero" : "grid", d: `M${this.left} ${y}H${right}` });
        make(this.axes, "text", { x: this.left - 6, y: y + 4, "text-anchor": "end", class: "tick" }, text);
      }
      for (const [value, text] of ticks(this.view[0], this.view[1], Math.floor(this.areaWidth / 56))) {
        const x = this.left + ((value - this.view[0]) / (this.view[1] - this.view[0])) * this.areaWidth;
        make(this.axes, "path", { class: "grid", d: `M${x} ${top}V${bottom}` });
        if (last) make(this.axes, "text", { x, y: bottom + 16, "text-anchor": "middle", class: "tick" }, text);
      }
      make(this.axes, "text", { x: 4, y: top - 7, class: "axis" }, panel.label);
      if (last) make(this.axes, "text", { x: right, y: bottom + 32, "text-anchor": "end", class: "axis" }, this.label);
      make(this.axes, "rect", { class: "frame", x: this.left, y: top, width: this.areaWidth, height });
    }

    // Shows a part of the coordinate here and in all plots that are linked.
    zoom(low, high) {
      const extent = this.full[1] - this.full[0];
      let width = Math.min(Math.max(high - low, extent * 1e-3), extent);
      const begin = Math.min(Math.max(low, this.full[0]), this.full[1] - width);
      const view = width === extent ? [...this.full] : [begin, begin + width];
      for (const plot of plots) {
        if (plot !== this && (this.link === undefined || plot.link !== this.link)) continue;
        const clipped = [Math.max(view[0], plot.full[0]), Math.min(view[1], plot.full[1])];
        plot.show(clipped[1] > clipped[0] ? clipped : [...plot.full]);
      }
    }

    scaled(factor, about) {
      const centre = about ?? 0.5 * (this.view[0] + this.view[1]);
      this.zoom(centre + (this.view[0] - centre) * factor, centre + (this.view[1] - centre) * factor);
    }

    moved(share) {
      const by = share * (this.view[1] - this.view[0]);
      this.zoom(this.view[0] + by, this.view[1] + by);
    }

    tools() {
      const caption = this.svg.parentElement.querySelector("figcaption");
      const tools = document.createElement("span");
      tools.className = "tools";
      const buttons = [
        ["+", "zoom in", () => this.scaled(0.5)], ["−", "zoom out", () => this.scaled(2)],
        ["◂", "earlier", () => this.moved(-0.4)], ["▸", "later", () => this.moved(0.4)],
        ["all", "show all", () => this.zoom(...this.full)],
      ];
      if (this.svg.parentElement.classList.contains("small")) return;
      for (const [sign, name, action] of buttons) {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = sign;
        button.title = name;
        button.setAttribute("aria-label", name);
        button.addEventListener("click", action);
        tools.appendChild(button);
      }
      caption.appendChild(tools);
    }

    at(event) {
      const box = this.svg.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * this.width;
      const share = Math.min(Math.max((x - this.left) / this.areaWidth, 0), 1);
      return this.view[0] + share * (this.view[1] - this.view[0]);
    }

    place(value) { return this.left + ((value - this.view[0]) / (this.view[1] - this.view[0])) * this.areaWidth; }

    listen() {
      let start = null;
      this.svg.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        start = { at: this.at(event), x: event.clientX, view: [...this.view], pan: event.shiftKey || event.pointerType === "touch" };
        this.svg.setPointerCapture(event.pointerId);
      });
      this.svg.addEventListener("pointermove", (event) => {
        if (start?.pan) {
          const by = ((event.clientX - start.x) / this.areaWidth) * (start.view[1] - start.view[0]);
          this.zoom(start.view[0] - by, start.view[1] - by);
        } else {
          this.read(this.at(event), start?.at);
        }
      });
      this.svg.addEventListener("pointerup", (event) => {
        if (start && !start.pan && Math.abs(event.clientX - start.x) > 4) {
          const end = this.at(event);
          this.zoom(Math.min(start.at, end), Math.max(start.at, end));
        }
        start = null;
        this.cursor.replaceChildren();
      });
      this.svg.addEventListener("pointercancel", () => { start = null; });
      this.svg.addEventListener("pointerleave", () => { this.cursor.replaceChildren(); this.readout.textContent = ""; });
      this.svg.addEventListener("dblclick", () => this.zoom(...this.full));
      this.svg.addEventListener("wheel", (event) => {
        // Without the key the wheel scrolls the page, as anywhere else.
        if (!event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        this.scaled(event.deltaY > 0 ? 1.25 : 0.8, this.at(event));
      }, { passive: false });
      this.svg.addEventListener("keydown", (event) => {
        const action = {
          "+": () => this.scaled(0.5), "=": () => this.scaled(0.5), "-": () => this.scaled(2),
          ArrowLeft: () => this.moved(-0.2), ArrowRight: () => this.moved(0.2), "0": () => this.zoom(...this.full),
        }[event.key];
        if (action) { event.preventDefault(); action(); }
      });
    }

    // Values of the lines at a place of the coordinate, and the stretch that is being chosen.
    read(value, from) {
      const bottom = this.panels[this.panels.length - 1];
      this.cursor.replaceChildren();
      make(this.cursor, "path", { d: `M${this.place(value)} ${this.panels[0].top}V${bottom.top + bottom.height}` });
      if (from !== undefined) {
        const [a, b] = [this.place(Math.min(from, value)), this.place(Math.max(from, value))];
        make(this.cursor, "rect", { x: a, y: this.panels[0].top, width: b - a, height: bottom.top + bottom.height - this.panels[0].top });
      }
      const words = [`${this.label}: ${short(value)}`];
      for (const panel of this.panels) {
        for (const { name, points } of this.lines(panel)) {
          if (!name || points.length === 0) continue;
          let low = 0, high = points.length - 1;
          while (high - low > 1) {
            const middle = (low + high) >> 1;
            if (points[middle][0] < value) low = middle; else high = middle;
          }
          const nearest = Math.abs(points[low][0] - value) < Math.abs(points[high][0] - value) ? low : high;
          words.push(`${name} ${short(points[nearest][1])}`);
        }
      }
      this.readout.textContent = words.join(" · ");
    }
  }

  const waiting = new Map();
  const seen = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      if (target.clientWidth > 0) waiting.get(target)?.layout();
    }
  });
  for (const svg of document.querySelectorAll("svg.plot")) {
    const plot = new Plot(svg);
    plots.push(plot);
    waiting.set(svg, plot);
    seen.observe(svg);
  }
  // On paper nothing can be unfolded.
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
})();
