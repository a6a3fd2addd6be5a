// Makes the static page of `pelage tradeoff` a tool: what a point says under the pointer, the panel of a point with its
// picture beside others, curves to hide, arrow keys along the points. Everything is read from the page itself.
(() => {
  'use strict';
  const {make, addCopyButton} = page;
  const tip = document.getElementById('tip');

  // --- what a point says ----------------------------------------------------------------------------------------

  const placeOf = point => point.querySelector('.reach').getBoundingClientRect();
  let told = null;

  function hush() {
    if (told) told.classList.remove('at');
    told = null;
    tip.hidden = true;
  }

  function tell(point) {
    if (point === told) return;
    hush();
    told = point;
    point.classList.add('at');
    tip.textContent = point.getAttribute('aria-label');
    tip.hidden = false;
    const at = placeOf(point), box = tip.getBoundingClientRect();
    const right = at.right + 6 + box.width < document.documentElement.clientWidth;
    tip.style.left = `${Math.max(4, right ? at.right + 6 : at.left - 6 - box.width)}px`;
    tip.style.top = `${Math.max(4, Math.min(at.top - 6, innerHeight - box.height - 4))}px`;
  }

  // Browsers show <title> by themselves, late and in their own way: here it becomes the point's name.
  function nameBy(point) {
    const title = point.querySelector('title');
    point.setAttribute('aria-label', title.textContent);
    title.remove();
  }

  // --- the panel ------------------------------------------------------------------------------------------------

  function pictureOf(id, caption) {
    const card = id && document.getElementById(id), image = card && card.querySelector('img');
    if (!image) return null;
    const words = caption + card.querySelector('figcaption').textContent;
    return make('figure', {}, make('img', {src: image.src, alt: words}), make('figcaption', {textContent: words}));
  }

  function pictures(section, id) {
    const own = pictureOf(id, '');
    if (!own) return null;
    const beside = [[section.dataset.default, 'default settings'], [section.dataset.best, 'least error: ']]
        .filter(([other], i, all) => other !== id && all.findIndex(([same]) => same === other) === i);
    const figures = beside.map(([other, words]) => {
      const figure = pictureOf(other, words);
      if (figure && words === 'default settings') figure.lastChild.textContent = words;
      return figure;
    });
    return make('div', {className: 'pictures'}, own, ...figures.filter(Boolean));
  }

  // Points that the chart shows at the same place, which a click cannot tell apart.
  function neighbours(section, id) {
    const points = [...section.querySelectorAll('svg .point')].filter(p => p.checkVisibility());
    const own = points.find(p => p.dataset.row === id);
    if (!own) return null;
    const at = placeOf(own);
    const near = points.filter(p => p !== own && Math.hypot(placeOf(p).x - at.x, placeOf(p).y - at.y) < 8);
    if (near.length === 0) return null;
    const links = near.flatMap((p, i) => {
      const title = document.getElementById(p.dataset.row).querySelector('h4').textContent;
      const link = make('a', {href: p.getAttribute('href'), textContent: title});
      link.dataset.row = p.dataset.row;
      return i ? [', ', link] : [link];
    });
    return make('p', {className: 'note'}, 'At the same place: ', ...links);
  }

  function close(section) {
    const panel = section.querySelector('.panel');
    if (panel.hidden) return;
    panel.hidden = true;
    section.querySelectorAll('.chosen').forEach(p => p.classList.remove('chosen'));
    const point = [...section.querySelectorAll('svg .point')].find(p => p.dataset.row === panel.dataset.of && p.checkVisibility());
    if (point) point.focus();
  }

  function show(id) {
    const card = document.getElementById(id), section = card && card.closest('.diagram');
    if (!section) return false;
    const panel = section.querySelector('.panel'), shown = card.cloneNode(true);
    shown.querySelectorAll('figure, button').forEach(e => e.remove());
    shown.querySelectorAll('.command').forEach(addCopyButton);
    const button = make('button', {type: 'button', className: 'close', textContent: 'Close'});
    button.addEventListener('click', () => close(section));
    panel.replaceChildren(button, ...shown.children,
                          ...[neighbours(section, id), pictures(section, id)].filter(Boolean));
    panel.dataset.of = id;
    panel.hidden = false;
    section.querySelectorAll('svg .point').forEach(p => p.classList.toggle('chosen', p.dataset.row === id));
    hush();
    panel.focus({preventScroll: true});
    panel.scrollIntoView({block: 'nearest'});
    return true;
  }

  // --- points by pointer and keys -------------------------------------------------------------------------------

  function nearest(points, x, y) {
    let best = null, least = 14;
    for (const point of points) {
      if (!point.checkVisibility()) continue;
      const at = placeOf(point), distance = Math.hypot(at.x + at.width / 2 - x, at.y + at.height / 2 - y);
      if (distance <= least) [best, least] = [point, distance];
    }
    return best;
  }

  function makeChart(svg) {
    const points = [...svg.querySelectorAll('.point')];
    points.forEach(nameBy);
    const matrix = p => p.transform.baseVal.consolidate().matrix;
    const order = [...points].sort((p, q) => matrix(p).e - matrix(q).e || matrix(q).f - matrix(p).f);
    // One stop for the Tab key; arrows lead on from there.
    const enter = point => order.forEach(p => p.setAttribute('tabindex', p === point ? 0 : -1));
    enter(order[0]);
    svg.addEventListener('pointermove', event => {
      const point = nearest(points, event.clientX, event.clientY);
      point ? tell(point) : hush();
    });
    svg.addEventListener('pointerleave', hush);
    // Not of the chart itself: Chromium lets an SVG that listens for focus have it.
    svg.parentElement.addEventListener('focusin', event => {
      if (!points.includes(event.target)) return;
      enter(event.target);
      tell(event.target);
    });
    svg.parentElement.addEventListener('focusout', hush);
    svg.addEventListener('keydown', event => {
      const shown = order.filter(p => p.checkVisibility()), at = shown.indexOf(event.target);
      const along = shown.filter(p => p.dataset.knob === event.target.dataset.knob), own = along.indexOf(event.target);
      const next = {
        ArrowRight: shown[at + 1], ArrowLeft: shown[at - 1], Home: shown[0], End: shown.at(-1),
        ArrowDown: along[own + 1], ArrowUp: along[own - 1],
      };
      if (!(event.key in next) || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      if (next[event.key]) next[event.key].focus();
    });
    svg.addEventListener('click', event => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      const point = event.detail === 0 ? event.target.closest('.point') : nearest(points, event.clientX, event.clientY);
      if (!point) return;
      event.preventDefault();
      enter(point);
      show(point.dataset.row);
    });
  }

  // --- legend ---------------------------------------------------------------------------------------------------

  function makeLegend(section) {
    const drawn = [...section.querySelectorAll('svg [data-knob]')], switches = [];
    const set = (button, on) => {
      button.setAttribute('aria-pressed', on);
      for (const e of drawn) if (e.dataset.knob === button.parentElement.dataset.knob) e.classList.toggle('off', !on);
      for (const svg of section.querySelectorAll('.axis > svg')) {
        const points = [...svg.querySelectorAll('.point:not(.off)')];
        if (points.length && !points.some(p => p.getAttribute('tabindex') === '0')) points[0].setAttribute('tabindex', 0);
      }
    };
    const light = knob => {
      for (const svg of section.querySelectorAll('.axis > svg')) svg.classList.toggle('dim', knob !== null);
      for (const e of drawn) e.classList.toggle('lit', e.dataset.knob === knob);
    };
    for (const item of section.querySelectorAll('.knobs li')) {
      const button = make('button', {type: 'button'}, ...item.childNodes);
      item.append(button);
      switches.push(button);
      set(button, true);
      button.addEventListener('click', () => {
        set(button, button.getAttribute('aria-pressed') !== 'true');
        light(null);
      });
      button.addEventListener('pointerenter', () => button.getAttribute('aria-pressed') === 'true' && light(item.dataset.knob));
      button.addEventListener('pointerleave', () => light(null));
    }
    const all = [['Show all', true], ['Hide all', false]].map(([words, on]) => {
      const button = make('button', {type: 'button', textContent: words});
      button.addEventListener('click', () => switches.forEach(s => set(s, on)));
      return button;
    });
    if (switches.length > 2) section.querySelector('.knobs').after(make('div', {className: 'all-none'}, ...all));
  }

  // --- start ----------------------------------------------------------------------------------------------------

  function fold(all) {
    const details = make('details');
    const count = all.querySelectorAll('.card').length;
    details.append(make('summary', {textContent: `Every point, ${count}`}), all.querySelector('.cards'));
    all.querySelector('h3').remove();
    all.append(details);
  }

  document.querySelectorAll('.command').forEach(addCopyButton);
  document.querySelectorAll('.axis > svg').forEach(makeChart);
  document.querySelectorAll('.diagram').forEach(section => section.querySelector('.knobs') && makeLegend(section));
  document.querySelectorAll('.all').forEach(fold);
  document.addEventListener('click', event => {
    const link = event.target.closest('a[data-row]:not(.point)');
    if (link && !event.ctrlKey && !event.metaKey && !event.shiftKey && show(link.dataset.row)) event.preventDefault();
  });
  document.addEventListener('keydown', event => {
    const section = event.key === 'Escape' && event.target.closest('.diagram');
    if (section && section.querySelector('.panel')) close(section);
  });
  try {
    show(decodeURIComponent(location.hash.slice(1)));
  } catch {  // an address that nobody wrote here
  }
})();
