// The page of simulate_page.h without its data: style, canvas and script. Nothing is loaded from anywhere.
#pragma once

namespace delassus::cli {

inline constexpr char player_begin[] = R"html(<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>
:root { color-scheme: light dark; --line: #8884; }
body { font: 15px/1.4 system-ui, sans-serif; margin: 1em auto; max-width: 70em; padding: 0 1em; }
canvas { width: 100%; border: 1px solid var(--line); border-radius: 6px; display: block; touch-action: none; }
#scene { aspect-ratio: 16/9; cursor: grab; } #chart { aspect-ratio: 8/1; margin-top: .5em; cursor: pointer; }
.bar { display: flex; gap: .6em; align-items: center; margin: .5em 0; flex-wrap: wrap; } input[type=range] { flex: 1; min-width: 10em; }
table { border-collapse: collapse; } td { padding: 0 .8em 0 0; font-variant-numeric: tabular-nums; vertical-align: top; } td:first-child { white-space: nowrap; }
</style>
)html";

inline constexpr char player_body[] = R"html(
<h1 id="name"></h1>
<canvas id="scene" role="img" aria-label="the scene at the time chosen below"></canvas>
<div class="bar"><button id="play">Play</button><input id="at" type="range" min="0" value="0" aria-label="time"><span id="time"></span>
<label>speed <select id="speed"><option>0.1<option>0.25<option selected>1<option>2</select></label>
<label><input id="forces" type="checkbox" checked> contact forces</label><label><input id="skeleton" type="checkbox"> skeleton</label><button id="save">Save picture</button></div>
<canvas id="chart" role="img" aria-label="energies over time"></canvas>
<table><tbody id="facts"></tbody></table>
<p>Drag turns, shift and drag moves, the wheel zooms; space plays, arrows step.</p>
)html";

inline constexpr char player_end[] = R"html(<script>
"use strict";
const $ = id => document.getElementById(id), F = data.frames, N = data.parents.length;
$("name").textContent = data.name; $("at").max = F.length - 1;
const dark = matchMedia("(prefers-color-scheme: dark)").matches, ink = dark ? "#ddd" : "#222";
const colours = ["#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2", "#b07aa1", "#9c755f"];
const root = data.parents.map((p, i) => i); data.parents.forEach((p, i) => { if (p >= 0) root[i] = root[p]; });
const rank = new Map(); root.forEach(r => { if (!rank.has(r)) rank.set(r, rank.size); });
const rgb = i => { const c = i < 0 ? "#999999" : colours[rank.get(root[i]) % colours.length]; return [1, 3, 5].map(k => parseInt(c.slice(k, k + 2), 16)); };
const turn = (q, x) => { const [w, a, b, c] = q, t = [2 * (b * x[2] - c * x[1]), 2 * (c * x[0] - a * x[2]), 2 * (a * x[1] - b * x[0])];
  return [x[0] + w * t[0] + b * t[2] - c * t[1], x[1] + w * t[1] + c * t[0] - a * t[2], x[2] + w * t[2] + a * t[1] - b * t[0]]; };
const add = (x, y) => x.map((v, k) => v + y[k]), sub = (x, y) => x.map((v, k) => v - y[k]), dot = (x, y) => x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
const cross = (x, y) => [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
const place = (a, x) => add(turn(a.slice(3), x), a.slice(0, 3));
function faces(s) {
  const [a, b, c] = s.size, out = [];
  if (s.kind === "box") for (let k = 0; k < 3; ++k) for (const sign of [-1, 1]) {
    const u = (k + 1) % 3, v = (k + 2) % 3, ring = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([p, q]) => { const x = [0, 0, 0]; x[k] = sign * s.size[k]; x[u] = p * s.size[u]; x[v] = q * s.size[v]; return x; });
    out.push(sign > 0 ? ring : ring.reverse());
  }
  if (s.kind === "cylinder" || s.kind === "capsule") {
    const n = 14, ring = z => [...Array(n).keys()].map(k => [a * Math.cos(2 * Math.PI * k / n), a * Math.sin(2 * Math.PI * k / n), z]);
    const low = ring(-b), high = ring(b);
    for (let k = 0; k < n; ++k) out.push([low[k], low[(k + 1) % n], high[(k + 1) % n], high[k]]);
    if (s.kind === "cylinder") out.push(high, low.slice().reverse());
  }
  return out;
}
data.shapes.forEach(s => { s.faces = faces(s); s.balls = s.kind === "sphere" ? [[0, 0, 0]] : s.kind === "capsule" ? [[0, 0, -s.size[1]], [0, 0, s.size[1]]] : []; });
const pose = (f, i) => i < 0 ? [0, 0, 0, 1, 0, 0, 0] : f.p.slice(7 * i, 7 * i + 7);
let low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
for (let i = 0; i < N; ++i) { const x = pose(F[0], i); for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], x[k]); high[k] = Math.max(high[k], x[k]); } }
let size = 0.3; for (let k = 0; k < 3; ++k) size = Math.max(size, high[k] - low[k]);
data.shapes.forEach(s => { size = Math.max(size, s.kind === "hull" ? 0 : Math.max(...s.size)); });
let view = { yaw: -0.9, tilt: 0.35, far: 3.2 * size, to: low.map((v, k) => (v + high[k]) / 2) }, now = 0, playing = false, last = 0;
const canvas = $("scene"), chart = $("chart");
function fit(c) { const d = devicePixelRatio || 1, w = Math.round(c.clientWidth * d), h = Math.round(c.clientHeight * d); if (c.width !== w || c.height !== h) { c.width = w; c.height = h; } }
function camera() {
  const { yaw, tilt, far, to } = view, back = [Math.cos(tilt) * Math.cos(yaw), Math.cos(tilt) * Math.sin(yaw), Math.sin(tilt)];
  const right = [-Math.sin(yaw), Math.cos(yaw), 0], up = cross(back, right), eye = add(to, back.map(v => far * v)), scale = 1.3 * canvas.height;
  return { back, right, up, eye, see(x) { const d = sub(x, eye), z = -dot(d, back); return z < 1e-3 * far ? null : [canvas.width / 2 + scale * dot(d, right) / z, canvas.height / 2 - scale * dot(d, up) / z, z, scale / z]; } };
}
function draw() {
  fit(canvas); const g = canvas.getContext("2d"), cam = camera(), f = F[now]; g.clearRect(0, 0, canvas.width, canvas.height);
  const line = (a, b, colour, width) => { const p = cam.see(a), q = cam.see(b); if (!p || !q) return; g.strokeStyle = colour; g.lineWidth = width; g.beginPath(); g.moveTo(p[0], p[1]); g.lineTo(q[0], q[1]); g.stroke(); };
  if (data.ground !== null) { const z = data.ground, cell = 10 ** Math.floor(Math.log10(size)), c = view.to.map(v => cell * Math.round(v / cell));
    for (let k = -10; k <= 10; ++k) { line([c[0] - 10 * cell, c[1] + k * cell, z], [c[0] + 10 * cell, c[1] + k * cell, z], "#8886", 1); line([c[0] + k * cell, c[1] - 10 * cell, z], [c[0] + k * cell, c[1] + 10 * cell, z], "#8886", 1); } }
  const things = [];
  for (const s of data.shapes) { const P = pose(f, s.body), base = rgb(s.body), at = x => place(P, place(s.at, x));
    for (const ring of s.faces) { const w = ring.map(at), n = cross(sub(w[1], w[0]), sub(w[2], w[0])), l = Math.hypot(...n) || 1; if (dot(n, sub(cam.eye, w[0])) <= 0) continue;
      const p = w.map(cam.see); if (p.some(x => !x)) continue; things.push({ z: p.reduce((t, x) => t + x[2], 0) / p.length, p, shade: 0.55 + 0.4 * Math.abs(dot(n, [0.3, -0.5, 0.81])) / l, base }); }
    for (const b of s.balls) { const p = cam.see(at(b)); if (p) things.push({ z: p[2], ball: p, r: s.size[0] * p[3], base }); }
    if (s.points) for (const x of s.points) { const p = cam.see(at(x)); if (p) things.push({ z: p[2], ball: p, r: Math.max(1.5, 0.004 * size * p[3]), base }); } }
  things.sort((a, b) => b.z - a.z);
  for (const t of things) { const c = k => `rgb(${t.base.map(v => Math.round(v * k)).join()})`; g.beginPath();
    if (t.p) { t.p.forEach((x, k) => k ? g.lineTo(x[0], x[1]) : g.moveTo(x[0], x[1])); g.closePath(); g.fillStyle = c(t.shade); g.strokeStyle = c(0.45); g.lineWidth = 1; g.fill(); g.stroke(); }
    else { const s = g.createRadialGradient(t.ball[0] - t.r / 3, t.ball[1] - t.r / 3, t.r / 8, t.ball[0], t.ball[1], t.r); s.addColorStop(0, c(1.2)); s.addColorStop(1, c(0.6)); g.fillStyle = s; g.arc(t.ball[0], t.ball[1], t.r, 0, 7); g.fill(); } }
  if ($("skeleton").checked) for (let i = 0; i < N; ++i) { const x = pose(f, i).slice(0, 3); if (data.parents[i] >= 0) line(pose(f, data.parents[i]).slice(0, 3), x, ink, 2); const p = cam.see(x); if (p) { g.fillStyle = ink; g.beginPath(); g.arc(p[0], p[1], 3, 0, 7); g.fill(); } }
  if ($("forces").checked && data.weight > 0) for (let k = 0; k < f.c.length; k += 6) { const x = f.c.slice(k, k + 3); line(x, add(x, f.c.slice(k + 3, k + 6).map(v => v * size / data.weight)), "#d33", 3); }
  $("time").textContent = f.t.toFixed(3) + " s"; $("at").value = now;
  const rows = [["energy", (f.k + f.u).toPrecision(6) + " J (kinetic " + f.k.toPrecision(4) + ")"], ["rows", f.r], ["iterations of the solver", f.i], ["residual", f.e.toExponential(1) + " m/s"], ["drift of the step", f.d.toExponential(1) + " m or rad"], ["effects", data.effects.join(", ")]];
  $("facts").replaceChildren(...rows.map(([a, b]) => { const tr = document.createElement("tr"); for (const x of [a, b]) { const td = document.createElement("td"); td.textContent = x; tr.append(td); } return tr; }));
  plot();
}
function plot() {
  fit(chart); const g = chart.getContext("2d"), w = chart.width, h = chart.height; g.clearRect(0, 0, w, h);
  const lines = [["kinetic", f => f.k, colours[1]], ["potential", f => f.u, colours[0]], ["sum", f => f.k + f.u, ink]], all = F.flatMap(f => lines.map(l => l[1](f)));
  const least = all.reduce((a, b) => Math.min(a, b)), most = all.reduce((a, b) => Math.max(a, b)), y = v => h - 6 - (h - 12) * (v - least) / (most - least || 1), x = k => w * k / Math.max(1, F.length - 1);
  lines.forEach(([name, of, colour], i) => { g.strokeStyle = colour; g.lineWidth = 2; g.beginPath(); F.forEach((f, k) => k ? g.lineTo(x(k), y(of(f))) : g.moveTo(x(k), y(of(f)))); g.stroke(); g.fillStyle = colour; g.font = h / 8 + "px sans-serif"; g.fillText(name, 8 + i * w / 9, h / 7); });
  g.strokeStyle = "#d33"; g.lineWidth = 1; g.beginPath(); g.moveTo(x(now), 0); g.lineTo(x(now), h); g.stroke();
}
function go(k) { now = Math.max(0, Math.min(F.length - 1, k)); draw(); }
function tick(t) { if (!playing) return; const wanted = F[now].t + (t - last) / 1000 * Number($("speed").value); let k = now; while (k + 1 < F.length && F[k + 1].t <= wanted) ++k;
  if (k !== now) { last = t; go(k); } if (now === F.length - 1) { playing = false; $("play").textContent = "Play"; } else requestAnimationFrame(tick); }
function toggle() { playing = !playing; if (playing && now === F.length - 1) now = 0; $("play").textContent = playing ? "Pause" : "Play"; if (playing) { last = performance.now(); requestAnimationFrame(tick); } }
$("play").onclick = toggle; $("at").oninput = e => go(Number(e.target.value)); $("forces").onchange = $("skeleton").onchange = draw;
$("save").onclick = () => { const a = document.createElement("a"); a.download = data.name + ".png"; a.href = canvas.toDataURL("image/png"); a.click(); };
chart.onclick = e => go(Math.round(e.offsetX / chart.clientWidth * (F.length - 1)));
let held = null; canvas.onpointerdown = e => { held = e; canvas.setPointerCapture(e.pointerId); }; canvas.onpointerup = () => { held = null; };
canvas.onpointermove = e => { if (!held) return; const dx = e.clientX - held.clientX, dy = e.clientY - held.clientY; held = e;
  if (e.shiftKey) { const c = camera(), s = view.far / (1.3 * canvas.clientHeight); view.to = view.to.map((v, k) => v - s * dx * c.right[k] + s * dy * c.up[k]); } else { view.yaw -= dx / 150; view.tilt = Math.max(-1.5, Math.min(1.5, view.tilt + dy / 150)); } draw(); };
canvas.onwheel = e => { e.preventDefault(); view.far *= Math.exp(e.deltaY / 800); draw(); };
onkeydown = e => { if (e.target.tagName === "SELECT") return; if (e.key === " ") { e.preventDefault(); toggle(); } if (e.key === "ArrowRight") go(now + 1); if (e.key === "ArrowLeft") go(now - 1); };
onresize = draw; if (!data.shapes.length) $("skeleton").checked = true; draw();
</script></html>
)html";

}  // namespace delassus::cli
