// Makes the static page of `pelage compare` a tool: two pictures at the same place behind a slider or in turn, layers,
// zoom, insets, sorting, copying. Everything is read from the page itself. One scale and one corner, in pixels of the
// pictures, hold for all of them.
(() => {
  'use strict';
  const $ = id => document.getElementById(id);
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
  const {make, addCopyButton} = page;

  const methods = [...document.querySelectorAll('.gallery article')].map(article => {
    const layers = {};
    for (const image of article.querySelectorAll('img')) layers[image.dataset.layer] = image;
    return {id: article.dataset.id, title: article.dataset.title, layers};
  }).filter(method => method.layers.picture);

  // --- table ----------------------------------------------------------------------------------------------------

  function sortTable(table, column, direction) {
    const rank = row => row.classList.contains('failed') ? 2 : column > 0 && !row.cells[column].dataset.value ? 1 : 0;
    const compare = column === 0
        ? (p, q) => p.cells[0].textContent.localeCompare(q.cells[0].textContent, 'en', {numeric: true})
        : (p, q) => {
          const x = Number(p.cells[column].dataset.value), y = Number(q.cells[column].dataset.value);
          return x < y ? -1 : x > y ? 1 : 0;
        };
    const rows = [...table.tBodies[0].rows];
    rows.sort((p, q) => rank(p) - rank(q) || (rank(p) === 0 ? direction * compare(p, q) : 0));
    table.tBodies[0].append(...rows);
  }

  function makeSortable(table) {
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => {
      const button = make('button', {type: 'button'}, head.textContent);
      head.replaceChildren(button);
      head.setAttribute('aria-sort', 'none');
      const sort = () => {
        const ascending = head.getAttribute('aria-sort') !== 'ascending';
        for (const other of heads) other.setAttribute('aria-sort', 'none');
        head.setAttribute('aria-sort', ascending ? 'ascending' : 'descending');
        sortTable(table, column, ascending ? 1 : -1);
      };
      head.addEventListener('click', sort);
      head.style.cursor = 'pointer';
    });
  }

  makeSortable(document.querySelector('table'));
  document.querySelectorAll('.command').forEach(addCopyButton);
  if (methods.length === 0) return;

  // --- viewer: state --------------------------------------------------------------------------------------------

  const kMaxZoom = 64, kInsets = 3, kInsetColours = ['#ff4d4d', '#4db8ff', '#ffc233'];
  const stage = $('stage'), canvas = $('canvas'), split = $('split');
  const width = Number(stage.dataset.width), height = Number(stage.dataset.height);  // maps have a bar below that
  const cropSize = clamp(Math.round(Math.min(width, height) / 8), 16, 96);
  const last = methods.length - 1;
  const view = {mode: 'slider', layer: 'picture', a: 0, b: Math.min(1, last), shown: 0, split: .5, zoom: 1, x: 0, y: 0};
  let insets = [], waiting = false;

  const imageOf = index => methods[index].layers[view.layer];
  const cssScale = () => stage.clientWidth / width * view.zoom;  // CSS pixels of a pixel of the picture

  function changed() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      draw();
    });
  }

  // --- viewer: drawing ------------------------------------------------------------------------------------------

  // Draws part of a picture, its corner (x, y) at the context's origin.
  function paint(context, index, x, y, scale) {
    const image = imageOf(index);
    if (!image) return false;
    context.save();
    context.imageSmoothingEnabled = scale < 1;
    context.imageSmoothingQuality = 'high';
    context.transform(scale, 0, 0, scale, -x * scale, -y * scale);
    context.drawImage(image, 0, 0);
    context.restore();
    return true;
  }

  function paintStage(context, index, from, to, dpr) {
    context.save();
    context.beginPath();
    context.rect(from, 0, to - from, canvas.height);
    context.clip();
    if (!paint(context, index, view.x, view.y, cssScale() * dpr)) {
      context.fillStyle = '#888';
      context.font = `${14 * dpr}px sans-serif`;
      context.textAlign = 'center';
      context.fillText('no such map: others are compared with this', (from + to) / 2, canvas.height / 2, to - from);
    }
    context.restore();
  }

  function markInsets(context, dpr) {
    const scale = cssScale() * dpr;
    insets.forEach((inset, i) => {
      context.lineWidth = 2 * dpr;
      context.strokeStyle = kInsetColours[i];
      context.strokeRect((inset.x - view.x) * scale, (inset.y - view.y) * scale, cropSize * scale, cropSize * scale);
    });
  }

  function draw() {
    const dpr = devicePixelRatio || 1;
    canvas.width = Math.round(stage.clientWidth * dpr);
    canvas.height = Math.round(stage.clientHeight * dpr);
    const context = canvas.getContext('2d');
    if (view.mode === 'slider') {
      const at = Math.round(view.split * canvas.width);
      paintStage(context, view.a, 0, at, dpr);
      paintStage(context, view.b, at, canvas.width, dpr);
    } else {
      paintStage(context, view.shown, 0, canvas.width, dpr);
    }
    markInsets(context, dpr);
    $('zoom').textContent = `${(cssScale() * 100).toFixed(0)} %`;
  }

  function drawInsets() {
    $('insets').replaceChildren(...insets.map((inset, i) => {
      const remove = make('button', {type: 'button', textContent: 'Remove'});
      remove.addEventListener('click', () => {
        insets.splice(i, 1);
        drawInsets();
        changed();
      });
      const mark = make('i');
      mark.style.borderColor = kInsetColours[i];
      const crops = methods.map((method, index) => {
        const crop = make('canvas', {width: cropSize, height: cropSize});
        crop.setAttribute('role', 'img');
        crop.setAttribute('aria-label', `${method.title}, inset ${i + 1}`);
        paint(crop.getContext('2d'), index, inset.x, inset.y, 1);
        return make('figure', {}, crop, make('figcaption', {textContent: method.title}));
      });
      const from = `${inset.x}, ${inset.y}; ${cropSize} \u00d7 ${cropSize} pixels`;
      return make('div', {className: 'inset'}, make('header', {}, mark, make('span', {textContent: from}), remove),
                  make('div', {className: 'crops'}, ...crops));
    }));
  }

  // --- viewer: what is chosen -----------------------------------------------------------------------------------

  function showChoice() {
    const sliding = view.mode === 'slider';
    $('a').value = methods[view.a].id;
    $('b').value = methods[view.b].id;
    split.hidden = !sliding;
    $('tag-b').hidden = !sliding;
    $('tag-a').textContent = methods[sliding ? view.a : view.shown].title;
    $('tag-b').textContent = methods[view.b].title;
    $('scale').hidden = view.layer === 'picture';
    $('scale-to').textContent = $('scale-to').dataset[view.layer] || '';
    canvas.setAttribute('aria-label', sliding
        ? `${methods[view.a].title} left, ${methods[view.b].title} right` : methods[view.shown].title);
    [...$('list').children].forEach((item, index) => {
      const button = item.firstChild, sides = [];
      if (index === view.a) sides.push(make('b', {className: 'in-a', textContent: 'A'}));
      if (index === view.b) sides.push(make('b', {className: 'in-b', textContent: 'B'}));
      button.querySelector('.side').replaceChildren(...sides);
      button.setAttribute('aria-pressed', sliding ? index === view.a || index === view.b : index === view.shown);
    });
    for (const name of ['mode', 'layer']) {
      document.querySelector(`input[name=${name}][value=${view[name]}]`).checked = true;
    }
    changed();
  }

  function choose(change) {
    const layer = view.layer;
    Object.assign(view, change);
    if (view.layer !== layer) drawInsets();
    showChoice();
  }

  // One click or key for a method: in turn it is shown, behind the slider it becomes B (with `other` A).
  const pick = (index, other) => choose(view.mode === 'flip' ? {shown: index} : other ? {a: index} : {b: index});
  const next = step => {
    const from = view.mode === 'flip' ? view.shown : view.b;
    pick((from + step + methods.length) % methods.length, false);
  };
  const flip = () => choose({mode: 'flip', shown: view.shown === view.a ? view.b : view.a});
  const exchange = () => choose({a: view.b, b: view.a});

  function setSplit(value) {
    view.split = clamp(value, 0, 1);
    split.style.left = `${100 * view.split}%`;
    split.setAttribute('aria-valuenow', Math.round(100 * view.split));
    split.setAttribute('aria-valuetext', `A covers ${Math.round(100 * view.split)} %`);
    changed();
  }

  // --- viewer: place and zoom -----------------------------------------------------------------------------------

  function setCorner(x, y) {
    view.x = clamp(x, 0, width - width / view.zoom);
    view.y = clamp(y, 0, height - height / view.zoom);
    changed();
  }

  // Zooms so that what lies under (px, py), CSS pixels of the stage, stays there.
  function zoomAt(px, py, factor) {
    const before = cssScale();
    view.zoom = clamp(view.zoom * factor, 1, kMaxZoom);
    const after = cssScale();
    setCorner(view.x + px / before - px / after, view.y + py / before - py / after);
  }

  const zoomMiddle = factor => zoomAt(stage.clientWidth / 2, stage.clientHeight / 2, factor);
  const resetView = () => {
    view.zoom = 1;
    setCorner(0, 0);
  };

  function addInset(px, py) {
    const corner = (p, offset, size) => clamp(Math.round(offset + p / cssScale() - cropSize / 2), 0, size - cropSize);
    insets.push({x: corner(px, view.x, width), y: corner(py, view.y, height)});
    insets = insets.slice(-kInsets);
    drawInsets();
    changed();
  }

  // --- viewer: pointers -----------------------------------------------------------------------------------------

  const onStage = event => {
    const box = stage.getBoundingClientRect();
    return [event.clientX - box.left - stage.clientLeft, event.clientY - box.top - stage.clientTop];
  };

  const pointers = new Map();  // of fingers and buttons held on the stage: where they are
  let travelled = 0;

  function spread() {
    const [p, q] = [...pointers.values()];
    return {x: (p[0] + q[0]) / 2, y: (p[1] + q[1]) / 2, size: Math.hypot(p[0] - q[0], p[1] - q[1])};
  }

  stage.addEventListener('pointerdown', event => {
    if (event.button !== 0 || split.contains(event.target)) return;
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, onStage(event));
    stage.setPointerCapture(event.pointerId);
  });

  stage.addEventListener('pointermove', event => {
    readOut(...onStage(event));
    if (!pointers.has(event.pointerId)) return;
    const before = pointers.size === 2 ? spread() : null, from = pointers.get(event.pointerId), to = onStage(event);
    pointers.set(event.pointerId, to);
    travelled += Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (before) {
      const after = spread();
      zoomAt(before.x, before.y, after.size / Math.max(before.size, 1));
      setCorner(view.x + (before.x - after.x) / cssScale(), view.y + (before.y - after.y) / cssScale());
    } else if (travelled > 4) {
      stage.classList.add('held');
      setCorner(view.x + (from[0] - to[0]) / cssScale(), view.y + (from[1] - to[1]) / cssScale());
    }
  });

  function release(event) {
    if (!pointers.delete(event.pointerId)) return;
    stage.classList.remove('held');
    if (event.type === 'pointerup' && travelled <= 4 && pointers.size === 0) addInset(...onStage(event));
  }
  stage.addEventListener('pointerup', release);
  stage.addEventListener('pointercancel', release);
  stage.addEventListener('pointerleave', () => $('readout').textContent = '');

  stage.addEventListener('wheel', event => {
    if (view.zoom === 1 && event.deltaY > 0) return;  // let the page scroll
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    zoomAt(...onStage(event), Math.exp(-clamp(event.deltaY * lines, -200, 200) / 240));
  }, {passive: false});

  split.addEventListener('pointerdown', event => {
    if (event.button !== 0) return;
    split.setPointerCapture(event.pointerId);
    split.focus({preventScroll: true});
    event.preventDefault();
  });
  split.addEventListener('pointermove', event => {
    if (split.hasPointerCapture(event.pointerId)) setSplit(onStage(event)[0] / stage.clientWidth);
  });

  // --- viewer: what the pointer is on -----------------------------------------------------------------------------

  const probe = make('canvas', {width: 1, height: 1}).getContext('2d', {willReadFrequently: true});

  function valueOf(index, x, y) {
    if (!imageOf(index)) return '';
    probe.clearRect(0, 0, 1, 1);
    probe.drawImage(imageOf(index), -x, -y);
    return [...probe.getImageData(0, 0, 1, 1).data.slice(0, 3)].map(v => String(v).padStart(3, '\u2007')).join(' ');
  }

  function readOut(px, py) {
    const x = Math.floor(view.x + px / cssScale()), y = Math.floor(view.y + py / cssScale());
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const values = view.mode === 'slider' ? `A ${valueOf(view.a, x, y)}   B ${valueOf(view.b, x, y)}`
                                          : valueOf(view.shown, x, y);
    $('readout').textContent = `x ${x}  y ${y}   sRGB  ${values}`;
  }

  // --- viewer: keys -----------------------------------------------------------------------------------------------

  const kSplitKeys = {ArrowLeft: -.01, ArrowRight: .01, PageDown: -.1, PageUp: .1, Home: -1, End: 1};

  function stageKey(event) {
    if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      next(event.key === 'ArrowDown' ? 1 : -1);
    } else if (event.key in kSplitKeys && view.mode === 'slider') {
      setSplit(view.split + kSplitKeys[event.key] * (event.shiftKey ? 10 : 1));
    } else if (event.key === ' ') {
      flip();
    } else {
      return false;
    }
    return true;
  }

  function pageKey(event) {
    const digit = /^Digit([1-9])$/.exec(event.code) || /^([1-9])$/.exec(event.key);
    if (digit && Number(digit[1]) <= methods.length) {
      pick(Number(digit[1]) - 1, event.shiftKey);
    } else if (event.key === '0') {
      resetView();
    } else if (event.key === '+' || event.key === '=') {
      zoomMiddle(1.5);
    } else if (event.key === '-') {
      zoomMiddle(1 / 1.5);
    } else if (event.key === 'x') {
      exchange();
    } else if (event.key === 'i') {
      addInset(stage.clientWidth / 2, stage.clientHeight / 2);
    } else {
      return false;
    }
    return true;
  }

  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest('select, input:not([type=radio])')) return;
    if ((stage.contains(event.target) && stageKey(event)) || pageKey(event)) event.preventDefault();
  });

  // --- viewer: start ----------------------------------------------------------------------------------------------

  const rmseOf = id => {
    const row = document.querySelector(`[data-pick="${CSS.escape(id)}"]`).closest('tr');
    return row.cells[1].textContent.replace(/ best|~/g, '');
  };

  function buildList() {
    methods.forEach((method, index) => {
      for (const select of [$('a'), $('b')]) select.append(make('option', {value: method.id, textContent: method.title}));
      const button = make('button', {type: 'button'},
                          make('span', {className: 'key', textContent: index < 9 ? index + 1 : ''}),
                          make('span', {textContent: method.title}),
                          make('span', {className: 'rmse', textContent: rmseOf(method.id), title: 'RMSE'}),
                          make('span', {className: 'side'}));
      button.addEventListener('click', event => pick(index, event.shiftKey));
      $('list').append(make('li', {}, button));
    });
  }

  function foldGallery() {
    const section = $('pictures'), details = make('details');
    details.append(make('summary', {textContent: `Every picture and map, ${methods.length} methods`}),
                   ...[...section.children].slice(1));
    section.append(details);
  }

  function listen() {
    for (const side of ['a', 'b']) {
      $(side).addEventListener('change', event => {
        const index = methods.findIndex(method => method.id === event.target.value);
        choose(view.mode === 'flip' ? {[side]: index, shown: index} : {[side]: index});
      });
    }
    for (const input of document.querySelectorAll('fieldset input')) {
      input.addEventListener('change', () => choose({[input.name]: input.value}));
    }
    document.querySelectorAll('[data-pick]').forEach(link => link.addEventListener('click', event => {
      const index = methods.findIndex(method => method.id === link.dataset.pick);
      event.preventDefault();
      if (index < 0) return;
      pick(index, false);
      $('viewer').scrollIntoView();
    }));
    $('swap').addEventListener('click', exchange);
    $('reset').addEventListener('click', resetView);
    new ResizeObserver(changed).observe(stage);
  }

  buildList();
  foldGallery();
  listen();
  $('viewer').hidden = false;
  setSplit(.5);
  showChoice();
  Promise.allSettled(methods.map(method => method.layers.picture.decode())).then(changed);
})();
