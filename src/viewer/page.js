// Draws control nets coloured by displacement, tools as what they are with their forces, contacts with their normals, and a strip chart.
"use strict";
const canvas = document.getElementById("scene");
const text = document.getElementById("text");
const pen = canvas.getContext("2d");
let picture = null, rest = {}, scene = 0, chart = [], outlines = [];
let yaw = 0.7, pitch = 0.25, zoom = 1;

canvas.addEventListener("pointermove", (e) => {
  if (e.buttons & 1) { yaw += e.movementX * 0.008; pitch = Math.max(-1.5, Math.min(1.5, pitch + e.movementY * 0.008)); draw(); }
});
canvas.addEventListener("wheel", (e) => { zoom *= Math.exp(-e.deltaY * 0.001); draw(); });
addEventListener("resize", draw);

function connect() {
  const socket = new WebSocket(`ws://${location.host}/live`);
  socket.onmessage = (event) => {
    const next = JSON.parse(event.data);
    if (!next.nets) return;
    if (next.scene !== scene) { rest = {}; scene = next.scene; }
    for (const net of next.nets) if (!(net.body in rest)) rest[net.body] = net.points;
    picture = next;
    const size = next.tools.length ? Math.hypot(...next.tools[0].force) : 0;
    chart.push(size);
    if (chart.length > 400) chart.shift();
    draw();
  };
  fetch("/tools.json").then((answer) => answer.json()).then((list) => { outlines = list; draw(); }).catch(() => {});
  socket.onclose = () => { text.textContent = "connection to the daemon lost; reconnecting…"; setTimeout(connect, 1000); };
}
connect();

// A place of the tool's frame in the world: q p q* + proxy.
function placed([x, y, z], { proxy, orientation: [a, b, c, w] }) {
  const [u, v, t] = [2 * (b * z - c * y), 2 * (c * x - a * z), 2 * (a * y - b * x)];
  return [x + w * u + b * t - c * v + proxy[0], y + w * v + c * u - a * t + proxy[1], z + w * t + a * v - b * u + proxy[2]];
}

// Triangles that face us, the farthest first, lighter where they face us more.
function drawSolid(outline, tool, view) {
  const places = outline.points.map((p) => view(placed(p, tool)));
  const faces = [];
  for (const [i, j, k] of outline.triangles) {
    const [a, b, c] = [places[i], places[j], places[k]];
    const across = [b[0] - a[0], b[1] - a[1]], down = [c[0] - a[0], c[1] - a[1]];
    // The page's y goes down: what turns clockwise in these coordinates turns the other way for the eye.
    const area = across[1] * down[0] - across[0] * down[1];
    if (area > 0) faces.push({ a, b, c, area, near: a[2] + b[2] + c[2] });
  }
  faces.sort((one, other) => one.near - other.near);
  const scale = Math.hypot(...view([1, 0, 0]).map((x, c) => x - view([0, 0, 0])[c]).slice(0, 2)) || 1;
  for (const { a, b, c, area } of faces) {
    const deep = [(b[2] - a[2]) * scale, (c[2] - a[2]) * scale];
    const nx = (b[1] - a[1]) * deep[1] - deep[0] * (c[1] - a[1]), ny = deep[0] * (c[0] - a[0]) - (b[0] - a[0]) * deep[1];
    const facing = area / Math.hypot(nx, ny, area);
    pen.fillStyle = pen.strokeStyle = `hsl(44 ${60 + 30 * facing}% ${25 + 40 * facing}%)`;
    pen.beginPath(); pen.moveTo(a[0], a[1]); pen.lineTo(b[0], b[1]); pen.lineTo(c[0], c[1]); pen.closePath(); pen.fill(); pen.stroke();
  }
}

function draw() {
  const width = canvas.width = innerWidth * devicePixelRatio;
  const height = canvas.height = innerHeight * devicePixelRatio;
  if (!picture || !picture.nets.length) return;
  let low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
  for (const name in rest) for (const p of rest[name]) for (let c = 0; c < 3; c++) {
    low[c] = Math.min(low[c], p[c]); high[c] = Math.max(high[c], p[c]);
  }
  const middle = low.map((x, c) => (x + high[c]) / 2);
  const scale = zoom * 0.65 * Math.min(width, height) / Math.hypot(...low.map((x, c) => high[c] - x));
  const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
  const view = (p) => {
    const [x, y, z] = p.map((v, c) => v - middle[c]);
    const across = -sy * x + cy * y, toward = cy * x + sy * y;
    return [width / 2 + scale * across, height / 2 - scale * (cp * z - sp * toward), cp * toward + sp * z];
  };
  pen.lineWidth = devicePixelRatio;
  for (const net of picture.nets) {
    const [rows, columns] = net.count, still = rest[net.body];
    const places = net.points.map(view);
    const moved = net.points.map((p, k) => Math.hypot(p[0] - still[k][0], p[1] - still[k][1], p[2] - still[k][2]));
    const line = (a, b) => {
      const share = Math.min(1, Math.max(moved[a], moved[b]) / 0.004);
      pen.strokeStyle = `hsl(${210 - 200 * share} 75% ${52 + 10 * share}%)`;
      pen.beginPath(); pen.moveTo(places[a][0], places[a][1]); pen.lineTo(places[b][0], places[b][1]); pen.stroke();
    };
    for (let i = 0; i < rows; i++) for (let j = 0; j < columns; j++) {
      const k = i * columns + j;
      if (j + 1 < columns && !net.gaps[1].includes(j)) line(k, k + 1);
      if (i + 1 < rows && !net.gaps[0].includes(i)) line(k, k + columns);
    }
  }
  picture.tools.forEach((tool, t) => { if (outlines[t]) drawSolid(outlines[t], tool, view); });
  for (const tool of picture.tools) {
    const [x, y] = view(tool.proxy);
    const tip = view(tool.proxy.map((v, c) => v + tool.force[c] * 0.1));
    pen.lineWidth = 3 * devicePixelRatio; pen.strokeStyle = "#ef476f";
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(tip[0], tip[1]); pen.stroke();
  }
  for (const contact of picture.contacts) {
    const [x, y] = view(contact.point);
    pen.fillStyle = "#ff9f1c";
    pen.beginPath(); pen.arc(x, y, 3 * devicePixelRatio, 0, 7); pen.fill();
    const tip = view(contact.point.map((v, c) => v + contact.normal[c] * 0.008));
    pen.lineWidth = 1.5 * devicePixelRatio; pen.strokeStyle = "#ff9f1c";
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(tip[0], tip[1]); pen.stroke();
  }
  const top = Math.max(0.1, ...chart), base = height - 20 * devicePixelRatio, tall = 90 * devicePixelRatio;
  pen.lineWidth = 1.5 * devicePixelRatio; pen.strokeStyle = "#06d6a0"; pen.beginPath();
  chart.forEach((f, k) => pen.lineTo(20 + k * (width - 40) / 400, base - tall * f / top));
  pen.stroke();
  const tool = picture.tools[0];
  text.textContent = `tick ${picture.tick}\nlate ${picture.late}  skipped ${picture.skipped}  step p99 ${picture.step_p99_us.toFixed(0)} µs`
    + (picture.refused ? `\nposes refused ${picture.refused}` : "") + (picture.recorder !== "Off" ? `\nrecorder: ${picture.recorder.toLowerCase()}` : "")
    + (tool ? `\nforce ${Math.hypot(...tool.force).toFixed(4)} N  depth ${(tool.depth * 1e3).toFixed(3)} mm  contacts ${picture.contacts.length}  (chart to ${top.toFixed(2)} N)` : "");
}
