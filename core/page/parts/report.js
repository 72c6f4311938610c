// Draws each chart of a report from the table of its data, which stands below it for those who read rather than look.
(() => {
  'use strict';
  const kMarkers = ['circle', 'triangle', 'rect', 'rectRot', 'cross', 'star', 'crossRot', 'rectRounded'];
  const kColors = 10;
  const kTint = '2e';  // opacity of a band
  const kAreaTint = 'b0';  // of a part of a whole
  const kMarkersALine = 8;  // about: more would hide the line

  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const colorOf = (number) => style('--c' + (number % kColors));

  // 1234567 -> 1.23M, 0.00012 -> 1.2e-4
  function short(value) {
    const size = Math.abs(value);
    if (size === 0) return '0';
    if (size < 1e-3 || size >= 1e16) return value.toExponential(2).replace(/\.?0+e/, 'e').replace('e+', 'e');
    let unit = '', scaled = value;
    for (const next of ['k', 'M', 'G', 'T', 'P']) {
      if (Math.abs(scaled) < 999.5) break;
      scaled /= 1000;
      unit = next;
    }
    return String(Number(scaled.toPrecision(3))) + unit;
  }

  const leadOf = (value) => Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9));

  // Leaves 1, 10, 100, ... on a logarithmic axis, on a short one 2 and 5 between them too: of all ticks, those
  // that there is room for need not be round.
  function keepRoundTicks(scale) {
    const decades = Math.log10(scale.max / scale.min);
    const leads = decades < 2.5 ? [1, 2, 5] : [1];
    const round = scale.ticks.filter((tick) => leads.includes(leadOf(tick.value)));
    if (round.length > 1) scale.ticks = round;
  }

  // From a round number to a round number around all values.
  function roundEnds(values) {
    const positive = values.filter((value) => value > 0);
    if (positive.length === 0) return {};
    const unit = (value) => 10 ** Math.floor(Math.log10(value) + 1e-9);
    const low = positive.reduce((a, b) => Math.min(a, b)), high = positive.reduce((a, b) => Math.max(a, b));
    const min = Math.floor(low / unit(low) + 1e-9) * unit(low), max = Math.ceil(high / unit(high) - 1e-9) * unit(high);
    return max > min ? {min, max} : {};
  }

  // values: along the axis. Whole numbers get no ticks between them. fixed: the axis stays where lines come and go.
  function axis(title, logarithmic, values, fixed, stacked) {
    const ticks = {maxRotation: 0, autoSkipPadding: 12, callback: short};
    if (!logarithmic && values.every((value) => !(value % 1))) ticks.precision = 0;
    return {
      type: logarithmic ? 'logarithmic' : 'linear',
      title: {display: true, text: title},
      ...(stacked ? {stacked: true, beginAtZero: true} : {}),
      ticks, ...(logarithmic ? {afterBuildTicks: keepRoundTicks} : {}),
      ...(logarithmic && fixed ? roundEnds(values) : {}),
    };
  }

  // The series of a table: one a tbody, its name in the first row, then rows of x and y.
  function readSeries(table, logX, logY) {
    return Array.from(table.tBodies, (body) => {
      const points = [];
      for (const row of Array.from(body.rows).slice(1)) {
        const x = Number(row.cells[0].textContent), y = Number(row.cells[1].textContent);
        if (!logX || x > 0) points.push({x, y: !logY || y > 0 ? y : NaN});  // NaN: a gap in the line
      }
      const has = (flag) => flag in body.dataset, color = Number(body.dataset.color);
      return {name: body.rows[0].cells[0].textContent, key: color, color, points, line: !has('dots'),
              dashed: has('dashed'), fills: has('fills'), legend: !has('unlisted'), onDemand: has('onDemand')};
    });
  }

  // The first, the last, and others a good way apart along the axis.
  function markedPoints(points, logX) {
    const place = (point) => (logX ? Math.log(point.x) : point.x);
    const marked = new Set([0, points.length - 1]);
    if (points.length === 0) return marked;
    const step = (place(points[points.length - 1]) - place(points[0])) / kMarkersALine;
    let before = place(points[0]);
    points.forEach((point, i) => {
      if (Math.abs(place(point) - before) < Math.abs(step)) return;
      marked.add(i);
      before = place(point);
    });
    return marked;
  }

  // Parts on top of each other: each down to the one below.
  function stack(all) {
    all.forEach((series) => { series.area = true; });
  }

  // Both lines of a band. A band that goes down to 0 on a logarithmic axis goes to the axis's end.
  function closeBands(all, logY) {
    const values = all.flatMap((series) => series.points.map((point) => point.y)).filter((y) => y > 0);
    const floor = values.reduce((a, b) => Math.min(a, b), Infinity);
    all.forEach((series, i) => {
      if (!series.fills) return;
      for (const edge of [all[i - 1], series]) {
        edge.edge = true;
        if (logY) edge.points.forEach((point) => { if (!(point.y > 0)) point.y = floor; });
      }
    });
  }

  function dataset(series, logX) {
    const marked = series.edge || series.area ? new Set() : markedPoints(series.points, logX);
    return {
      label: series.name, data: series.points, showLine: series.line, borderWidth: series.edge || series.area ? 1 : 2,
      borderDash: series.dashed ? [6, 4] : [], fill: series.area ? 'stack' : series.fills ? '-1' : false, order: series.edge ? 1 : 0,
      hidden: series.onDemand, clip: 8,
      pointRadius: (context) => (!series.line ? 5.5 : marked.has(context.dataIndex) ? 3.5 : 0),
      pointBorderWidth: 1.5, pointHitRadius: 8, pointHoverRadius: 6,
    };
  }

  function paint(chart, all) {
    const ink = style('--ink'), line = style('--line');
    chart.data.datasets.forEach((set, i) => {
      set.borderColor = set.pointBackgroundColor = colorOf(all[i].color);
      set.backgroundColor = set.borderColor + (all[i].area ? kAreaTint : kTint);
      set.pointBorderColor = all[i].line ? set.borderColor : ink;
      set.pointStyle = kMarkers[all[i].color % kMarkers.length];
    });
    for (const scale of Object.values(chart.options.scales)) {
      scale.ticks.color = scale.title.color = ink;
      scale.grid.color = scale.grid.borderColor = line;
    }
    chart.update('none');
  }

  function paintSwatch(canvas, series) {
    const ratio = 2, context = canvas.getContext('2d');
    canvas.width = 28 * ratio;
    canvas.height = 14 * ratio;
    context.scale(ratio, ratio);
    context.strokeStyle = context.fillStyle = colorOf(series.color);
    context.lineWidth = 2;
    context.setLineDash(series.dashed ? [6, 4] : []);
    if (series.fills || series.area) {
      context.fillStyle += series.area ? kAreaTint : kTint;
      context.fillRect(0, 0, 28, 14);
      return;
    }
    if (series.line) {
      context.beginPath();
      context.moveTo(0, 7);
      context.lineTo(28, 7);
      context.stroke();
    }
    context.setLineDash([]);
    const options = {pointStyle: kMarkers[series.color % kMarkers.length], radius: 4, borderWidth: 1.5};
    context.lineWidth = options.borderWidth;
    if (!series.line) context.strokeStyle = style('--ink');
    Chart.helpers.drawPoint(context, options, 14, 7);
  }

  // A button a series that hides and shows it, with a series of its own colour that is not listed. Returns what
  // takes a series up into the legend, out of it, and paints its swatches.
  function addLegend(box, chart, all) {
    const entries = new Map();
    const setShown = (i, show) => {
      all.forEach((other, j) => {
        if (j === i || (!other.legend && other.key === all[i].key)) chart.setDatasetVisibility(j, show);
      });
    };
    const add = (i) => {
      const series = all[i], button = document.createElement('button'), swatch = document.createElement('canvas');
      button.type = 'button';
      button.setAttribute('aria-pressed', 'true');
      swatch.setAttribute('aria-hidden', 'true');
      button.append(swatch, series.fills ? `${all[i - 1].name} to ${series.name}` : series.name);
      button.addEventListener('click', () => {
        const show = !chart.isDatasetVisible(i);
        setShown(i, show);
        button.setAttribute('aria-pressed', String(show));
        chart.update('none');
      });
      box.append(button);
      entries.set(i, {button, swatch});
      setShown(i, true);
    };
    const remove = (i) => {
      entries.get(i).button.remove();
      entries.delete(i);
      setShown(i, false);
    };
    const paintSwatches = () => entries.forEach(({swatch}, i) => paintSwatch(swatch, all[i]));
    all.forEach((series, i) => { if (series.legend && !series.onDemand) add(i); });
    return {add, remove, paintSwatches};
  }

  function draw(figure) {
    const logX = 'logX' in figure.dataset, logY = 'logY' in figure.dataset;
    const table = figure.querySelector('table');
    const all = readSeries(table, logX, logY);
    closeBands(all, logY);
    const stacked = 'stacked' in figure.dataset;
    if (stacked) stack(all);
    const onDemand = 'pick' in figure.dataset;
    const [x, y] = Array.from(table.tHead.rows[0].cells, (cell) => cell.textContent);
    const along = (key) => all.flatMap((series) => series.points.map((point) => point[key]));
    const label = (item) => `${item.dataset.label}: ${short(item.parsed.y)} ${y} at ${short(item.parsed.x)} ${x}`;
    const chart = new Chart(figure.querySelector('.plot canvas'), {
      type: 'line',
      data: {datasets: all.map((series) => dataset(series, logX))},
      options: {
        animation: false, responsive: true, maintainAspectRatio: false, parsing: false,
        devicePixelRatio: Math.max(2, window.devicePixelRatio || 1),  // sharp on paper
        interaction: {mode: 'nearest', intersect: false},
        plugins: {legend: {display: false}, tooltip: {callbacks: {title: () => '', label}}},
        scales: {x: axis(x, logX, along('x'), onDemand), y: axis(y, logY, along('y'), onDemand, stacked)},
      },
    });
    const legend = addLegend(figure.querySelector('.legend'), chart, all);
    const paintIt = () => {
      paint(chart, all);
      legend.paintSwatches();
    };
    // Shows the series on demand of that name in the colour, or hides it.
    const pick = (name, shown, color) => {
      all.forEach((series, i) => {
        if (!series.onDemand || !series.legend || series.name !== name) return;
        all.forEach((other) => { if (other.key === series.key) other.color = color; });
        shown ? legend.add(i) : legend.remove(i);
      });
      paintIt();
    };
    const names = all.filter((series) => series.onDemand && series.legend).map((series) => series.name);
    return {figure, names, pick, paint: paintIt};
  }

  // Colours of picked series: the median has the first of the ten.
  const pickColor = (slot) => 1 + slot + Math.floor(slot / (kColors - 1));

  // The list to pick series on demand from, for all charts beside each other.
  function addPickList(group, charts) {
    const names = [...new Set(charts.flatMap((chart) => chart.names))];
    if (names.length === 0) return;
    const what = charts.find((chart) => chart.names.length > 0).figure.dataset.pick;
    const list = document.createElement('details'), summary = document.createElement('summary');
    const tools = document.createElement('div'), find = document.createElement('input');
    const clear = document.createElement('button'), boxes = document.createElement('div');
    list.className = 'pick';
    tools.className = 'tools';
    boxes.className = 'boxes';
    boxes.setAttribute('role', 'group');
    boxes.setAttribute('aria-label', what);
    find.type = 'search';
    find.placeholder = 'Find by name';
    find.setAttribute('aria-label', 'Find ' + what + ' by name');
    clear.type = 'button';
    clear.textContent = 'Clear all';
    const taken = new Map();  // name: slot of its colour
    const tell = () => {
      summary.textContent = `Show ${what}: ${taken.size || 'none'} of ${names.length} shown`;
      clear.disabled = taken.size === 0;
    };
    const set = (name, shown) => {
      if (shown) {
        let slot = 0;
        while ([...taken.values()].includes(slot)) ++slot;
        taken.set(name, slot);
      }
      charts.forEach((chart) => chart.pick(name, shown, pickColor(taken.get(name))));
      if (!shown) taken.delete(name);
      tell();
    };
    const rows = names.map((name) => {
      const label = document.createElement('label'), box = document.createElement('input');
      box.type = 'checkbox';
      box.addEventListener('change', () => set(name, box.checked));
      label.append(box, name);
      return {name, label, box};
    });
    find.addEventListener('input', () => {
      const part = find.value.toLowerCase();
      rows.forEach(({name, label}) => { label.hidden = !name.toLowerCase().includes(part); });
    });
    clear.addEventListener('click', () => {
      rows.filter(({box}) => box.checked).forEach(({name, box}) => {
        box.checked = false;
        set(name, false);
      });
      find.focus();
    });
    tell();
    boxes.append(...rows.map(({label}) => label));
    tools.append(find, clear);
    list.append(summary, tools, boxes);
    group.before(list);
  }

  const charts = Array.from(document.querySelectorAll('figure.chart'), draw);
  for (const group of document.querySelectorAll('.charts')) {
    addPickList(group, charts.filter((chart) => group.contains(chart.figure)));
  }
  const paintAll = () => charts.forEach((chart) => chart.paint());
  paintAll();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paintAll);
  window.addEventListener('beforeprint', paintAll);  // paper is light
  window.addEventListener('afterprint', paintAll);
})();
