'use strict';
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const byId = (id) => document.getElementById(id);
  document.documentElement.classList.add('js');

  // A place in something folded away is shown when a link leads to it.
  function unfold() {
    const place = location.hash && byId(decodeURIComponent(location.hash.slice(1)));
    if (!place) return;
    let opened = false;
    for (let one = place; one; one = one.parentElement) {
      if (one.tagName === 'DETAILS' && !one.open) opened = one.open = true;
    }
    if (opened) place.scrollIntoView();
  }
  addEventListener('hashchange', unfold);

  // Paper has no folds.
  let folded = [];
  addEventListener('beforeprint', () => {
    folded = all('main details:not([open])');
    for (const one of folded) one.open = true;
  });
  addEventListener('afterprint', () => {
    for (const one of folded) one.open = false;
  });

  // The contents are beside the text where there is room, else folded above it.
  const menu = document.querySelector('.menu');
  const wide = matchMedia('(min-width: 62rem)');
  const fit = () => { menu.open = wide.matches; };
  wide.addEventListener('change', fit);
  fit();
  byId('contents').addEventListener('click', (event) => {
    if (event.target.closest('a') && !wide.matches) menu.open = false;
  });

  // Content that is too wide can be scrolled with the keyboard.
  function reach() {
    for (const one of all('.scroll, pre')) {
      if (one.scrollWidth > one.clientWidth + 1) one.tabIndex = 0;
      else one.removeAttribute('tabindex');
    }
  }
  let waiting = 0;
  addEventListener('resize', () => {
    clearTimeout(waiting);
    waiting = setTimeout(reach, 200);
  });
  document.addEventListener('toggle', reach, true);
  reach();

  // Light or dark: the system's choice until the reader chooses.
  const theme = byId('theme');
  const system = matchMedia('(prefers-color-scheme: dark)');
  const isDark = () => (document.documentElement.dataset.theme
    || (system.matches ? 'dark' : 'light')) === 'dark';
  const label = () => theme.setAttribute('aria-pressed', String(isDark()));
  theme.addEventListener('click', () => {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    label();
  });
  system.addEventListener('change', label);
  theme.hidden = false;
  label();

  // Marks the reader's place in the contents.
  const entries = new Map(all('#contents a').map((one) => [one.hash.slice(1), one]));
  const places = [...entries.keys()].map(byId).filter(Boolean);
  let current = null;
  function follow() {
    let low = 0;
    let high = places.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (places[middle].getBoundingClientRect().top < 120) low = middle;
      else high = middle - 1;
    }
    const link = entries.get(places[low].id);
    if (link === current) return;
    for (const one of all('#contents .here')) one.classList.remove('here');
    if (current) current.removeAttribute('aria-current');
    current = link;
    link.setAttribute('aria-current', 'location');
    for (let one = link.parentElement; one.id !== 'contents'; one = one.parentElement) {
      if (one.tagName === 'LI') one.classList.add('here');
    }
    const frame = menu.getBoundingClientRect();
    const box = link.getBoundingClientRect();
    if (wide.matches && (box.top < frame.top + 40 || box.bottom > frame.bottom - 40)) {
      menu.scrollTop += box.top - frame.top - frame.height / 3;
    }
  }
  let asked = false;
  addEventListener('scroll', () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; follow(); });
  }, { passive: true });
  follow();

  // Finds by name. The results are a list of links, walked with the arrow keys.
  const find = byId('find');
  const found = byId('found');
  const kMost = 40;
  let index = null;
  function whatIsThere() {
    const text = (one) => (one ? one.textContent.replace(/\s+/g, ' ').trim() : '');
    const out = [];
    for (const one of all('[data-find]')) {
      const place = one.id ? one : one.querySelector('[id]');
      const words = one.dataset.find.split(' ');
      const kind = words.pop();
      out.push({ name: words.join(' '), kind, id: place.id,
        more: text(one.querySelector('p, .why')) });
    }
    for (const one of all('article h1, article h2, article h3')) {
      if (one.classList.contains('entry') || one.closest('[data-find]')) continue;
      out.push({ name: text(one).replace(/#$/, ''), kind: 'section', id: one.id, more: '' });
    }
    return out;
  }
  function rank(one, words) {
    const name = one.name.toLowerCase();
    const more = one.more.toLowerCase();
    let sum = 0;
    for (const word of words) {
      if (name === word) sum += 0;
      else if (name.startsWith(word)) sum += 1;
      else if (name.includes(word)) sum += 2;
      else if (more.includes(word)) sum += 6;
      else return -1;
    }
    return sum;
  }
  function item(one) {
    const entry = document.createElement('li');
    const link = document.createElement('a');
    link.href = '#' + one.id;
    const name = document.createElement('span');
    name.className = 'name';
    name.textContent = one.name;
    const kind = document.createElement('span');
    kind.className = 'kind';
    kind.textContent = one.kind;
    const more = document.createElement('span');
    more.className = 'more';
    more.textContent = one.more;
    link.append(name, ' ', kind, ' ', more);
    entry.append(link);
    return entry;
  }
  function look() {
    index = index || whatIsThere();
    const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
    const hits = words.length === 0 ? [] : index.map((one) => [rank(one, words), one])
      .filter(([sum]) => sum >= 0).sort((a, b) => a[0] - b[0]);
    found.replaceChildren(...hits.slice(0, kMost).map(([, one]) => item(one)));
    found.hidden = hits.length === 0;
    byId('count').textContent = words.length === 0 ? ''
      : hits.length > kMost ? `${kMost} of ${hits.length} places` : `${hits.length} places`;
    if (words.length > 0 && hits.length === 0) {
      const none = document.createElement('li');
      none.className = 'none';
      none.textContent = 'Nothing has this name.';
      found.replaceChildren(none);
      found.hidden = false;
    }
  }
  function leave() {
    find.value = '';
    look();
  }
  find.addEventListener('input', look);
  found.addEventListener('click', (event) => {
    const link = event.target.closest('a');
    if (!link) return;
    if (link.hash === location.hash) setTimeout(unfold);  // No event comes of it.
    leave();
  });
  document.querySelector('.search').addEventListener('keydown', (event) => {
    const links = all('a', found);
    const at = links.indexOf(document.activeElement);
    if (event.key === 'Escape') {
      leave();
      find.focus();
    } else if (event.key === 'ArrowDown' && links.length > 0) {
      links[Math.min(at + 1, links.length - 1)].focus();
    } else if (event.key === 'ArrowUp' && at >= 0) {
      (at === 0 ? find : links[at - 1]).focus();
    } else if (event.key === 'Enter' && document.activeElement === find && links.length > 0) {
      links[0].click();
    } else {
      return;
    }
    event.preventDefault();
  });
  document.addEventListener('focusin', (event) => {
    if (!event.target.closest('.search')) found.hidden = true;
  });
  document.addEventListener('keydown', (event) => {
    if (event.key !== '/' || event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^(INPUT|TEXTAREA|SELECT)$/.test(document.activeElement.tagName)) return;
    event.preventDefault();
    find.focus();
  });
  document.querySelector('.search').hidden = false;
  unfold();
})();
