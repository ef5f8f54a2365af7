'use strict';
// Everything shown is made from the JSON below; nothing is loaded from anywhere.
const data = JSON.parse(document.getElementById('data').textContent);
const $ = id => document.getElementById(id);
const svgSpace = 'http://www.w3.org/2000/svg';
function make(tag, attributes, ...children) {
  const element = tag.startsWith('svg:') ? document.createElementNS(svgSpace, tag.slice(4)) : document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
const show = id => { $(id).hidden = false; };
const number = (value, digits = 3) => value === null || value === undefined ? '' : typeof value === 'number' ? value.toFixed(digits) : String(value);
// Okabe and Ito's colours, which the colour-blind can tell apart, and a few more; marks differ as well.
const colors = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#8f8f8f', '#b8a600', '#7a4fa3', '#a0522d', '#4d7c0f', '#be185d'];
const marks = ['circle', 'square', 'diamond', 'triangle', 'down', 'cross'];
const styles = new Map();
function style(name) {
  if (!styles.has(name)) styles.set(name, {color: colors[styles.size % colors.length], mark: marks[styles.size % marks.length]});
  return styles.get(name);
}

const runs = data.timings.flatMap(t => t.runs);
const sweeps = data.sweeps;

function environment() {
  const section = $('environment'), warnings = new Map();
  const warn = (text, who) => warnings.set(text, [...(warnings.get(text) || []), who]);
  for (const run of runs) for (const text of run.warnings) warn(text, run.name);
  for (const timing of data.timings) if (!timing.complete) warn('interrupted: not all frames were measured', 'bench');
  for (const sweep of sweeps) for (const cell of sweep.cells) for (const text of cell.warnings || []) warn(text.replace(/(?<=[ =])[0-9.]+/g, '…'), cell.id);
  const list = make('ul', {class: 'warnings'});
  for (const [text, who] of warnings) {
    const names = [...new Set(who)];
    list.append(make('li', {}, text + (names.length > 3 ? ` (${names.length} runs)` : ` (${names.join(', ')})`)));
  }
  section.append(warnings.size ? list : make('p', {}, 'No warnings.'));
  const seen = new Set();
  for (const context of [...runs.map(r => r.context), ...sweeps.map(s => s.context)]) {
    if (!context) continue;
    const rows = [['device', `${context.device.name}, ${context.device.driver} ${context.device.driver_info}, Vulkan ${context.device.api}`],
      ['machine', `${context.host.cpu}, ${context.host.cores} cores, ${context.host.os}`],
      ['load', `${number(context.host.load_avg_start, 2)} at the start, ${number(context.host.load_avg_end, 2)} at the end; others used ${number(context.host.other_processes_cores, 2)} cores`],
      ['program', `${context.app.version}, git ${context.app.git}, ${context.app.build}, ${context.app.compiler}`], ['date', context.date]];
    const key = rows.flat().join();
    if (seen.has(key)) continue;
    seen.add(key);
    const terms = make('dl', {});
    for (const [name, value] of rows) terms.append(make('dt', {}, name), make('dd', {}, value));
    section.append(terms);
  }
}

// A table whose headings sort; text columns first.
function table(id, columns, rows) {
  const head = make('tr', {}), body = $(id).tBodies[0];
  const fill = () => body.replaceChildren(...rows.map(row => make('tr', {}, ...columns.map(c => make('td', {}, number(row[c[0]], c[1] ?? 3))))));
  let last = null, up = true;
  for (const [name] of columns) {
    const button = make('button', {type: 'button'}, name), cell = make('th', {scope: 'col'}, button);
    button.addEventListener('click', () => {
      up = last === name ? !up : typeof (rows.find(r => r[name] !== null) || {})[name] !== 'number';
      last = name;
      const order = (a, b) => typeof a[name] === 'number' && typeof b[name] === 'number' ? a[name] - b[name] : String(a[name]).localeCompare(String(b[name]));
      rows.sort((a, b) => up ? order(a, b) : order(b, a));
      for (const other of head.children) other.removeAttribute('aria-sort');
      cell.setAttribute('aria-sort', up ? 'ascending' : 'descending');
      fill();
    });
    head.append(cell);
  }
  $(id).tHead.replaceChildren(head);
  fill();
}

function passes() {
  if (!runs.length) return;
  const rows = runs.flatMap(run => run.passes.map(pass => ({run: run.name, pass: pass.path, kind: pass.kind, count: pass.gpu_ms.count,
    median: pass.gpu_ms.median, p95: pass.gpu_ms.p95, p99: pass.gpu_ms.p99, max: pass.gpu_ms.max, mad: pass.gpu_ms.mad,
    'share %': run.frame.gpu_ms.median ? 100 * pass.gpu_ms.median / run.frame.gpu_ms.median : null})));
  table('pass-table', [['run'], ['pass'], ['kind'], ['count', 0], ['median'], ['p95'], ['p99'], ['max'], ['mad'], ['share %', 1]], rows);
  show('passes');
}

function stacks() {
  if (!runs.length) return;
  const width = 960, bar = 26, left = 130, most = Math.max(...runs.map(r => r.frame.gpu_ms.median || 0));
  if (!(most > 0)) return;
  const names = [...new Set(runs.flatMap(r => r.passes.map(p => p.path)))];
  const picture = make('svg:svg', {viewBox: `0 0 ${width} ${runs.length * (bar + 8) + 8}`, role: 'img', 'aria-label': 'Median time of each pass, stacked, for each run'});
  runs.forEach((run, row) => {
    let x = left;
    const y = row * (bar + 8) + 4;
    picture.append(make('svg:text', {x: left - 8, y: y + 17, 'text-anchor': 'end'}, run.name));
    const part = (name, ms, color) => {
      const w = (width - left - 90) * ms / most;
      if (!(w > 0)) return;
      const box = make('svg:rect', {x, y, width: w, height: bar, fill: color, stroke: 'var(--paper)'});
      box.append(make('svg:title', {}, `${run.name}: ${name} ${number(ms)} ms`));
      picture.append(box);
      if (w > 7 * name.length) picture.append(make('svg:text', {x: x + 3, y: y + 17, style: 'fill:#fff'}, name));
      x += w;
    };
    for (const pass of run.passes) part(pass.path, pass.gpu_ms.median || 0, colors[names.indexOf(pass.path) % colors.length]);
    part('unattributed', Math.max(run.frame.unattributed_ms.median || 0, 0), '#444');
    picture.append(make('svg:text', {x: x + 6, y: y + 17}, `${number(run.frame.gpu_ms.median, 2)} ms${run.noisy ? ' (noisy)' : ''}`));
  });
  $('stacks').append(picture);
  show('bars');
}

// --- time against error
const nearest = (a, b) => a.ms - b.ms || a.error - b.error;
function frontOf(points) {
  let least = Infinity;
  return [...points].sort(nearest).filter(p => p.error < least && ((least = p.error), true));
}
function shape(mark, x, y, r) {
  if (mark === 'circle') return make('svg:circle', {cx: x, cy: y, r});
  const paths = {square: `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}z`, diamond: `M${x} ${y - 1.3 * r}l${1.3 * r} ${1.3 * r}l${-1.3 * r} ${1.3 * r}l${-1.3 * r} ${-1.3 * r}z`,
    triangle: `M${x} ${y - 1.2 * r}l${1.2 * r} ${2.2 * r}h${-2.4 * r}z`, down: `M${x} ${y + 1.2 * r}l${1.2 * r} ${-2.2 * r}h${-2.4 * r}z`,
    cross: `M${x - r} ${y - r / 3}h${r * 2 / 3}v${-r * 2 / 3}h${r * 2 / 3}v${r * 2 / 3}h${r * 2 / 3}v${r * 2 / 3}h${-r * 2 / 3}v${r * 2 / 3}h${-r * 2 / 3}v${-r * 2 / 3}h${-r * 2 / 3}z`};
  return make('svg:path', {d: paths[mark]});
}
function ticks(low, high) {
  const out = [];
  if (high / low < 5) {  // too few of 1, 2, 5: even steps
    const step = [1, 2, 5, 10].map(m => m * 10 ** Math.floor(Math.log10((high - low) / 5))).find(s => (high - low) / s <= 6);
    for (let i = Math.ceil(low / step); i * step <= high; ++i) out.push(i * step);
    return out;
  }
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e)
    for (const m of [1, 2, 5]) if (m * 10 ** e >= low && m * 10 ** e <= high) out.push(m * 10 ** e);
  return out;
}
function scatter(sweep, place, metric) {
  const cost = c => c[c.cost], here = sweep.cells.filter(c => c.place === place && c.errors && typeof c.errors[metric] === 'number' && typeof cost(c).median === 'number');
  const least = Math.min(...here.map(c => cost(c).median).filter(ms => ms > 0));
  if (!isFinite(least)) return $('scatter').replaceChildren('No cells.');
  // What takes no time stands at the left end of the logarithmic axis.
  const points = here.map(c => ({cell: c, ms: Math.max(cost(c).median, least / 1.5), error: Math.max(c.errors[metric], 1e-9)}));
  const axis = points[0].cell.cost === 'gpu_ms' ? 'median frame time, ms' : "median time of the technique's passes, ms";
  const front = frontOf(points), width = 960, height = 460, left = 70, bottom = 40;
  const range = values => { const low = Math.min(...values), high = Math.max(...values); return [low / 1.1, high * 1.1]; };
  const [x0, x1] = range(points.map(p => p.ms)), [y0, y1] = range(points.map(p => p.error));
  const X = v => left + (width - left - 150) * Math.log(v / x0) / Math.log(x1 / x0), Y = v => 12 + (height - bottom - 12) * (1 - Math.log(v / y0) / Math.log(y1 / y0));
  const picture = make('svg:svg', {viewBox: `0 0 ${width} ${height}`, role: 'group', 'aria-label': `${axis} against ${metric}`});
  for (const t of ticks(x0, x1)) picture.append(make('svg:line', {x1: X(t), x2: X(t), y1: 12, y2: height - bottom, class: 'axis', 'stroke-dasharray': '2 4'}), make('svg:text', {x: X(t), y: height - bottom + 16, 'text-anchor': 'middle'}, +t.toPrecision(3)));
  for (const t of ticks(y0, y1)) picture.append(make('svg:line', {x1: left, x2: width - 150, y1: Y(t), y2: Y(t), class: 'axis', 'stroke-dasharray': '2 4'}), make('svg:text', {x: left - 6, y: Y(t) + 4, 'text-anchor': 'end'}, +t.toPrecision(3)));
  picture.append(make('svg:text', {x: (left + width - 150) / 2, y: height - 6, 'text-anchor': 'middle'}, axis), make('svg:text', {x: 4, y: 10}, metric));
  let d = '';
  front.forEach((p, i) => { d += i ? `H${X(p.ms)}V${Y(p.error)}` : `M${X(p.ms)} ${Y(p.error)}`; });
  picture.append(make('svg:path', {d, class: 'front'}));
  for (const p of points) {
    const s = style(p.cell.run), dot = shape(s.mark, X(p.ms), Y(p.error), front.includes(p) ? 6 : 4.5);
    dot.setAttribute('fill', s.color);
    dot.setAttribute('class', front.includes(p) ? 'dot best' : 'dot');
    dot.setAttribute('tabindex', 0);
    dot.append(make('svg:title', {}, `${p.cell.id}: ${number(cost(p.cell).median)} ms, ${metric} ${+p.error.toPrecision(4)}`));
    const pick = () => {
      $('point').replaceChildren(make('strong', {}, p.cell.id), ` ${number(cost(p.cell).median)} ms (mad ${number(cost(p.cell).mad)}), ${metric} ${+p.error.toPrecision(4)}${p.cell.noisy ? ', noisy' : ''}`, make('pre', {}, p.cell.command));
      if (pictureNames.has(p.cell.picture)) { $('picture-b').value = p.cell.picture; wipePictures(); }
    };
    dot.addEventListener('click', pick);
    dot.addEventListener('keydown', e => { if (e.key === 'Enter') pick(); });
    picture.append(dot);
  }
  [...new Set(points.map(p => p.cell.run))].forEach((name, i) => {
    const key = shape(style(name).mark, width - 135, 24 + 20 * i, 5);
    key.setAttribute('fill', style(name).color);
    picture.append(key, make('svg:text', {x: width - 122, y: 28 + 20 * i}, name));
  });
  $('scatter').replaceChildren(picture);
}
function fronts() {
  const sweep = sweeps.find(s => s.cells.some(c => c.errors));
  if (!sweep) return;
  const places = [...new Set(sweep.cells.map(c => c.place))], metrics = [...new Set(sweep.cells.flatMap(c => Object.keys(c.errors || {})))];
  for (const c of sweep.cells) style(c.run);
  const select = (label, values, changed) => {
    const box = make('select', {}, ...values.map(v => make('option', {}, v)));
    box.addEventListener('change', changed);
    $('front-controls').append(make('label', {}, label + ' ', box), ' ');
    return box;
  };
  const draw = () => scatter(sweep, place.value, metric.value);
  const place = select('scene', places, draw), metric = select('error', metrics, draw);
  draw();
  show('front');
}
function cells() {
  const rows = sweeps.flatMap(s => s.cells.map(c => ({cell: c.id, run: c.run, median: c.gpu_ms.median, mad: c.gpu_ms.mad, technique: c.technique_ms.median, 'technique mad': c.technique_ms.mad, noisy: c.noisy ? 'noisy' : '', ...c.errors})));
  if (!rows.length) return;
  const metrics = [...new Set(sweeps.flatMap(s => s.cells.flatMap(c => Object.keys(c.errors || {}))))];
  table('cell-table', [['cell'], ['run'], ['median'], ['mad'], ['technique'], ['technique mad'], ...metrics.map(m => [m, 5]), ['noisy']], rows);
  show('cells');
}

// --- pictures
const pictureNames = new Map(data.pictures.map(p => [p.id, p]));
function setWipe() { $('wipe-a').style.width = $('slider').value / 10 + '%'; $('image-a').style.width = $('wipe').clientWidth + 'px'; }
async function drawHeat() {
  const canvas = $('heat-map');
  canvas.hidden = !$('heat').checked;
  if (canvas.hidden) return;
  const a = $('image-a'), b = $('image-b');
  await Promise.all([a.decode(), b.decode()]);
  canvas.width = a.naturalWidth; canvas.height = a.naturalHeight;
  const context = canvas.getContext('2d', {willReadFrequently: true});
  const pixels = image => { context.drawImage(image, 0, 0, canvas.width, canvas.height); return context.getImageData(0, 0, canvas.width, canvas.height); };
  const first = pixels(a), second = pixels(b);
  // Black, violet, orange, yellow.
  const stops = [[0, 0, 0], [90, 20, 120], [230, 100, 40], [255, 240, 120]];
  for (let i = 0; i < first.data.length; i += 4) {
    let d = 0;
    for (let c = 0; c < 3; ++c) d = Math.max(d, Math.abs(first.data[i + c] - second.data[i + c]));
    const t = Math.min(d / 255 * $('gain').value, 1) * 3, k = Math.min(Math.floor(t), 2);
    for (let c = 0; c < 3; ++c) first.data[i + c] = stops[k][c] + (stops[k + 1][c] - stops[k][c]) * (t - k);
  }
  context.putImageData(first, 0, 0);
}
function wipePictures() {
  const a = pictureNames.get($('picture-a').value), b = pictureNames.get($('picture-b').value);
  $('image-a').src = a.source; $('image-b').src = b.source;
  $('picture-text').textContent = `Left: ${a.label}. Right: ${b.label}.`;
  setWipe();
  drawHeat().catch(() => { $('picture-text').textContent += ' The difference needs both pictures inside this file and of one size.'; $('heat-map').hidden = true; });
}
function pictures() {
  if (data.pictures.length < 2) return;
  for (const id of ['picture-a', 'picture-b']) {
    $(id).append(...data.pictures.map(p => make('option', {value: p.id}, p.label)));
    $(id).addEventListener('change', wipePictures);
  }
  $('picture-b').value = data.pictures[1].id;
  for (const id of ['heat', 'gain']) $(id).addEventListener('change', wipePictures);
  $('slider').addEventListener('input', setWipe);
  const drag = e => { if (e.buttons & 1) { const box = $('wipe').getBoundingClientRect(); $('slider').value = 1000 * Math.min(Math.max((e.clientX - box.left) / box.width, 0), 1); setWipe(); e.preventDefault(); } };
  $('wipe').addEventListener('pointerdown', drag);
  $('wipe').addEventListener('pointermove', drag);
  window.addEventListener('resize', setWipe);
  show('compare');
  wipePictures();
}

function reproduce() {
  const commands = new Set([...runs.map(r => r.context.command), ...sweeps.map(s => s.command)].filter(Boolean));
  for (const command of commands) $('reproduce').append(make('pre', {}, command));
  $('reproduce').append(make('p', {class: 'note'}, 'All figures are in this file as JSON, in the element "data".'));
}

environment(); stacks(); passes(); fronts(); cells(); pictures(); reproduce();
