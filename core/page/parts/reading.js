// Helps to read what does not fit: says where a table goes on sideways, and enlarges small pictures.
(() => {
  'use strict';

  // The style fades the sides on which there is more; a line above says so in words.
  function watchSides(box) {
    const hint = document.createElement('p');
    hint.className = 'hint';
    hint.textContent = 'Scroll sideways for more columns';
    box.before(hint);
    const look = () => {
      const left = box.scrollLeft > 1, right = box.scrollLeft + box.clientWidth < box.scrollWidth - 1;
      box.dataset.more = [left ? 'left' : '', right ? 'right' : ''].join(' ').trim();
      hint.hidden = box.scrollWidth <= box.clientWidth + 1;
    };
    box.addEventListener('scroll', look, {passive: true});
    new ResizeObserver(look).observe(box);
    look();
  }

  function makeLarger(image) {
    const button = document.createElement('button'), figure = image.closest('figure');
    button.type = 'button';
    button.title = 'Enlarge';
    button.setAttribute('aria-expanded', 'false');
    image.before(button);
    button.append(image);
    button.addEventListener('click', () => {
      const large = figure.classList.toggle('large');
      button.setAttribute('aria-expanded', String(large));
      button.title = large ? 'Make small' : 'Enlarge';
      if (large) figure.scrollIntoView({block: 'nearest'});
    });
  }

  document.querySelectorAll('.scroll').forEach(watchSides);
  document.querySelectorAll('.pictures.many img').forEach(makeLarger);
})();
