// Draws each chart of a report from the table of its data, which stands below it for those who read rather than look.
(() => {
  'use strict';
  const kMarkers = ['circle', 'triangle', 'rect', 'rectRot', 'cross', 'star', 'crossRot', 'rectRounded'];
  const kColors = 10;
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

  // On a logarithmic axis 1, 10, 100, ..., on a short one 2 and 5 between them too.
  function logTick(value, index, ticks) {
    const decades = Math.log10(ticks[ticks.length - 1].value / ticks[0].value);
    const lead = Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9));
    return lead === 1 || (decades < 2.5 && (lead === 2 || lead === 5)) ? short(value) : '';
  }

  // values: along the axis. Whole numbers get no ticks between them.
  function axis(title, logarithmic, values) {
    const ticks = {maxRotation: 0, autoSkipPadding: 12, callback: logarithmic ? logTick : short};
    if (!logarithmic && values.every((value) => !(value % 1))) ticks.precision = 0;
    return {
      type: logarithmic ? 'logarithmic' : 'linear',
      title: {display: true, text: title},
      ticks,
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
      const has = (flag) => flag in body.dataset;
      return {name: body.rows[0].cells[0].textContent, color: Number(body.dataset.color), points,
              line: !has('dots'), dashed: has('dashed'), legend: !has('unlisted')};
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

  function dataset(series, logX) {
    const marked = markedPoints(series.points, logX);
    return {
      label: series.name, data: series.points, showLine: series.line, borderWidth: 2,
      borderDash: series.dashed ? [6, 4] : [],
      pointStyle: kMarkers[series.color % kMarkers.length], clip: 8,
      pointRadius: (context) => (!series.line ? 5.5 : marked.has(context.dataIndex) ? 3.5 : 0),
      pointBorderWidth: 1.5, pointHitRadius: 8, pointHoverRadius: 6,
    };
  }

  function paint(chart, all) {
    const ink = style('--ink'), line = style('--line');
    chart.data.datasets.forEach((set, i) => {
      set.borderColor = set.backgroundColor = set.pointBackgroundColor = colorOf(all[i].color);
      set.pointBorderColor = all[i].line ? set.borderColor : ink;
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

  // A button a series that hides and shows it. Returns the swatches' painters.
  function addLegend(box, chart, all) {
    const painters = [];
    all.forEach((series, i) => {
      if (!series.legend) return;
      const button = document.createElement('button'), swatch = document.createElement('canvas');
      button.type = 'button';
      button.setAttribute('aria-pressed', 'true');
      swatch.setAttribute('aria-hidden', 'true');
      button.append(swatch, series.name);
      button.addEventListener('click', () => {
        const show = !chart.isDatasetVisible(i);
        all.forEach((other, j) => {
          if (j === i || (!other.legend && other.color === series.color)) chart.setDatasetVisibility(j, show);
        });
        button.setAttribute('aria-pressed', String(show));
        chart.update('none');
      });
      box.append(button);
      painters.push(() => paintSwatch(swatch, series));
    });
    return painters;
  }

  function draw(figure) {
    const logX = 'logX' in figure.dataset, logY = 'logY' in figure.dataset;
    const table = figure.querySelector('table');
    const all = readSeries(table, logX, logY);
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
        scales: {x: axis(x, logX, along('x')), y: axis(y, logY, along('y'))},
      },
    });
    const painters = [() => paint(chart, all), ...addLegend(figure.querySelector('.legend'), chart, all)];
    return () => painters.forEach((one) => one());
  }

  const painters = Array.from(document.querySelectorAll('figure.chart'), draw);
  const paintAll = () => painters.forEach((one) => one());
  paintAll();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paintAll);
  window.addEventListener('beforeprint', paintAll);  // paper is light
  window.addEventListener('afterprint', paintAll);
})();
