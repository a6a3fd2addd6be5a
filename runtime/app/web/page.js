// What the scripts of `pelage compare` and `pelage tradeoff` share: elements, and a button that copies a command.
const page = (() => {
  'use strict';
  const make = (tag, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };

  async function copy(code) {
    try {
      await navigator.clipboard.writeText(code.textContent);
      return true;
    } catch {
      getSelection().selectAllChildren(code);
      return document.execCommand('copy');
    }
  }

  function addCopyButton(command) {
    const button = make('button', {type: 'button', textContent: 'Copy'});
    button.setAttribute('aria-live', 'polite');
    button.addEventListener('click', async () => {
      button.textContent = await copy(command.querySelector('code')) ? 'Copied' : 'Selected: copy with Ctrl+C';
      setTimeout(() => button.textContent = 'Copy', 1500);
    });
    command.firstElementChild.append(button);
  }

  return {make, addCopyButton};
})();
